"""`Timing`: what can be flown within limits."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.trajectory.flight_limits import FlightLimits, PerJoint, read_limits

if TYPE_CHECKING:
    from ffsr_plan.meetings.departure import Departure
    from ffsr_plan.meetings.meeting import Meeting
    from ffsr_plan.planning.flights import SmoothFlight, TimedPlan
    from ffsr_plan.problem.problem import Problem


class Timing:
    """A plan or a smooth plan, which limits turn into a flight."""

    if TYPE_CHECKING:

        @property
        def problem(self) -> Problem:
            """Robot, obstacles, start and goal."""

    def timed(
        self,
        *,
        corners: str = "smooth",
        duration: float | None = None,
        joint_acceleration: PerJoint = None,
        thruster_acceleration: float | None = None,
        joint_velocity: PerJoint = None,
        base_velocity: float | None = None,
        joint_torque: PerJoint = None,
        joint_jerk: PerJoint = None,
        thruster_jerk: float | None = None,
        turn_velocity: float | None = None,
        turn_acceleration: float | None = None,
        velocity_jump: float = 0.0,
        meeting: Meeting | None = None,
        departure: Departure | None = None,
    ) -> SmoothFlight | TimedPlan:
        """The plan flown within limits, from rest at the start to rest at the goal.

        The flight follows the proven smooth curve of `smooth`, or with `corners="rest"` exactly the
        proven path, with a rest at every corner. A quantity without a value is not limited;
        `joint_velocity`, `joint_acceleration` and `joint_jerk` default to the URDF's. Limits for
        joints are one number, or numbers by name, and the URDF's for those not named.
        Past bodies that move it is proven at its own times, if need be slower or later.

        Args:
            corners: `smooth` or `rest`.
            duration: of a smooth flight, the calmest that takes it [s]; by default the shortest,
                with a departure that of the problem.
            joint_acceleration: of every joint that moves [rad/s^2 or m/s^2].
            thruster_acceleration: thrust / mass [m/s^2]; refused where nothing moves the base.
            joint_velocity: [rad/s or m/s].
            base_velocity: of the base origin [m/s].
            joint_torque: [N m or N].
            joint_jerk: [rad/s^3 or m/s^3].
            thruster_jerk: of the base origin [m/s^3].
            turn_velocity: angular velocity of a base, refused without wheels [rad/s].
            turn_acceleration: angular acceleration of a base that wheels rotate [rad/s^2].
            velocity_jump: with `corners="rest"`, the change of the base's velocity by one pulse of
                the thrusters, which passes a corner instead of a rest [m/s]; see `TimedPlan`.
            meeting: what a frame arrives with, and when, instead of a rest; see `Meeting`.
            departure: the state to begin in instead of a rest; see `Departure`.

        Raises:
            InvalidInput: limits, a duration, a meeting or a departure that cannot be, or no motion.
            UnprovenCurve, UnprovenFlight: see `smooth`; nothing could be proven past bodies.
        """
        robot, mode = self.problem.robot, self.problem.mode
        limits = read_limits(
            robot, mode, joint_velocity=joint_velocity, joint_acceleration=joint_acceleration,
            joint_jerk=joint_jerk, joint_torque=joint_torque, base_velocity=base_velocity,
            thruster_acceleration=thruster_acceleration, thruster_jerk=thruster_jerk,
            turn_velocity=turn_velocity, turn_acceleration=turn_acceleration,
            velocity_jump=velocity_jump,
        )  # fmt: skip
        return self._flown(limits, corners, duration, _one_of(meeting, departure))

    @abstractmethod
    def _flown(
        self,
        limits: FlightLimits,
        corners: str,
        duration: float | None,
        ends: Meeting | Departure | None,
    ) -> SmoothFlight | TimedPlan:
        """The flight within limits; see `timed`."""


def _one_of(meeting: Meeting | None, departure: Departure | None) -> Meeting | Departure | None:
    """What the flight ends or begins with.

    Raises:
        InvalidInput: both are given.
    """
    if meeting is not None and departure is not None:
        raise InvalidInput("departure", departure, "None with a meeting: plan one at a time")
    return departure if meeting is None else meeting
