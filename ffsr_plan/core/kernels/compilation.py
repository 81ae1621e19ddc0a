"""Compiled functions: numba imported at the first call, and a notice while it compiles."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property, update_wrapper
from threading import Lock, Timer
from typing import Any, Literal, TypeVar, cast

from ffsr_plan.core.kernels import announcement
from ffsr_plan.core.kernels.compiling_time import count_begin, count_end, is_own, loading
from ffsr_plan.core.kernels.kernel_cache import keep_on_disk

_Function = TypeVar("_Function", bound=Callable[..., Any])
_NOTICE = "compiling numerical kernels, once after an installation (a minute or two)"
_NOT_KEPT = (
    "compiling numerical kernels (a minute or two), at every start: the cache directory "
    "cannot be written; NUMBA_CACHE_DIR can name another one"
)
_installing, _listening = Lock(), False


class Kernel:
    """A function that numba compiles when it is first called.

    The module of a kernel can be imported without numba, whose import takes a second. Kernels call
    one another by their plain names: numba asks a global of unknown type for `_numba_type_`, and a
    kernel returns the type of its dispatcher. The machine code is kept on disk (`kernel_cache`) and
    releases the GIL.

    Attributes:
        py_func: the Python function.
        targetoptions: options of the dispatcher; numba reads `inline` and `py_func` of what a
            kernel calls.
    """

    def __init__(self, function: Callable[..., Any], inline: Literal["never", "always"]) -> None:
        self.py_func = function
        self.targetoptions = {"inline": inline}
        update_wrapper(self, function)

    @cached_property
    def dispatcher(self) -> Any:  # noqa: ANN401 - its type depends on numba's version
        """The numba dispatcher, made at the first use."""
        with loading():
            from numba import njit

            options: dict[str, Any] = {"no_cfunc_wrapper": True}
            dispatcher = njit(nogil=True, **options)(self.py_func)
            _listen_once(keep_on_disk(dispatcher))
        return dispatcher

    @cached_property
    def inner_dispatcher(self) -> Any:  # noqa: ANN401 - its type depends on numba's version
        """The numba dispatcher for calls by kernels, made at the first use.

        It makes no function that Python could call, which takes longer to compile than the kernel
        itself where arguments hold many arrays. Its machine code becomes part of the caller's.
        """
        from numba import njit

        options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        return njit(nogil=True, **options | self.targetoptions)(self.py_func)

    @property
    def _numba_type_(self) -> object:
        own = vars(self).get("dispatcher")
        if own is not None and own.is_compiling:  # it calls itself
            return own._numba_type_
        return self.inner_dispatcher._numba_type_

    def __call__(self, *arguments: object) -> Any:  # noqa: ANN401, D102 - as the function
        return self.dispatcher(*arguments)


def kernel(function: _Function) -> _Function:
    """Decorate a function that numba compiles at its first call; see `Kernel`.

    Args:
        function: a function of positional arguments, without Python objects.

    Returns:
        A `Kernel`; for the type checker, a function of the same signature.
    """
    return cast("_Function", Kernel(function, "never"))


def inlined_kernel(function: _Function) -> _Function:
    """Decorate a short function that numba inlines wherever another kernel calls it.

    Args:
        function: as for `kernel`.

    Returns:
        A `Kernel`; for the type checker, a function of the same signature.
    """
    return cast("_Function", Kernel(function, "always"))


def _listen_once(kept: bool) -> None:
    """Announce and time the compilation of this package's kernels.

    Numba reports compilations as events; loading machine code from disk is none.

    Args:
        kept: whether the machine code is, as the announcement says.
    """
    global _listening
    with _installing:
        if _listening:
            return
        _listening = True
    from numba.core import event

    notice = _NOTICE if kept else _NOT_KEPT

    class Listener(event.Listener):
        def on_start(self, event: Any) -> None:  # noqa: ANN401
            if is_own(event.data["dispatcher"]):
                count_begin()
                if announcement.is_due():
                    print(f"ffsr-plan: {notice}", file=sys.stderr, flush=True)

        def on_end(self, event: Any) -> None:  # noqa: ANN401
            if is_own(event.data["dispatcher"]):
                count_end()

    event.register("numba:compile", Listener())  # type: ignore[no-untyped-call]


@contextmanager
def notify_after(seconds: float, text: str) -> Iterator[None]:
    """Write a text to standard error if the body takes longer than some time.

    Args:
        seconds: the time [s].
        text: what takes long.
    """
    notice = Timer(seconds, lambda: print(f"ffsr-plan: {text}", file=sys.stderr, flush=True))
    notice.daemon = True
    notice.start()
    try:
        yield
    finally:
        notice.cancel()
