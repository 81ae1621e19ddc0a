"""Bodies and debris that move, drawn flat at several times, from light to dark."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ffsr_plan.display.figure_style import MOVING_LABEL, Style
from ffsr_plan.display.scenes.body_tracks import BodyTrack, body_mesh, points_near
from ffsr_plan.display.scenes.debris_track import DebrisTrack
from ffsr_plan.display.scenes.shape_outlines import outline_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import EllipseCollection

    from ffsr_plan.core.arrays import Array

MOST_LABELLED = 6
"""Bodies at which times are written; of more, light and dark show the time."""
_MOST_NAMED = 30
_INSTANTS = 5  # at most, at which bodies are drawn
_LIGHTEST = 0.3  # share of the colour at the first time
_APART = 0.05  # of the picture: times of a body nearer than that are written together
_LETTER, _LINE = 0.0085, 0.019  # nearly the size of letters, in sizes of the picture
_ASIDE = np.array(
    [(0, 0), (0, 1.2), (0, -1.2), (1.2, 0), (-1.2, 0), (1, 2), (-1, 2), (1, -2), (-1, -2)]
)


class TimedLabel(NamedTuple):
    """Times at which a body is nearly at the same place.

    Attributes:
        text: its name, if it is the first label of the body, and the times.
        at: (d,) place [m].
    """

    text: str
    at: Array


def chosen_rows(rows: Sequence[int]) -> list[int]:
    """Those of the silhouettes' rows at which bodies are drawn, from the first to the last.

    They are at equal steps if three or more are possible at such.
    """
    last = len(rows) - 1
    even = [k for k in range(_INSTANTS - 1, 1, -1) if last % k == 0]
    steps = even[0] if even else min(_INSTANTS - 1, last)
    chosen = np.linspace(0, last, steps + 1).round().astype(int)
    return [rows[k] for k in chosen]


def shades(colour: str, count: int) -> list[tuple[float, float, float]]:
    """Red, green and blue of a colour at so many times, from light to the colour itself."""
    from matplotlib.colors import to_rgb

    own = np.array(to_rgb(colour))
    shares = np.linspace(_LIGHTEST, 1.0, count)[:, None]
    return [(float(r), float(g), float(b)) for r, g, b in 1.0 - shares * (1.0 - own)]


def timed_labels(
    track: BodyTrack, rows: Sequence[int], axes: Array, size: float
) -> list[TimedLabel]:
    """The times of a body in some frames, and where they are written.

    A body that goes nowhere is labelled at its point that is farthest from its reference point, so
    that the labels tell how it is turned.

    Args:
        track: the body.
        rows: the frames.
        axes: (d, 3) directions of the picture.
        size: of the picture [m].
    """
    if track.moves_away:
        places = track.middles()[list(rows)] @ axes.T
    else:
        vertices = body_mesh(track.body, 8).vertices
        tip = vertices[int(np.argmax(np.linalg.norm(vertices, axis=1)))]
        places = track.points(tip[None])[list(rows), 0] @ axes.T
    kept: list[tuple[Array, list[str]]] = []
    for place, row in zip(places, rows, strict=True):
        time = f"{track.times[row]:.3g}"
        near = [each for at, each in kept if np.linalg.norm(at - place) < _APART * size]
        if near:
            near[0].append(time)
        else:
            kept.append((place, [time]))
    names = [f"{track.name}\n", *[""] * len(kept)]
    return [
        TimedLabel(f"{name}{', '.join(times)} s", at)
        for name, (at, times) in zip(names, kept, strict=False)
    ]


class FreeRoom:
    """Places in a picture where labels hide no other label."""

    def __init__(self, size: float) -> None:
        """A picture of a size [m], without labels."""
        self._size = size
        self._taken: list[tuple[Array, Array]] = []

    def place(self, label: TimedLabel, aside: bool = False) -> Array | None:
        """(2,) a free place for a label, which takes it; None if there is none.

        Args:
            label: the label.
            aside: whether it may stand beside its own place.
        """
        lines = label.text.split("\n")
        letters = max(len(line) for line in lines)
        extent = self._size * np.array([_LETTER * (letters + 1), _LINE * len(lines)])
        for shift in _ASIDE if aside else _ASIDE[:1]:
            place = label.at + shift * extent
            if all(
                np.any(np.abs(place - at) > 0.5 * (extent + other)) for at, other in self._taken
            ):
                self._taken.append((place, extent))
                return place
        return None


def draw_bodies(
    ax: Axes,
    tracks: Sequence[BodyTrack],
    rows: Sequence[int],
    view: Array,
    style: Style,
    robot: Sequence[TimedLabel] = (),
    widest: int = 60,
) -> None:
    """Outlines of bodies in some frames, the ways of their middles, and an entry in the legend.

    Limits of the axes grow by what is near all that was drawn before.

    Args:
        ax: the axes.
        tracks: the bodies.
        rows: the frames, rising.
        view: (2, 3) directions to the right and upwards.
        style: has `bodies`.
        robot: labels of the robot, which no other hides.
        widest: letters of a line in the legend.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.lines import Line2D

    if not tracks:
        return
    colour = style.colour("bodies")
    for k, (row, shade) in enumerate(zip(rows, shades(colour, len(rows)), strict=True)):
        polygons = [outline_of(s, view) for track in tracks for s in track.shapes(row)]
        drawn = PolyCollection(
            polygons, facecolor=shade, edgecolor=colour, lw=0.6, alpha=0.75, zorder=3.0 + 0.01 * k
        )
        ax.add_collection(drawn, autolim=False)
    for track in tracks:
        if track.moves_away:
            way = Line2D(*(track.middles() @ view.T).T, color=colour, lw=0.8, ls=":", zorder=2.9)
            ax.add_artist(way)
    ax.update_datalim(points_near(tracks, ax.dataLim.get_points(), view))
    _write_labels(ax, tracks, rows, view, colour, robot)
    text = fill(legend_text(style, tracks[0].times[list(rows)]), widest)
    ax.plot([], [], "s", ms=7, color=colour, label=text)


