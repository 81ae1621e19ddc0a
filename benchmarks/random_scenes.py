"""Seeded random scenes and report files, shared by the benchmark commands.

A scene holds 4 to 11 spheres. The planar dual-arm robot moves 10 m past them, from the start
posture of `scenarios/fig2a.toml` to its goal posture; the length unit of F is one metre. No planner
was tuned on these scenes.
"""

from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from ffsr_plan.lattice.optimum import lattice_optimum
from ffsr_plan.scene.generators import scatter

FIRST_SEED = 1000
LATTICE = fp.Lattice(40, fp.Axis(20, 0.15))
"""40 divisions, 41 nodes in each layer."""
RESULTS = Path(__file__).parent.parent / "docs" / "benchmarks"


class Case(NamedTuple):
    """A scene that has a path.

    Attributes:
        seed: seed of the scene.
        roadmap: its roadmap. It is shared: use `roadmap.without_edge_states()` for a search.
        optimum: F of the exact lattice optimum.
    """

    seed: int
    roadmap: fp.Roadmap
    optimum: float


def random_problem(seed: int, delta: float, lattice: fp.Lattice = LATTICE) -> fp.Problem:
    """The random scene of a seed; the same for every delta and lattice."""
    ends = _ends()
    return fp.Problem(
        ends.robot,
        scatter(seed, (4, 11), (1.8, -3.0), (8.2, 3.0), (0.15, 0.5)),
        ends.start,
        ends.goal,
        delta=delta,
        length_unit=1.0,
        lattice=lattice,
    )


@cache
def _ends() -> fp.Problem:
    return fp.load_scenario("fig2a")


def cases(seeds: Iterable[int], delta: float, lattice: fp.Lattice = LATTICE) -> Iterator[Case]:
    """The scenes of these seeds, except those without a path or with an end in collision."""
    for seed in seeds:
        try:
            roadmap = fp.Roadmap(random_problem(seed, delta, lattice))
            optimum = roadmap.objective(lattice_optimum(roadmap.without_edge_states()))
        except (fp.NoPath, fp.StartInCollision, fp.GoalInCollision):
            continue
        yield Case(seed, roadmap, optimum)


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
        raise RuntimeError(f"scene {case.seed}: a path is {-excess:.2%} below the optimum")
    return max(0.0, excess)


def table(header: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A markdown table, its first column aligned left and all others right."""
    names = list(header)
    lines = [names, ["---", *["---:"] * (len(names) - 1)], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def publish(text: str, out: Path) -> None:
    """Write a report and print it."""
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(text, encoding="utf-8")
    print(text)
