"""Flights simulated by MuJoCo, which shares no code with the package.

MuJoCo compiles the robot's own URDF, masses and inertias included, without gravity, contacts and
joint limits. At every stage of the Runge-Kutta steps a controller computes the accelerations wanted
of the joints and of the actuated coordinates of the base, and applies the forces that cause them.
The other coordinates follow from MuJoCo's equations of motion:

- `free-flying`: thrusters push the base along a line through the robot's centre of mass, so that
  its origin follows a path; its attitude is free.
- `attitude-held`: wheels exert a pure moment on the base as well.
- `free-floating`: no force at all acts on the base.
"""

from typing import NamedTuple
from xml.etree import ElementTree

import mujoco
import numpy as np

from ffsr_plan.core import rotations

_STIFFNESS = 5.0  # [1/s], of the critically damped servos
_THRUSTERS_STIFFNESS = 30.0  # the base's path has corners
_PUSHED = {"free-floating": 0, "free-flying": 3, "attitude-held": 6}
_LAW = np.polynomial.Polynomial([0, 0, 0, 10, -15, 6])  # s from rest to rest, time from 0 to 1
_SPEED, _ACCELERATION = _LAW.deriv(1), _LAW.deriv(2)


class Course(NamedTuple):
    """Wanted values at one time, with their first and second time derivatives.

    Attributes:
        positions: (3,) of the base origin, world [m].
        attitudes: quaternion (4,) xyzw, angular velocity and acceleration (3,), base axes.
        joints: (nd,) [rad or m].
    """

    positions: tuple
    attitudes: tuple
    joints: tuple


class Flight(NamedTuple):
    """Simulated states at N times.

    Attributes:
        times: (N,) [s].
        positions: (N, 3) base origin, world [m].
        attitudes: (N, 4) of the base, xyzw.
        joints: (N, nd) [rad or m].
        momenta: (N, 3) angular momentum of base and arms about the centre of mass, world axes
            [N m s].
        impulses: (N, 3) integral of the wheels' moment on the base, world axes [N m s].
    """

    times: np.ndarray
    positions: np.ndarray
    attitudes: np.ndarray
    joints: np.ndarray
    momenta: np.ndarray
    impulses: np.ndarray


def progress(times, duration, parts=1):
    """Path parameter s in [0, 1] at `times` [s], its rate and its acceleration.

    Each of so many equal parts of the path is flown from rest to rest in the same time.
    """
    u = np.clip(np.asarray(times) / duration, 0.0, 1.0) * parts
    part = np.minimum(np.floor(u), parts - 1)
    u = u - part
    s = np.clip((part + _LAW(u)) / parts, 0.0, 1.0)
    return s, _SPEED(u) / duration, _ACCELERATION(u) * parts / duration**2


def course_of(plan, duration, parts=1):
    """The course of a plan: base position and joints, straight between its nodes.

    A joint path with corners is followed exactly if every edge goes from rest to rest, `parts`
    being the number of edges. The wheels rotate the base at a rate proportional to that of the
    path parameter, edge by edge by the motion's shares of the whole turn where it has some.
    """
    corners = np.hstack([plan.motion.positions, plan.motion.joint_values])
    edges, start = len(corners) - 1, plan.problem.start[3:7]
    whole = rotations.log(rotations.multiply(rotations.inverse(start), plan.problem.goal[3:7]))
    shares = plan.motion.turn_shares
    shares = np.linspace(0.0, 1.0, edges + 1) if shares is None else shares

    def course(t):
        s, speed, acceleration = progress(t, duration, parts)
        k = min(int(s * edges), edges - 1)
        way = (corners[k + 1] - corners[k]) * edges
        place = corners[k] + (s - k / edges) * way
        spin = (shares[k + 1] - shares[k]) * edges * whole
        turned = rotations.exp(shares[k] * whole + (s - k / edges) * spin)
        return Course(
            (place[:3], speed * way[:3], acceleration * way[:3]),
            (rotations.multiply(start, turned), speed * spin, acceleration * spin),
            (place[3:], speed * way[3:], acceleration * way[3:]),
        )

    return course


def mujoco_model(robot):
    """The robot's URDF compiled by MuJoCo, with a free joint on the base.

    It needs release 4: release 3.3 ignores the rotation of an `<inertial>`.
    """
    root = ElementTree.fromstring(robot.urdf)
    for link in root.findall("link"):
        for shape in [*link.findall("collision"), *link.findall("visual")]:
            link.remove(shape)
    settings = {
        "fusestatic": "false",
        "balanceinertia": "false",
        "boundmass": "0",
        "boundinertia": "0",
    }
    ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler", settings)
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    spec.worldbody.first_body().add_freejoint()
    spec.option.gravity = np.zeros(3)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    for joint in spec.joints:
        joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
    return spec.compile()


