"""Colours, labels, axes and files of matplotlib figures."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.checks import text, unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import write_files

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

START, GOAL, PATH, OBSTACLE, ROBOT = "#2a7f9e", "#2f8f4e", "#d95f02", "#9aa0a8", "#3b4252"
TRAILS, CONTACT, ZONE, MOVING = "#7a5fa8", "#b02a30", "#5c6168", "#c2528b"
MOVING_LABEL = "moving bodies"
SERIES = ("#d95f02", "#2a7f9e", "#2f8f4e", "#7a5fa8", "#b8860b", "#3b4252", "#c2528b", "#6b9e2f")
"""Colours of curves that have no meaning of their own, in this order."""
FORMATS = (".pdf", ".svg", ".png")
_DOTS_PER_INCH = 200  # of PNG
_NO_DATE = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}, ".png": {}}
Named = Mapping[str, str] | None
"""Texts by the names of what a figure shows, or None."""


class Style:
    """Colours and labels of what a figure shows, those of its own or the user's."""

    def __init__(self, own: Mapping[str, tuple[str, str]], colours: Named, labels: Named) -> None:
        """See the class.

        Args:
            own: the figure's own colours and labels, by the names that users may give.
            colours: the user's, such as `tab:blue` or `#1f77b4`.
            labels: the user's texts in the legend; an empty one is left out of it.

        Raises:
            InvalidInput: a name that is not in `own`, or what is no colour or text.
        """
        from matplotlib.colors import is_color_like

        self._colours = {name: colour for name, (colour, _) in own.items()}
        self._labels = {name: label for name, (_, label) in own.items()}
        for what, given in (("colours", colours), ("labels", labels)):
            for name in given or {}:
                if name not in own:
                    raise unknown_name(what, name, own)
        for name, colour in (colours or {}).items():
            if not is_color_like(colour):
                allowed = "a colour of matplotlib, such as tab:blue or #1f77b4"
                raise InvalidInput(f"colours.{name}", colour, allowed)
            self._colours[name] = colour
        for name, label in (labels or {}).items():
            self._labels[name] = text(f"labels.{name}", label)

    def colour(self, name: str) -> str:
        """The colour of what has a name."""
        return self._colours[name]

    def label(self, name: str) -> str:
        """The text in the legend; `_` where there is none, which matplotlib leaves out."""
        return self._labels[name] or "_"


def axes_or_new(ax: Axes | None, width: float, height: float) -> tuple[Figure, Axes]:
    """The given axes, or those of a new figure of a size in inches.

    Raises:
        InvalidInput: what are no axes of matplotlib.
    """
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    if ax is not None:
        figure = ax.get_figure(root=True) if isinstance(ax, Axes) else None
        if figure is None:
            raise InvalidInput("ax", ax, "axes of a matplotlib figure")
        return figure, ax
    figure = Figure(figsize=(width, height), layout="constrained")
    ax = figure.add_subplot()
    ax.spines[["top", "right"]].set_visible(False)
    return figure, ax


def fit_height(figure: Figure, ax: Axes) -> None:
    """Height of a figure with one set of axes of equal scales, so that little paper stays white."""
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    width = figure.get_figwidth()
    figure.set_figheight(min(max(0.85 * width * (high - low) / (right - left) + 1.6, 2.4), width))


def write_figure(figure: Figure, path: str | Path) -> None:
    """Write a figure as vectors or pixels, equal figures as equal files.

    Args:
        figure: the figure.
        path: of the file, `.pdf`, `.svg` or `.png`; an existing file is replaced.

    Raises:
        InvalidInput: another kind of file, or one that cannot be written.
    """
    target = checked_path("path", path, *FORMATS)
    write_files("path", {target: figure_bytes(figure, target.suffix.lower())})


def figure_bytes(figure: Figure, suffix: str) -> bytes:
    """Content of the file of a figure; `suffix` is one of `FORMATS`."""
    import matplotlib

    content = io.BytesIO()
    settings: Any = {"svg.hashsalt": "ffsr-plan", "pdf.fonttype": 42, "svg.fonttype": "none"}
    with matplotlib.rc_context(settings):
        figure.savefig(content, dpi=_DOTS_PER_INCH, format=suffix[1:], metadata=_NO_DATE[suffix])
    return content.getvalue()
