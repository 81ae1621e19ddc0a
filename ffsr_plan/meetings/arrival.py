"""`Arrival`: the configuration and the rates with which a frame has its pose and its twist.

Given the joint values theta at the end, the wanted pose of the frame places the base. With J the
Jacobian of the frame where the base moves by reaction alone (world axes, at the frame's origin),
the twist follows from the joints' rates theta' and the velocity p' that thrusters give the base:

    (v, w) = (p', 0) + J theta'

free-flying    J holds the base origin, and the base turns at A theta' (`momentum.connection`)
attitude-held  J is the ordinary one: wheels do not turn the base on arrival
free-floating  J = J*, the generalized Jacobian, and p' = 0

Thrusters cannot turn the frame, so theta' is the least that gives w, and p' gives the rest of v;
where the base floats theta' gives both.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.bodies.body_twist import body_state
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.dynamic_singularity import warn_if_near
from ffsr_plan.dynamics.momentum import connection, generalized_jacobian
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.meetings.meeting import Meeting
from ffsr_plan.meetings.met_body import met_body
from ffsr_plan.robots.kinematics import frame_index
from ffsr_plan.scene.scene import Scene
from ffsr_plan.trajectory.flight_limits import FlightLimits

_SINGULAR = 1e-6  # relative: directions in which the joints move the frame by less count as none
_MISSED = 1e-10  # [m/s or rad/s] of a twist


class EndState(NamedTuple):
    """A state in which the frame has its pose and, as far as it can be, its twist.

    Attributes:
        configuration: (nq,).
        joint_rates: (nd,) [rad/s or m/s].
        base_velocity: (3,) of the base origin by thrusters, world axes [m/s].
        missed: (6,) what is missing to the twist [m/s, rad/s].
    """

    configuration: Array
    joint_rates: Array
    base_velocity: Array
    missed: Array


class Arrival:
    """What a meeting demands of the end of a motion.

    Attributes:
        motion: the motion, of a plan.
        meeting: frame and time; pose and twist in the world or along the target's axes.
        pose: of the frame on arrival, world.
        twist: (6,) of the frame on arrival, world axes [m/s, rad/s].
    """

    def __init__(self, motion: Motion, meeting: Meeting, scene: Scene) -> None:
        """The pose of the meeting, or where it leaves it open that at the end of the motion.

        Raises:
            InvalidInput: an unknown frame or target, one whose velocity is not known, or a robot
                without joints.
        """
        self.motion, self.meeting = motion, meeting
        if motion.robot.nd == 0:
            raise InvalidInput("robot", motion.robot.name, "a robot with joints")
        self._frame = frame_index(motion.robot.model, meeting.frame)
        arrival = self._frame_pose(motion.configurations()[-1])
        number = met_body(meeting, scene)
        target = None if number is None else body_state(scene.bodies[number], meeting.at)
        axes = np.eye(3) if target is None else rotations.matrix(target.attitude)
        place, turn = arrival.translation, arrival.rotation
        if meeting.position is not None:
            place = axes @ meeting.position + (0.0 if target is None else target.position)
        if meeting.attitude is not None:
            turn = axes @ rotations.matrix(rotations.from_angles(meeting.attitude))
        self.pose = pin.SE3(turn, place)
        velocity, angular = axes @ meeting.velocity, axes @ meeting.angular_velocity
        if target is not None:
            velocity = velocity + target.velocity_at(place)
            angular = angular + target.angular_velocity
        self.twist: Array = np.concatenate([velocity, angular])

    def state(self, joints: Array) -> EndState:
        """The state with given joint values (nd,) [rad or m]."""
        robot, mode = self.motion.robot, self.motion.mode
        alone = robot.assemble(np.zeros(3), rotations.IDENTITY, joints)
        base = self.pose * self._frame_pose(alone).inverse()
        quat = pin.Quaternion(base.rotation).coeffs()
        q = robot.assemble(base.translation, quat / np.linalg.norm(quat), joints)
        twist = self.twist
        if mode.floats:
            jacobian = generalized_jacobian(robot, q, self.meeting.frame)
            rates = np.linalg.pinv(jacobian, _SINGULAR) @ twist
            return EndState(q, rates, np.zeros(3), twist - jacobian @ rates)
        jacobian = self._reacting(q)
        rates = np.linalg.pinv(jacobian[3:], _SINGULAR) @ twist[3:]
        rest = twist - jacobian @ rates
        return EndState(q, rates, rest[:3], np.concatenate([np.zeros(3), rest[3:]]))

    def check(self, state: EndState, limits: FlightLimits) -> None:
        """Raise `InvalidInput` for a twist that cannot be, or that limits on velocity forbid.

        Warns:
            NearDynamicSingularity: the base floats, and the frame can hardly move in a direction.
        """
        robot, twist = self.motion.robot, self.twist
        floats = self.motion.mode.floats
        what = "meeting.velocity, meeting.angular_velocity" if floats else _TURN
        value = (twist if floats else twist[3:]).tolist()
        if np.linalg.norm(state.missed) > _MISSED * max(1.0, float(np.linalg.norm(twist))):
            nearest = np.round(twist - state.missed, 9)[0 if floats else 3 :] + 0.0  # no -0
            got = ", ".join(f"{each:.4g}" for each in nearest)
            allowed = (
                f"what the joints can give the frame there in the mode {self.motion.mode}, such as "
                f"({got}), which comes nearest"
            )
            raise InvalidInput(what, value, allowed)
        if floats:
            warn_if_near(robot, state.configuration, self.meeting.frame, attitude=True)
        for name, rate, most in zip(
            robot.joint_names, state.joint_rates, limits.velocity[2:], strict=True
        ):
            if abs(rate) > most:
                allowed = (
                    f"{most / abs(rate):.4g} of it at most: joint {name} would need {abs(rate):.4g}"
                    f" and may have {most:.4g} rad/s or m/s"
                )
                raise InvalidInput(what, value, allowed)
        speed = float(np.linalg.norm(state.base_velocity))
        if speed > limits.velocity[0]:
            allowed = (
                f"one for which the base moves at {limits.velocity[0]:.4g} m/s at most, not at "
                f"{speed:.4g} m/s"
            )
            raise InvalidInput("meeting.velocity", twist[:3].tolist(), allowed)

    def _reacting(self, q: Array) -> Array:
        """(6, nd) Jacobian of the frame with its base origin held; J of the module's docstring."""
        robot, axes = self.motion.robot, pin.LOCAL_WORLD_ALIGNED
        whole = pin.computeFrameJacobian(
            robot.model, robot.model.createData(), q, self._frame, axes
        )
        jacobian = np.array(whole[:, 6:])
        if self.motion.mode.attitude_reacts:
            jacobian += whole[:, 3:6] @ connection(robot, q)
        return jacobian

    def _frame_pose(self, q: Array) -> pin.SE3:
        model = self.motion.robot.model
        data = model.createData()
        pin.forwardKinematics(model, data, q)
        return pin.SE3(pin.updateFramePlacement(model, data, self._frame))


_TURN = "meeting.angular_velocity"
