"""Entry point of the command `ffsr-plan`: Ctrl-C ends it without a traceback while it is loaded."""

from __future__ import annotations

import os
import signal
from types import FrameType


def main() -> None:
    """Load the package and run the command. Exit status 130 after Ctrl-C."""
    signal.signal(signal.SIGINT, _end)
    from ffsr_plan.cli import main as run

    run()


def _end(number: int, frame: FrameType | None) -> None:
    """End at once: an exception could be caught or reworded by a library that is being loaded."""
    os.write(2, b"ffsr-plan: interrupted\n")
    os._exit(128 + number)


if __name__ == "__main__":
    main()
