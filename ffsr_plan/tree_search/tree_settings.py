"""Settings of the search by trees."""

from __future__ import annotations

from typing import Annotated

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Number, WholeNumber
from ffsr_plan.core.settings import settings
from ffsr_plan.problem.free_objective import STATIONS

_Reach = Annotated[float, Number(at_least=-1e3, at_most=1e3)]
LEAST_STEPS = STATIONS + 1
"""Steps of time come in multiples of this: at their ends F counts the clearance."""
MOST_CHECKS = 10**12
"""Configurations that a search may check."""


@settings
class TreeSettings:
    """Settings of trees, improvement and proof.

    Attributes:
        checks: configurations checked at most; without it 1 200 000, and as many as there is time
            for where `plan` has a time limit.
        reaches: longest edge towards a sample in each search of a round, in metres, where a radian
            counts as 0.6 m; negative where the tree from the start grows alone.
        joint_range: in every other search, how far samples of a joint may lie outside the values
            between start and goal [rad or m]; None for the joint's limits in all of them.
        first_checks: configurations checked at most by each search of the first round; each further
            round has twice as many.
        roots: attitudes on arrival that the tree from the goal assumes at most.
        ways: ways round that are improved side by side.
        margin: clearance that the search keeps, from obstacles and between links [m]; at most half
            of that at the start. Proofs need none of it.
        time_steps: where bodies move, steps of equal time in each of which the robot goes on along
            its path, waits or goes back; a multiple of 40.
        base_speed: of the base where bodies move, at most [m/s]; None for twice that of a steady
            run that takes the whole duration.
        joint_speed: of any joint where bodies move, at most [rad/s or m/s]; None likewise.
    """

    checks: Annotated[int, WholeNumber(at_least=1, at_most=MOST_CHECKS)] | None = None
    reaches: tuple[_Reach, ...] = (4.0, 1.6)
    joint_range: Annotated[float, Number(above=0.0, at_most=1e3)] | None = 2.5
    first_checks: Annotated[int, WholeNumber(at_least=1, at_most=MOST_CHECKS)] = 40_000
    roots: Annotated[int, WholeNumber(at_least=1, at_most=1000)] = 12
    ways: Annotated[int, WholeNumber(at_least=1, at_most=100)] = 3
    margin: Annotated[float, Number(at_least=1e-6, at_most=1e3)] = 1e-3
    time_steps: Annotated[int, WholeNumber(at_least=LEAST_STEPS, at_most=10_000)] = 80
    base_speed: Annotated[float, Number(above=0.0, at_most=1e6)] | None = None
    joint_speed: Annotated[float, Number(above=0.0, at_most=1e6)] | None = None

    def __post_init__(self) -> None:
        if not self.reaches or 0.0 in self.reaches:
            raise InvalidInput("reaches", self.reaches, "at least one length that is not zero")
        if self.time_steps % LEAST_STEPS:
            raise InvalidInput("time_steps", self.time_steps, f"a multiple of {LEAST_STEPS}")
