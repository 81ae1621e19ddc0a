"""Settings of the search on lattices with posture axes."""

from __future__ import annotations

from typing import Annotated

from ffsr_plan.core.setting_rules import Number, Truth, WholeNumber
from ffsr_plan.core.settings import settings

_Positive = Annotated[float, Number(at_least=1e-9, at_most=1e9)]
PositivePair = tuple[_Positive, _Positive]
_SHIFTS_TO_TURN, _SHIFTS_TO_PASS = 3000, 1000


@settings
class AnnealingSettings:
    """Settings of ants and annealing.

    Attributes:
        ants: number of ants in a cycle, at least 1.
        cycles: largest number of cycles, at least 1.
        pheromone: whether ants lay and follow pheromone at all.
        detour_scale: detour [m] at which an ant takes a step e times less often than the best one.
        rho: persistence of pheromone, in (0, 1).
        least_pheromone: lower bound on pheromone, in (0, 1); tau starts at 1.
        patience: cycles without improvement after which the ants stop, at least 1.
        descent_shifts: segment shifts tried on the best ant of each cycle.
        annealing_shifts: segment shifts for each layer in each annealing; by default 3000 where the
            arms have to bring about a goal attitude, and 1000 otherwise.
        temperatures: pairs of temperatures [m], begin and end of each annealing after the ants.
            The first, hottest annealing decides how often the arms loop; the others improve the
            path that it leaves.
        attitude_weights: cost [m] of a radian of goal attitude error, at the beginning of an
            annealing and from half of its shifts on; the latter judges paths.
    """

    ants: Annotated[int, WholeNumber(at_least=1, at_most=100_000)] = 30
    cycles: Annotated[int, WholeNumber(at_least=1, at_most=1_000_000)] = 242
    pheromone: Annotated[bool, Truth()] = True
    detour_scale: _Positive = 0.15
    rho: Annotated[float, Number(above=0.0, below=1.0)] = 0.9
    least_pheromone: Annotated[float, Number(above=0.0, below=1.0)] = 0.02
    patience: Annotated[int, WholeNumber(at_least=1, at_most=1_000_000)] = 30
    descent_shifts: Annotated[int, WholeNumber(at_most=1_000_000)] = 200
    annealing_shifts: Annotated[int, WholeNumber(at_most=1_000_000)] | None = None
    temperatures: tuple[PositivePair, ...] = ((1.0, 0.03), (1.0, 1e-3), (0.3, 1e-3))
    attitude_weights: PositivePair = (5.0, 100.0)

    def shifts_per_layer(self, reach_attitude: bool) -> int:
        """Segment shifts for each layer in one annealing."""
        if self.annealing_shifts is not None:
            return self.annealing_shifts
        return _SHIFTS_TO_TURN if reach_attitude else _SHIFTS_TO_PASS
