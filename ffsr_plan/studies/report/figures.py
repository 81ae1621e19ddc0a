"""Pictures of a study: success over time, costs compared, figures by the values of an axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ffsr_plan.display.figure_style import SERIES
from ffsr_plan.studies.report.summary import (
    Row,
    by,
    compared_axes,
    cost_ratios,
    numbers,
    shown_value,
    values_of,
)
from ffsr_plan.studies.tasks.row import PLAN

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTH, _HEIGHT = 7.2, 3.6  # [in]
_BOX = 0.7  # share of the room between two values that boxes take
_GREY = "#9aa0a8"
_SAME_COST = 1.0005
BOXES = "Boxes go from quartile to quartile, with the median; whiskers from 5 to 95 %."
"""What boxes of a picture are."""


def study_figures(rows: Sequence[Row], axes: Sequence[str]) -> dict[str, Figure]:
    """The pictures of a study, by name; those for which there are no numbers are left out.

    The label of each picture is its caption.

    Args:
        rows: of the study.
        axes: names of its axes.
    """
    plans = [row for row in rows if row["outcome"] == PLAN]
    planners = list(dict.fromkeys(row["planner"] for row in rows))
    found: dict[str, Figure] = {}
    if numbers(plans, "seconds"):
        found["success"] = _success(rows, planners)
    if len(planners) > 1 and _differ(cost_ratios(rows)):
        found["costs"] = _costs(rows, planners)
    for k, axis in enumerate(compared_axes(rows, axes), 1):
        if numbers([row for row in plans if row.get(axis) is not None], "objective"):
            found[f"axis_{k}"] = _by_axis(rows, planners, axis)
    return found


def _differ(ratios: dict[str, list[float]]) -> bool:
    """Whether there is anything to see in a picture of costs."""
    return any(each > _SAME_COST for values in ratios.values() for each in values)


def _success(rows: Sequence[Row], planners: Sequence[str]) -> Figure:
    """Share of tasks that had a plan after some computing time."""
    figure, (ax,) = _figure(1)
    groups, latest = by(rows, lambda row: row["planner"]), 0.0
    times = {name: _times(groups[name]) for name in planners}
    latest = max((values[-1] for values in times.values() if values), default=1.0)
    first = min((values[0] for values in times.values() if values), default=0.1)
    for k, name in enumerate(planners):
        values, total = times[name], len(groups[name])
        shares = 100.0 * np.arange(len(values) + 1) / total
        steps = [0.5 * first, *values]
        ax.step([*steps, 2 * latest], [*shares, shares[-1]], where="post", **_line(k), label=name)
    ax.set_xscale("log")
    ax.set_xlim(0.7 * first, 1.4 * latest)
    ax.set_ylim(0.0, 102.0)
    figure.set_label(
        "Share of the tasks of a planner that had a plan after some computing time. Tasks without "
        "a plan count too."
    )
    ax.set_xlabel("computing time of one plan [s]")
    ax.set_ylabel("tasks with a plan [%]")
    _legend(ax)
    return figure


def _times(rows: Sequence[Row]) -> list[float]:
    planned = [row for row in rows if row["outcome"] == PLAN]
    return sorted(max(each, 1e-4) for each in numbers(planned, "seconds"))


def _costs(rows: Sequence[Row], planners: Sequence[str]) -> Figure:
    """Share of tasks whose F is within a factor of the best one of their problem."""
    figure, (ax,) = _figure(1)
    ratios = cost_ratios(rows)
    finite = [each for values in ratios.values() for each in values if math.isfinite(each)]
    most = max(1.02, float(np.quantile(finite, 0.99)))
    for k, name in enumerate(planners):
        values = sorted(ratios.get(name, []))
        inside = [100.0 * (each - 1.0) for each in values if math.isfinite(each)]
        shares = 100.0 * np.arange(len(inside) + 1) / max(len(values), 1)
        ax.step([0.0, *inside, 1e6], [*shares, shares[-1]], where="post", **_line(k), label=name)
    ax.set_xlim(0.0, 100.0 * (most - 1.0))
    ax.set_ylim(0.0, 102.0)
    figure.set_label(
        "Share of the tasks of a planner whose F is at most so much above the best of all planners "
        "and seeds, on problems that any of them solves."
    )
    ax.set_xlabel("F above the best of all planners and seeds on the same problem [%]")
    ax.set_ylabel("tasks [%], of solved problems")
    _legend(ax)
    return figure


def _by_axis(rows: Sequence[Row], planners: Sequence[str], axis: str) -> Figure:
    """Boxes of F and of the proven clearance by the values of an axis, and the success."""
    values = values_of(rows, axis)
    figure, (left, middle, right) = _figure(3)
    for k, name in enumerate(planners):
        own = [row for row in rows if row["planner"] == name]
        cells = [[row for row in own if row.get(axis) == value] for value in values]
        planned = [[row for row in cell if row["outcome"] == PLAN] for cell in cells]
        place = (k + 0.5) / len(planners) - 0.5
        width = _BOX / len(planners)
        at = np.arange(len(values)) + _BOX * place
        share = [
            100.0 * len(found) / len(cell) if cell else math.nan
            for found, cell in zip(planned, cells, strict=True)
        ]
        left.bar(at, share, 0.9 * width, color=SERIES[k % len(SERIES)], label=name)
        colour = SERIES[k % len(SERIES)]
        draw_boxes(middle, [numbers(p, "objective") for p in planned], at.tolist(), width, colour)
        draw_boxes(
            right, [numbers(p, "least_clearance") for p in planned], at.tolist(), width, colour
        )
    left.set_ylim(0.0, 102.0)
    titles = ("tasks with a plan [%]", "objective F", "proven clearance [m]")
    for ax, title in zip((left, middle, right), titles, strict=True):
        ax.set_title(title, fontsize=9, loc="left")
        ax.set_xticks(range(len(values)), [shown_value(value) for value in values])
        ax.set_xlim(-0.6, len(values) - 0.4)
        ax.set_xlabel(axis)
    right.set_ylim(bottom=0.0)
    figure.set_label(f"Success, F and proven clearance of plans by {axis}. {BOXES}")
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=4, frameon=False, fontsize=8)
    return figure


def draw_boxes(
    ax: Axes, data: Sequence[Sequence[float]], at: Sequence[float], width: float, colour: str
) -> None:
    """Boxes from quartile to quartile with the median, whiskers from 5 to 95 %.

    Args:
        ax: where they are drawn.
        data: values of each box; without values there is none.
        at: places of the boxes.
        width: room for a box.
        colour: of them.
    """
    filled = [(place, values) for place, values in zip(at, data, strict=True) if values]
    if not filled:
        return
    ax.boxplot(
        [values for _, values in filled],
        positions=[place for place, _ in filled],
        widths=0.8 * width,
        whis=(5, 95),
        showfliers=False,
        patch_artist=True,
        manage_ticks=False,
        boxprops={"facecolor": colour, "alpha": 0.35, "edgecolor": colour},
        medianprops={"color": colour, "linewidth": 1.8},
        whiskerprops={"color": colour},
        capprops={"color": colour},
    )


def _figure(columns: int) -> tuple[Figure, list[Axes]]:
    from matplotlib.figure import Figure

    width = _WIDTH if columns == 1 else 1.35 * _WIDTH
    figure = Figure(figsize=(width, _HEIGHT), layout="constrained")
    made = figure.subplots(1, columns, squeeze=False)[0]
    for ax in made:
        ax.spines[["top", "right"]].set_visible(False)
        ax.grid(axis="y", color=_GREY, alpha=0.25)
        ax.set_axisbelow(True)
        ax.tick_params(labelsize=8)
    return figure, list(made)


def _line(k: int) -> dict[str, Any]:
    styles = ("-", "--", "-.", ":")
    return {"color": SERIES[k % len(SERIES)], "linewidth": 1.8, "linestyle": styles[k % 4]}


def _legend(ax: Axes) -> None:
    ax.legend(frameon=False, fontsize=8, loc="best")
