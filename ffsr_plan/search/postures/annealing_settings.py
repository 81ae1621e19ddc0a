"""Settings of the search on lattices with posture axes."""

from __future__ import annotations

from dataclasses import dataclass

from ffsr_plan.core.checks import number, truth, whole_number
from ffsr_plan.core.errors import InvalidInput

_SHIFTS_TO_TURN, _SHIFTS_TO_PASS = 3000, 1000


@dataclass(frozen=True)
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
            How often the arms loop is settled by the first, hot one; the cooler ones improve the
            path that it leaves.
        attitude_weights: cost [m] of a radian of goal attitude error, at the beginning of an
            annealing and from half of its shifts on; the latter judges paths.
    """

    ants: int = 30
    cycles: int = 242
    pheromone: bool = True
    detour_scale: float = 0.15
    rho: float = 0.9
    least_pheromone: float = 0.02
    patience: int = 30
    descent_shifts: int = 200
    annealing_shifts: int | None = None
    temperatures: tuple[tuple[float, float], ...] = ((1.0, 0.03), (1.0, 1e-3), (0.3, 1e-3))
    attitude_weights: tuple[float, float] = (5.0, 100.0)

    def __post_init__(self) -> None:
        given = self.annealing_shifts
        checked = {
            "ants": whole_number("ants", self.ants, at_least=1, at_most=100_000),
            "cycles": whole_number("cycles", self.cycles, at_least=1),
            "pheromone": truth("pheromone", self.pheromone),
            "detour_scale": number("detour_scale", self.detour_scale, above=0.0),
            "rho": number("rho", self.rho, above=0.0, below=1.0),
            "least_pheromone": number("least_pheromone", self.least_pheromone, above=0.0, below=1),
            "patience": whole_number("patience", self.patience, at_least=1),
            "descent_shifts": whole_number("descent_shifts", self.descent_shifts, at_least=0),
            "annealing_shifts": None
            if given is None
            else whole_number("annealing_shifts", given, at_least=0),
            "temperatures": _pairs("temperatures", self.temperatures),
            "attitude_weights": _pairs("attitude_weights", [self.attitude_weights])[0],
        }
        for field, value in checked.items():
            object.__setattr__(self, field, value)

    def shifts_per_layer(self, reach_attitude: bool) -> int:
        """Segment shifts for each layer in one annealing."""
        if self.annealing_shifts is not None:
            return self.annealing_shifts
        return _SHIFTS_TO_TURN if reach_attitude else _SHIFTS_TO_PASS


def _pairs(what: str, value: object) -> tuple[tuple[float, float], ...]:
    allowed = "pairs of numbers greater than 0"
    if not isinstance(value, (list, tuple)):
        raise InvalidInput(what, value, allowed)
    result = []
    for pair in value:
        if not isinstance(pair, (list, tuple)) or len(pair) != 2:
            raise InvalidInput(what, value, allowed)
        first, second = (number(what, entry, above=0.0) for entry in pair)
        result.append((first, second))
    return tuple(result)
