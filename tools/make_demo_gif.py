"""Write the moving picture of the README.

It shows a flight of the scenario `fig2a`, planned by the default planner with seed 0 and refined.

`python -m tools.make_demo_gif docs/demo.gif`
"""

from __future__ import annotations

import sys

from tools.make_flight_figure import demo_flight


def main(path: str) -> None:
    """Plan and time `fig2a` and write its moving picture to a file."""
    demo_flight().write_gif(path)


if __name__ == "__main__":
    main(sys.argv[1])
