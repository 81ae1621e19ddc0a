"""What may help where a lattice holds no path, or none could be proven: advice for errors."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ffsr_plan.problem.posture_axes import PostureAxis, PostureTarget
from ffsr_plan.problem.problem import Problem


def against_obstacles(problem: Problem, ends: tuple[float, float]) -> tuple[str, ...]:
    """What may help where obstacles close a lattice without posture axes.

    Args:
        problem: gives the lattice and the mode.
        ends: clearances at start and goal [m].
    """
    near = [
        f"a {name} with more clearance than the tolerance of {problem.tolerance:g} m, below which "
        f"nothing can be proven: it has {clearance:.3g} m"
        for name, clearance in zip(("start", "goal"), ends, strict=True)
        if clearance <= problem.tolerance
    ]
    if near:
        return tuple(near)
    advice = [*_offsets(problem)]
    if problem.scene.moves:
        advice.append("lattice.progress, with which the robot can wait; another duration or ramp")
    if problem.given_lattice.axes:
        advice.append(f"more than {problem.given_lattice.divisions} divisions")
    if problem.robot.nd:
        only = "" if advice else ": this lattice holds one path, and divisions do not change it"
        advice.append(f"posture axes (lattice.postures), by which the joints give way{only}")
    advice.append("another start or goal")
    return tuple(advice)


def against_self_collision() -> tuple[str, ...]:
    """What may help where links meet each other on the straight way of the joints."""
    return (
        "other joint values at start or goal, or posture axes (lattice.postures): no offset of the "
        "base changes the way of the joints",
        "an SRDF that exempts the links if they are designed to touch",
    )


def for_proof(problem: Problem, cut_short: bool, links: bool) -> tuple[str, ...]:
    """What may help where the path of a random search with posture axes was not proven.

    Args:
        problem: gives the lattice and the mode.
        cut_short: whether a time limit ended the search.
        links: whether two links come too close, rather than a link and an obstacle.
    """
    advice = ["a longer time_limit, which ended the search"] if cut_short else []
    advice += ["another seed", "more annealing_shifts"]
    advice += [] if links else _offsets(problem)
    for k, axis in enumerate(problem.given_lattice.postures):
        advice.append(f"lattice.postures.{k}, {_of_posture_axis(axis)}")
    return (*advice, f"more than {problem.given_lattice.divisions} divisions")


def against_closed_times(problem: Problem) -> tuple[str, ...]:
    """What may help where a lattice with progress holds no path.

    Args:
        problem: gives the lattice.
    """
    lattice = problem.given_lattice
    progress = lattice.progress
    assert progress is not None
    needed = -(-progress.steps // progress.most)
    if lattice.divisions < needed:
        return (
            f"at least {needed} divisions: the goal is {progress.steps} steps of progress away",
        )
    advice = [
        f"lattice.progress, with before {progress.before} and beyond {progress.beyond}: more, so "
        "that the robot can give way behind the start and beyond the goal",
        f"more than {lattice.divisions} divisions",
    ]
    advice += ["a longer duration"] if problem.duration is not None else []
    return (*_offsets(problem), *advice)


def _offsets(problem: Problem) -> Iterator[str]:
    """The axes across the way of the base: those that exist, and those that could."""
    travels = bool(np.any(problem.base_displacement != 0.0))
    for name in ("lateral", "normal"):
        axis = getattr(problem.given_lattice, name)
        if axis is not None:
            yield (
                f"lattice.{name}, which has half_count {axis.half_count} and spacing "
                f"{axis.spacing:g} m: wider, or finer"
            )
        elif travels:
            yield f"a {name} axis (lattice.{name}), which this lattice does not have"


def _of_posture_axis(axis: PostureAxis | PostureTarget) -> str:
    if isinstance(axis, PostureTarget):
        return f"which has {axis.levels} levels towards '{axis.towards}': more, or another posture"
    names = ", ".join(name for name, _ in axis.joints)
    return (
        f"which moves {names} with half_count {axis.half_count} and spacing {axis.spacing:g}: "
        "wider, finer, or other joints"
    )
