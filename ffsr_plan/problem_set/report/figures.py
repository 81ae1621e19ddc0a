"""Pictures of judged results: success and cost over time, profiles, gap and clearance."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ffsr_plan.display.figure_style import SERIES
from ffsr_plan.problem_set.best_plans import BestPlans
from ffsr_plan.problem_set.judging.result_files import Judged, JudgedRow
from ffsr_plan.problem_set.report.profiles import (
    cost_over_time,
    performance_profile,
    success_over_time,
    times_and_costs,
)
from ffsr_plan.problem_set.report.summary import families_of, ratios
from ffsr_plan.studies.report.figures import BOXES, draw_boxes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTH, _HEIGHT, _PANEL = 9.0, 3.8, 1.9  # [in]
_COLUMNS = 4  # of panels by family
_BOX = 0.7  # share of the room between two families that boxes take
_GREY = "#9aa0a8"
_STYLES = ("-", "--", "-.", ":")
_CAPTIONS = {
    "success": "Share of tasks with a path after some time. Tasks without a path count too.",
    "success_by_family": "The same in each family of problems.",
    "cost": "Median of F of the best path by then over the best F known; bands go from quartile to "
    "quartile. A task without a path counts as infinite.",
    "profiles": "Share of tasks on which time and F of a planner are within a factor of the best "
    "planner's.",
    "gap": f"F of the paths above the best F known, by family. {BOXES}",
    "clearance": f"Least clearance of the paths, by family. {BOXES}",
}


def bench_figures(
    judged: Sequence[Judged], titles: dict[str, str], best: BestPlans
) -> dict[str, Figure]:
    """The pictures, by name; the label of each is its caption.

    Args:
        judged: rows of planners, at least one of which has a row.
        titles: of the families, by name.
        best: the best plans.
    """
    families = families_of(judged, titles)
    found = {"success": _success(judged), "success_by_family": _by_family(judged, families)}
    if any(ratios(each.rows, best) for each in judged):
        found["cost"] = _cost(judged, best)
    if len(judged) > 1:
        found["profiles"] = _profiles(judged)
    found["gap"] = _boxes_by_family(
        judged, families, lambda rows: _gap_values(rows, best), "F above the best known [%]"
    )
    found["clearance"] = _boxes_by_family(
        judged, families, _clearances, "least clearance [m]", from_zero=True
    )
    for name, figure in found.items():
        figure.set_label(_CAPTIONS[name])
    return found


def _success(judged: Sequence[Judged]) -> Figure:
    figure, axes = _figure(1, 1, _HEIGHT)
    _success_curves(axes[0], judged, None)
    axes[0].set_xlabel("time to the first path [s]")
    axes[0].set_ylabel("tasks solved [%]")
    _legend(figure, axes[0])
    return figure


def _by_family(judged: Sequence[Judged], families: Sequence[str]) -> Figure:
    lines = math.ceil(len(families) / _COLUMNS)
    figure, axes = _figure(lines, _COLUMNS, _PANEL * lines + 0.5)
    for ax, family in zip(axes, families, strict=False):
        _success_curves(ax, judged, family)
        ax.set_title(family, fontsize=9, loc="left")
    for ax in axes[len(families) :]:
        ax.set_axis_off()
    figure.supxlabel("time to the first path [s]", fontsize=9)
    figure.supylabel("tasks solved [%]", fontsize=9)
    if len(judged) > 1:
        _legend(figure, axes[0])
    return figure


def _success_curves(ax: Axes, judged: Sequence[Judged], family: str | None) -> None:
    for k, each in enumerate(judged):
        rows = [row for row in each.rows if family in (None, row.family)]
        if not rows:
            continue
        times, shares = success_over_time(rows)
        last = 100.0 * (shares[-1] if shares else 0.0)
        values = [0.0, *(100.0 * share for share in shares), last]
        steps = [1e-3, *(max(time, 1e-3) for time in times), 1e3]
        ax.step(steps, values, where="post", label=each.planner, **_line(k))
    ax.set_xscale("log")
    ax.set_xlim(1e-2, 1e2)
    ax.set_ylim(0.0, 102.0)


def _cost(judged: Sequence[Judged], best: BestPlans) -> Figure:
    figure, (ax,) = _figure(1, 1, _HEIGHT)
    times, top = np.geomspace(0.02, 60.0, 200), 1.1
    for k, each in enumerate(judged):
        quartiles = cost_over_time(each.rows, best, times)
        ax.plot(times, _drawn(quartiles[:, 1]), label=each.planner, **_line(k))
        ax.fill_between(
            times, _drawn(quartiles[:, 0]), _drawn(quartiles[:, 2]), color=_colour(k), alpha=0.12
        )
        finite = quartiles[np.isfinite(quartiles)]
        top = max(top, float(finite.max(initial=1.0)))
    ax.set_xscale("log")
    ax.set_ylim(0.98, min(1.02 * top, 3.0))
    ax.set_xlabel("time [s]")
    ax.set_ylabel("F / best known, median and quartiles")
    _legend(figure, ax)
    return figure


def _drawn(values: Any) -> Any:  # noqa: ANN401 - an array
    return np.where(np.isfinite(values), values, np.nan)


def _profiles(judged: Sequence[Judged]) -> Figure:
    figure, axes = _figure(1, 2, _HEIGHT)
    names = ("time to the first path", "F")
    for ax, values, name in zip(axes, times_and_costs(judged), names, strict=True):
        for k, (planner, found) in enumerate(performance_profile(values).items()):
            finite = [each for each in found if math.isfinite(each)]
            shares = 100.0 * np.arange(1, len(finite) + 1) / max(len(found), 1)
            last = shares[-1] if len(shares) else 0.0
            steps = [1.0, *finite, 1e6]
            ax.step(steps, [0.0, *shares, last], where="post", label=planner, **_line(k))
        ax.set_xlabel(f"{name}, factor of the best planner's")
        ax.set_ylim(0.0, 102.0)
    axes[0].set_ylabel("tasks [%]")
    axes[0].set_xscale("log")
    axes[0].set_xlim(1.0, 1e3)
    axes[1].set_xlim(1.0, 2.0)
    _legend(figure, axes[0])
    return figure


def _boxes_by_family(
    judged: Sequence[Judged],
    families: Sequence[str],
    values_of: Callable[[Sequence[JudgedRow]], list[float]],
    label: str,
    from_zero: bool = False,
) -> Figure:
    figure, (ax,) = _figure(1, 1, _HEIGHT)
    width = _BOX / len(judged)
    for k, each in enumerate(judged):
        groups = [values_of([r for r in each.rows if r.family == name]) for name in families]
        place = (k + 0.5) / len(judged) - 0.5
        at = [j + _BOX * place for j in range(len(families))]
        draw_boxes(ax, groups, at, width, _colour(k))
        ax.plot([], [], label=each.planner, color=_colour(k), linewidth=6, alpha=0.5)
    ax.set_xticks(range(len(families)), families, rotation=25, ha="right")
    ax.set_xlim(-0.6, len(families) - 0.4)
    ax.set_ylabel(label)
    if from_zero:
        ax.set_ylim(bottom=0.0)
    _legend(figure, ax)
    return figure


def _gap_values(rows: Sequence[JudgedRow], best: BestPlans) -> list[float]:
    return [100.0 * (each - 1.0) for each in ratios(rows, best)]


def _clearances(rows: Sequence[JudgedRow]) -> list[float]:
    return [row.clearance for row in rows if row.clearance is not None]


def _figure(lines: int, columns: int, height: float) -> tuple[Figure, list[Axes]]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_WIDTH, height), layout="constrained")
    made = list(figure.subplots(lines, columns, squeeze=False).ravel())
    for ax in made:
        ax.spines[["top", "right"]].set_visible(False)
        ax.grid(axis="y", color=_GREY, alpha=0.25)
        ax.set_axisbelow(True)
        ax.tick_params(labelsize=8)
    return figure, made


def _colour(k: int) -> str:
    return SERIES[k % len(SERIES)]


def _line(k: int) -> dict[str, Any]:
    style = _STYLES[k // len(SERIES) % len(_STYLES)]
    return {"color": _colour(k), "linestyle": style, "linewidth": 1.6}


def _legend(figure: Figure, ax: Axes) -> None:
    handles, labels = ax.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=4, frameon=False, fontsize=8)
