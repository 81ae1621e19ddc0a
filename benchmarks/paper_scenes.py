"""Scenes of family `paper` of the problem set, with another delta and lattice, for the studies.

Problems `paper/02` to `paper/29` hold 4 to 11 spheres each. The planar dual-arm robot moves 10 m
past them, from the start posture of `scenarios/fig2a.toml` to its goal posture. Problems `paper/00`
and `paper/01` are that scenario's own scene and are left out. The length unit of F is one metre. No
planner was tuned on these scenes.
"""

import argparse
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from ffsr_plan.lattice.optimum import lattice_optimum

NUMBERS = range(2, 30)
"""Numbers in the family of the problems that are no scene of Fig. 2."""
LATTICE = fp.Lattice(40, fp.Axis(20, 0.15))
"""40 divisions, 41 nodes in each layer: the lattice of these problems."""


class Case(NamedTuple):
    """A scene that has a path.

    Attributes:
        number: of the problem in family `paper`.
        roadmap: its roadmap. It is shared: use `roadmap.without_edge_states()` for a search.
        optimum: F of the exact lattice optimum.
    """

    number: int
    roadmap: fp.Roadmap
    optimum: float

    @property
    def name(self) -> str:
        """Name of the problem in the set."""
        return problem_name(self.number)


def problem_name(number: int) -> str:
    """Name in the problem set, such as `paper/07`."""
    return f"paper/{number:02d}"


def paper_problem(number: int, delta: float, lattice: fp.Lattice = LATTICE) -> fp.Problem:
    """Robot, ends and spheres of a problem of family `paper`, with this delta and lattice.

    Args:
        number: in the family, one of `NUMBERS`.
        delta: weight of clearances in F [m^2].
        lattice: of the problem.
    """
    return replace(_scene(number), delta=delta, length_unit=1.0, lattice=lattice)


@cache
def _scene(number: int) -> fp.Problem:
    """The problem as the set has it."""
    return fp.ProblemSet()[problem_name(number)].problem


def add_problems_option(parser: argparse.ArgumentParser, default: int = len(NUMBERS)) -> None:
    """Option `--problems N`: the first N of `NUMBERS`.

    Args:
        parser: that gets the option.
        default: N where the option is not given.
    """
    parser.add_argument(
        "--problems",
        type=int,
        choices=range(1, len(NUMBERS) + 1),
        metavar="N",
        default=default,
        help=f"first problems of family `paper`, from {problem_name(NUMBERS[0])} on: 1 to "
        f"{len(NUMBERS)}",
    )


def cases(numbers: Iterable[int], delta: float, lattice: fp.Lattice = LATTICE) -> Iterator[Case]:
    """The scenes of these numbers, except those without a path or with an end in collision."""
    for number in numbers:
        try:
            roadmap = fp.Roadmap(paper_problem(number, delta, lattice))
            optimum = roadmap.objective(lattice_optimum(roadmap.without_edge_states()))
        except (fp.NoPath, fp.StartInCollision, fp.GoalInCollision):
            continue
        yield Case(number, roadmap, optimum)


def gap(case: Case, roadmap: fp.Roadmap, path: np.ndarray) -> float:
    """Relative excess of a path's F over the optimum, as in `Plan.gap`.

    Args:
        case: the scene.
        roadmap: the roadmap that was searched.
        path: (m + 1,) nodes.

    Raises:
        RuntimeError: the path lies below the optimum, so that the optimum is wrong.
    """
    excess = roadmap.objective(path) / case.optimum - 1.0
    if excess < -1e-9:
        raise RuntimeError(f"{case.name}: a path is {-excess:.2%} below the optimum")
    return max(0.0, excess)
