"""The error for a pose that no joint values were found for, and what it knows of the cause."""
# ruff: noqa: N818 - the names are part of the public contract

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import PlanningError, helping

Cause = Literal["base reaction", "joint limits", "attitude", "too far", "too close", "unknown"]


class HeldBase(NamedTuple):
    """What a robot reaches from the place of its base if wheels hold the start's attitude.

    Attributes:
        reached: whether it reaches the wanted pose.
        rotation: angle by which the reaction turns a base that is not held, on the straight way to
            the joint values at which the pose is reached or missed least [rad].
        position_missed: by how much the frame then misses the wanted position [m]; where the pose
            is not reached, by how much the held one does.
    """

    reached: bool
    rotation: float
    position_missed: float


class ArmReach(NamedTuple):
    """How far a pose is from the arm, and how far the arm reaches, on a base that is held.

    Attributes:
        mount: name of the joint that mounts the arm on the base.
        distance: from there to the wanted position [m].
        reach: from there to the frame where it comes nearest to the wanted position [m]: less than
            `distance` where that is too far, more where it is too close.
    """

    mount: str
    distance: float
    reach: float


class JointBeyond(NamedTuple):
    """A joint that would have to go beyond its limits.

    Attributes:
        joint: its name.
        value: that it would have [rad].
        lower: its least value [rad].
        upper: its greatest value [rad].
    """

    joint: str
    value: float
    lower: float
    upper: float


@dataclass(eq=False, repr=False)
class PoseOutOfReach(PlanningError):
    """No joint values were found that bring a frame to the wanted pose.

    Attributes:
        frame: name of the frame.
        position_missed: distance from the wanted position at the best configuration [m].
        attitude_missed: angle from the wanted attitude there [rad]; None if any is allowed.
        configuration: (nq,) the configuration of the least error, in which one metre counts as
            much as one radian.
        held_base: what a base that wheels hold would reach; None if they do hold it.
        without_attitude: whether the position alone is reached; None if no attitude is wanted.
        advice: what may help.
        arm: distance and reach from the arm's mount, if the position is too far or too close.
        beyond: joints that would have to go beyond their limits, if the pose is reached then.
    """

    frame: str
    position_missed: float
    attitude_missed: float | None
    configuration: Array
    held_base: HeldBase | None = None
    without_attitude: bool | None = None
    advice: tuple[str, ...] = ()
    arm: ArmReach | None = None
    beyond: tuple[JointBeyond, ...] = ()

    @property
    def cause(self) -> Cause:
        """Why, as far as local searches tell.

        `base reaction`: a held base reaches the pose; `joint limits`: wider limits would do;
        `attitude`: the position alone is reached; `too far` or `too close` for the arm; or
        `unknown`.
        """
        if self.held_base is not None and self.held_base.reached:
            return "base reaction"
        if self.beyond:
            return "joint limits"
        if self.without_attitude:
            return "attitude"
        if self.arm is None:
            return "unknown"
        return "too far" if self.arm.distance > self.arm.reach else "too close"

    def message(self) -> str:
        """The errors of the best configuration, their cause, and what may help."""
        angle = ""
        if self.attitude_missed is not None:
            degrees = math.degrees(self.attitude_missed)
            angle = f" and {self.attitude_missed:.4g} rad ({degrees:.3g} degrees)"
        return (
            f"pose out of reach: the best configuration for frame '{self.frame}' misses it by "
            f"{self.position_missed:.4g} m{angle}{self._why()}"
            + helping(self.advice or ("another base position or attitude",))
        )

    def _why(self) -> str:
        texts, cause = [""], self.cause
        if cause in ("too far", "too close"):
            texts.append(self._of_arm())
        if cause == "joint limits":
            texts.append(f"it would be reached with wider limits: {self._of_joints()}")
        if cause == "attitude":
            texts.append("its position is within reach, but not at the wanted attitude")
        if self.held_base is not None:
            texts.append(self._of_held_base(self.held_base))
        return "; ".join(texts)

    def _of_arm(self) -> str:
        assert self.arm is not None
        mount, distance, reach = self.arm
        no = "farther" if distance > reach else "nearer"
        return (
            f"it is {self.cause}: {distance:.4g} m from the mount of the arm (joint '{mount}'), "
            f"from where the frame gets no {no} than {reach:.4g} m in this direction"
        )

    def _of_joints(self) -> str:
        return ", ".join(
            f"joint '{name}' would be at {value:.3g} rad, and is allowed {lower:.3g} to {upper:.3g}"
            for name, value, lower, upper in self.beyond
        )

    @staticmethod
    def _of_held_base(held: HeldBase) -> str:
        if not held.reached:
            return f"a held base misses it as well, by {held.position_missed:.4g} m"
        return (
            "it is within reach of a held base, but on the way there the reaction turns the base "
            f"by {math.degrees(held.rotation):.3g} degrees and takes the frame "
            f"{held.position_missed:.4g} m away"
        )
