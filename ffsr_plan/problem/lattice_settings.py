"""Settings of a lattice: how many layers, and along which axes its nodes are offset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ffsr_plan.core.checks import number, whole_number
from ffsr_plan.core.errors import InvalidInput


@dataclass(frozen=True)
class Axis:
    """Offsets -n h, .., 0, .., n h along one direction: 2 n + 1 of them.

    Attributes:
        half_count: n, at least 1 (the paper's n_ac).
        spacing: h [m], greater than 0.
    """

    half_count: int
    spacing: float

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "half_count", whole_number("half_count", self.half_count, at_least=1))
        set_(self, "spacing", number("spacing", self.spacing, above=0.0, at_most=1e6))


@dataclass(frozen=True, init=False)
class PostureAxis:
    """Displacements of the joints: along a direction, or towards a posture of the robot.

    Along a direction, index k in -n .. n displaces the joints by k h d. Towards a posture
    (`PostureAxis.towards`), index k in 0 .. levels takes the joints that the posture names the
    share k / levels of the way from where they would be to where the posture has them.

    Attributes:
        joints: the direction d, joint names with what they move by [rad or m] for each unit of h.
        half_count: n; 0 where the axis leads towards a posture.
        spacing: h; 0 where the axis leads towards a posture.
        posture: name of the posture, or empty.
        levels: number of steps towards it, or 0.
    """

    joints: tuple[tuple[str, float], ...]
    half_count: int
    spacing: float
    posture: str
    levels: int

    def __init__(self, joints: Mapping[str, float], half_count: int, spacing: float) -> None:
        """An axis along a direction in joint space.

        Raises:
            InvalidInput: no joint moves, or a number that is not allowed.
        """
        if not isinstance(joints, Mapping) or not joints:
            raise InvalidInput("posture axis, joints", joints, "joint names with what they move by")
        moves = {str(name): number(f"posture axis, {name}", v) for name, v in joints.items()}
        if not any(moves.values()):
            raise InvalidInput("posture axis, joints", joints, "a joint that moves")
        n = whole_number("posture axis, half_count", half_count, at_least=1, at_most=1000)
        h = number("posture axis, spacing", spacing, above=0.0, at_most=100.0)
        self._fill(tuple(moves.items()), n, h, "", 0)

    @classmethod
    def towards(cls, posture: str, levels: int) -> PostureAxis:
        """An axis towards a named posture of the robot, all the way in `levels` steps."""
        if not isinstance(posture, str) or not posture:
            raise InvalidInput("posture axis, towards", posture, "the name of a posture")
        axis = cls.__new__(cls)
        count = whole_number("posture axis, levels", levels, at_least=1, at_most=1000)
        axis._fill((), 0, 0.0, posture, count)
        return axis

    @property
    def indices(self) -> range:
        """All indices along the axis; 0 displaces nothing."""
        return (
            range(self.levels + 1) if self.posture else range(-self.half_count, self.half_count + 1)
        )

    def _fill(self, *values: object) -> None:
        for name, value in zip(self.__dataclass_fields__, values, strict=True):
            object.__setattr__(self, name, value)


@dataclass(frozen=True)
class Lattice:
    """Layers 0 .. m between start and goal, nodes offset across the direction of travel.

    Attributes:
        divisions: m, at least 2; the paper's 40 by default.
        lateral: offsets along x' of the path frame (the paper's), or None.
        normal: offsets along y' of the path frame, for three-dimensional scenes, or None.
        postures: displacements of the joints.
    """

    divisions: int = 40
    lateral: Axis | None = None
    normal: Axis | None = None
    postures: Sequence[PostureAxis] = ()

    def __post_init__(self) -> None:
        m = whole_number("divisions", self.divisions, at_least=2)
        object.__setattr__(self, "divisions", m)
        for name in ("lateral", "normal"):
            axis = getattr(self, name)
            if axis is not None and not isinstance(axis, Axis):
                raise InvalidInput(name, axis, "an Axis(half_count, spacing) or None")
        given = self.postures
        if not isinstance(given, Sequence) or not all(isinstance(a, PostureAxis) for a in given):
            raise InvalidInput("postures", given, "a list of PostureAxis")
        object.__setattr__(self, "postures", tuple(given))

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the axes along which the base is offset, in the order of node indices."""
        return tuple(name for name in ("lateral", "normal") if getattr(self, name) is not None)
