"""Ants on the double bridge: how often the paper's ant system ends on the long branch.

Two branches lead from start to goal, one twice as long as the other: a lattice with one layer
between both, whose third node is blocked. Ants choose by pheromone alone, squared, and nothing
evaporates, as in the experiments with S-ACO. Here all ants finish before any lays its pheromone.
So the numbers of ants that went each way are a Markov chain, whose end is computed exactly.
"""

from __future__ import annotations

from math import comb

import numpy as np

from ffsr_plan.published_numbers.recomputed_number import OWN, RecomputedNumber

TRIALS = 1000
"""Runs of the colony for each number."""
_CYCLES = 60  # after which nearly all colonies have become unanimous
_SHORT, _LONG = 2.0, 4.0  # lengths of the branches [m]
_POWER = 2.0  # alpha
_LAID = 2.0  # Q [m]: pheromone 1 on the short branch, 1/2 on the long one
_SOURCE = (
    "M. Dorigo, T. Stuetzle (2004). Ant Colony Optimization. MIT Press, section 1.3; S. Goss, "
    "S. Aron, J.-L. Deneubourg, J. M. Pasteels (1989). Self-organized shortcuts in the Argentine "
    "ant. Naturwissenschaften 76"
)
_DIFFERS = (
    "the experiment is the source's, but no copy of its percentages was found, and its ants lay "
    f"pheromone while others walk; {TRIALS} trials, tolerance of four standard deviations"
)


def share_by_chain(ants: int, long: float = _LONG) -> float:
    """Probability that all ants of a cycle take the long branch before all take the short one.

    Args:
        ants: number of ants.
        long: length of that branch [m].
    """
    found, spread = 0.0, np.ones(1)  # of the number of ants that took the long branch
    for cycle in range(_CYCLES):
        took = np.arange(len(spread))
        pheromone = 1.0 + took * _LAID / long
        other = 1.0 + (ants * cycle - took) * _LAID / _SHORT
        chance = pheromone**_POWER / (pheromone**_POWER + other**_POWER)
        later = np.zeros(len(spread) + ants)
        for k in range(1, ants):
            drawn = comb(ants, k) * chance**k * (1.0 - chance) ** (ants - k)
            later[k : k + len(spread)] += spread * drawn
        found += float(spread @ chance**ants)
        spread = later
    return found


def share_by_colonies(ants: int, trials: int = TRIALS) -> float:
    """Share of colonies that took the long branch in the end.

    Args:
        ants: number of ants.
        trials: number of colonies.
    """
    from ffsr_plan.lattice.roadmap import Roadmap
    from ffsr_plan.problem.lattice_settings import Axis, Lattice
    from ffsr_plan.problem.problem import Problem
    from ffsr_plan.robots.loading import load_robot
    from ffsr_plan.scene.scene import Scene
    from ffsr_plan.search.ants.ant_system import AntSystem

    robot, half = load_robot("point"), 0.5 * _SHORT
    aside = float(np.sqrt((0.5 * _LONG) ** 2 - half**2))
    ends = robot.configuration(), robot.configuration(position=(_SHORT, 0.0, 0.0))
    lattice = Lattice(divisions=2, lateral=Axis(half_count=1, spacing=aside))
    blocked = Scene([[half, -aside, 0.0]], [0.3])
    roadmap = Roadmap(Problem(robot, blocked, *ends, lattice=lattice, delta=1e-9))
    colony = AntSystem(
        ants=ants, cycles=_CYCLES, alpha=_POWER, beta=0.0, rho=1.0 - 1e-12, Q=_LAID, C=1.0
    )
    rng, ended = np.random.default_rng(2004), 0
    for _ in range(trials):
        history = colony.search(roadmap, rng).history
        alone = history.distinct[-1] == 1
        ended += bool(alone and history.iteration_best[-1] > 0.5 * (_SHORT + _LONG))
    return ended / trials


def recomputed() -> list[RecomputedNumber]:
    """Per cent of colonies on the long branch, for 2, 4 and 8 ants."""
    numbers = []
    for ants in (2, 4, 8):
        share = share_by_chain(ants)
        tolerance = 400.0 * float(np.sqrt(share * (1.0 - share) / TRIALS))
        numbers.append(
            RecomputedNumber(
                f"double bridge: colonies of {ants} ants on the long branch", "%", OWN,
                100.0 * share, 100.0 * share_by_colonies(ants), tolerance, _SOURCE, _DIFFERS,
            )
        )  # fmt: skip
    return numbers
