"""Modes of actuation: what moves the base besides the arms."""

from __future__ import annotations

from enum import Enum

from ffsr_plan.core.checks import one_of


class Mode(str, Enum):
    """What actuates the base. Members equal their text: `Mode.FREE_FLYING == "free-flying"`.

    free-flying    thrusters translate the base, its attitude reacts to the arms (the paper's case)
    attitude-held  thrusters translate the base, wheels hold its prescribed attitude
    free-floating  nothing actuates the base: position and attitude react to the arms
    """

    FREE_FLYING = "free-flying"
    ATTITUDE_HELD = "attitude-held"
    FREE_FLOATING = "free-floating"

    @classmethod
    def parse(cls, what: str, value: object) -> Mode:
        """The mode of that name; `what` names the argument in the error.

        Raises:
            InvalidInput: an unknown mode; the nearest name is suggested.
        """
        if isinstance(value, cls):
            return value
        return cls(one_of(what, value, [mode.value for mode in cls]))

    @property
    def has_thrusters(self) -> bool:
        """Whether thrusters translate the base."""
        return self is not Mode.FREE_FLOATING

    @property
    def has_wheels(self) -> bool:
        """Whether wheels hold the attitude that the problem prescribes."""
        return self is Mode.ATTITUDE_HELD

    @property
    def attitude_reacts(self) -> bool:
        """Whether the attitude of the base follows from the motion of the arms."""
        return not self.has_wheels

    @property
    def floats(self) -> bool:
        """Whether the position of the base follows from the motion of the arms too."""
        return not self.has_thrusters

    def __str__(self) -> str:
        return self.value

    def __format__(self, spec: str) -> str:
        return format(self.value, spec)