def fly(robot, mode, course, duration, step=0.04, every=5):
    """Fly `course`, a function of the time [s] that returns a `Course` and begins at rest.

    The state is recorded after every so many steps of `step` [s].
    """
    model = mujoco_model(robot)
    data = mujoco.MjData(model)
    model.opt.timestep = step
    pilot = _Pilot(robot, model, mode, course)
    pilot.begin(data)
    rows, impulse = [], np.zeros(3)
    mujoco.set_mjcb_control(pilot)
    try:
        for k in range(round(duration / step) + 1):
            if k % every == 0:
                mujoco.mj_forward(model, data)
                mujoco.mj_subtreeVel(model, data)
                rows.append([data.time, *data.qpos, *data.subtree_angmom[1], *impulse])
            pilot.moments.clear()
            mujoco.mj_step(model, data)
            first, second, third, last = pilot.moments
            impulse = impulse + step / 6.0 * (first + 2.0 * second + 2.0 * third + last)
    finally:
        mujoco.set_mjcb_control(None)
    table, joints = np.array(rows), 1 + np.array(pilot.slots)
    return Flight(
        table[:, 0],
        table[:, 1:4],
        table[:, [5, 6, 7, 4]],
        table[:, joints],
        table[:, -6:-3],
        table[:, -3:],
    )


def joint_space_inertia(model, data):
    """(nv, nv), in the engine's order of velocities."""
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    return inertia


def joint_slots(robot, model):
    """Where the robot's joints are in the engine's positions and in its velocities."""
    joints = [model.joint(name) for name in robot.joint_names]
    return [int(j.qposadr[0]) for j in joints], [int(j.dofadr[0]) for j in joints]


class _Pilot:
    """Control callback of MuJoCo; applies the forces of the wanted accelerations."""

    def __init__(self, robot, model, mode, course):
        self.slots, self._dofs = joint_slots(robot, model)
        pushed = range(_PUSHED[mode])
        self._course = course
        self._driven = np.array([*pushed, *self._dofs])
        self._free = np.setdiff1d(np.arange(model.nv), self._driven)
        self._forces = np.zeros((model.nv, len(self._driven)))
        self._forces[self._driven, np.arange(len(self._driven))] = 1.0
        self._thrusters, self._wheels = mode != "free-floating", mode == "attitude-held"
        self.moments = []

    def begin(self, data):
        """Set the state to the beginning of the course."""
        wanted = self._course(0.0)
        data.qpos[:3], data.qpos[3:7] = wanted.positions[0], np.roll(wanted.attitudes[0], 1)
        data.qpos[self.slots] = wanted.joints[0]

    def __call__(self, model, data):
        """MuJoCo's free joint: linear rates in world axes, angular ones in the base's."""
        wanted = self._course(data.time)
        goal = np.zeros(model.nv)
        goal[:3] = _servo(wanted.positions, data.qpos[:3], data.qvel[:3], _THRUSTERS_STIFFNESS)
        if self._wheels:
            quat, spin, angular = wanted.attitudes
            off = rotations.log(
                rotations.multiply(rotations.inverse(np.roll(data.qpos[3:7], -1)), quat)
            )
            goal[3:6] = _servo((off, spin, angular), 0.0, data.qvel[3:6])
        goal[self._dofs] = _servo(wanted.joints, data.qpos[self.slots], data.qvel[self._dofs])
        inertia = joint_space_inertia(model, data)
        if self._thrusters:  # unit forces on the base, at the centre of mass of the whole robot
            columns = np.zeros((3, model.nv))
            mujoco.mj_jac(model, data, columns, None, data.subtree_com[1], 1)
            self._forces[:, :3] = columns.T
        known = inertia[:, self._driven] @ goal[self._driven] + data.qfrc_bias
        system = np.concatenate([self._forces, -inertia[:, self._free]], axis=1)
        efforts = np.linalg.solve(system, known)[: len(self._driven)]
        data.qfrc_applied = self._forces @ efforts
        moment = efforts[3:6] if self._wheels else np.zeros(3)
        self.moments.append(data.xmat[1].reshape(3, 3) @ moment)


def _servo(wanted, value, rate, stiffness=_STIFFNESS):
    goal, speed, acceleration = wanted
    return acceleration + 2.0 * stiffness * (speed - rate) + stiffness**2 * (goal - value)
