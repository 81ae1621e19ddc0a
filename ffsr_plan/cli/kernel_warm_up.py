"""The command `warm-up`: kernels compiled, and the folder named that holds them."""

from __future__ import annotations

from ffsr_plan.cli.console.terminal import err_console, out_console, with_progress
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.kernels import announcement
from ffsr_plan.core.kernels.compiling_time import Stopwatch
from ffsr_plan.core.kernels.kernel_cache import can_be_kept, folder


def warm_up_and_report() -> None:
    """Compile all kernels that are not compiled yet, and say how many these were.

    Raises:
        InvalidInput: the machine code cannot be kept.
    """
    if not can_be_kept():
        raise InvalidInput("NUMBA_CACHE_DIR", str(folder()), "a directory that can be written")
    announcement.withhold()
    err_console.print("warming up: compiling what is not compiled yet, which takes some minutes")
    watch = Stopwatch()
    from ffsr_plan.planning.warm_up import warm_up

    count = with_progress("compiling", warm_up)
    if count:
        out_console.print(f"{count} kernels compiled in {watch.compiling:.1f} s, in {folder()}")
    else:
        out_console.print(f"All kernels were compiled already, in {folder()}")