def draw_debris(
    ax: Axes, debris: DebrisTrack, rows: Sequence[int], view: Array, style: Style, widest: int = 60
) -> None:
    """Outlines of debris in some frames, from light to dark, and an entry in the legend.

    Limits of the axes do not grow: debris may be everywhere.

    Args:
        ax: the axes.
        debris: the spheres.
        rows: the frames, rising.
        view: (2, 3) directions to the right and upwards.
        style: has `bodies`.
        widest: letters of a line in the legend.
    """
    if not debris:
        return
    colour = style.colour("bodies")
    for k, (row, shade) in enumerate(zip(rows, shades(colour, len(rows)), strict=True)):
        ax.add_collection(discs(ax, debris, row, view, shade, 2.8 + 0.01 * k), autolim=False)
    known = ax.get_legend_handles_labels()[1]
    text = fill(legend_text(style, debris.times[list(rows)]), widest)
    if text not in known:
        ax.plot([], [], "s", ms=7, color=colour, label=text)


def discs(
    ax: Axes, debris: DebrisTrack, row: int, view: Array, colour: object, zorder: float
) -> EllipseCollection:
    """The spheres of debris in a frame, seen along a direction, those in front last.

    Args:
        ax: axes that will show them.
        debris: the spheres.
        row: the frame.
        view: (2, 3) directions to the right and upwards.
        colour: of them.
        zorder: of them.
    """
    from matplotlib.collections import EllipseCollection

    centers = debris.centers(row)
    order = np.argsort(centers @ np.cross(view[0], view[1]), kind="stable")
    sizes = 2.0 * debris.radii[order]
    return EllipseCollection(
        sizes, sizes, np.zeros(len(sizes)), units="xy", offsets=centers[order] @ view.T,
        offset_transform=ax.transData, facecolor=colour, edgecolor="none", alpha=0.75,
        zorder=zorder,
    )  # fmt: skip


def _write_labels(
    ax: Axes,
    tracks: Sequence[BodyTrack],
    rows: Sequence[int],
    view: Array,
    colour: str,
    robot: Sequence[TimedLabel],
) -> None:
    """Names of bodies, beside their places if need be, and times of few bodies that hide none."""
    if len(tracks) > _MOST_NAMED:
        return
    size = float(np.max(np.ptp(ax.dataLim.get_points(), axis=0)))
    room = FreeRoom(size)
    for label in robot:
        room.place(label)
    labels = [timed_labels(track, rows, view, size) for track in tracks]
    names = [own[0] for own in labels]
    if len(tracks) > MOST_LABELLED:
        names = [name._replace(text=name.text.split("\n")[0]) for name in names]
    later = [each for own in labels for each in own[1:]] if len(tracks) <= MOST_LABELLED else []
    beside = []
    for label in [*names, *later]:
        if room.place(label) is not None:
            write_tag(ax, label.text, label.at, colour=colour)
        elif any(label is name for name in names):
            beside.append(label)
    for label in beside:
        place = room.place(label, aside=True)
        if place is not None:
            leader = np.stack([label.at, place])
            ax.update_datalim([place + 0.6 * (place - label.at)])  # room for it in flat pictures
            ax.plot(*leader.T, color=colour, lw=0.6, zorder=7.9, scalex=False, scaley=False)
            write_tag(ax, label.text, place, colour=colour)


def legend_text(style: Style, times: Array) -> str:
    """The label of bodies; that of the figure itself says which times are light and dark."""
    label = style.label("bodies")
    if label != MOVING_LABEL:
        return label
    return f"{label}, light at {times[0]:.3g} s, dark at {times[-1]:.3g} s"


def write_tag(ax: Axes, text: str, place: Array, above: float = 0.0, colour: str = "black") -> None:
    """Small letters on white at a place (2,) [m], `above` it by so many points.

    They are left out where the place is not in the picture.
    """
    ax.annotate(
        text,
        (float(place[0]), float(place[1])),
        (0, above),
        textcoords="offset points",
        ha="center",
        va="center" if above == 0.0 else "baseline",
        fontsize=8,
        color=colour,
        zorder=8,
        annotation_clip=True,
        bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.75},
    )


def write_times(ax: Axes, track: Array, rows: Sequence[int], times: Array) -> list[TimedLabel]:
    """Times of silhouettes above the base.

    Args:
        ax: the axes.
        track: (N, 2) base origin in the picture [m].
        rows: the silhouettes.
        times: (N,) [s].

    Returns:
        The labels.
    """
    written = [TimedLabel(f"{times[row]:.3g} s", track[row]) for row in rows]
    for label in written:
        write_tag(ax, label.text, label.at, 7.0)
    return written
