"""Smooth curves along motions, and flights along them, without a planner."""

import numpy as np

from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.curves.smooth_curve import SmoothCurve
from ffsr_plan.smooth_flight.curve_flight import curve_flight
from ffsr_plan.trajectory.flight_limits import read_limits

THRUST = {"thruster_acceleration": 0.01}
WHEELS = {"turn_velocity": 0.1, "turn_acceleration": 1e-3}
TIGHT = {"joint_acceleration": 5e-3, "joint_velocity": 0.05, "joint_torque": 0.02}
BY_MODE = {
    "free-flying": TIGHT | THRUST,
    "attitude-held": TIGHT | THRUST | WHEELS,
    "free-floating": TIGHT,
}


def curve_of(motion, repeats=None):
    """The B-spline whose control points are the corners of a motion, some several times."""
    control = control_points_on(motion, np.arange(motion.edges + 1.0))
    return SmoothCurve(
        CurvedMotion(motion, control if repeats is None else control.repeated(repeats))
    )


def limits_of(curve, **given):
    return read_limits(curve.robot, curve.mode, **given)


def flown(motion, duration=None, **given):
    curve = curve_of(motion)
    return curve_flight(curve, limits_of(curve, **given), duration)


def instants(flight, count=100):
    """(N,) `count` times on each piece of the law, and its end [s]."""
    ends = flight.switch_times
    within = ends[:-1, None] + np.diff(ends)[:, None] * np.arange(count) / count
    return np.append(within.ravel(), flight.duration)


def shares_in_use(flight, limits, times):
    """Largest share of each limit in use over the given times."""
    states, robot = flight.at(times), flight.robot
    base, turn = (
        np.linalg.norm(each, axis=1) for each in (states.base_velocity, states.angular_velocity)
    )
    found = {
        "joint_velocity": np.abs(states.joint_velocities) / limits.velocity[2:],
        "joint_acceleration": np.abs(states.joint_accelerations) / limits.acceleration[2:],
        "joint_torque": np.abs(states.torques) / limits.torque,
    }
    if flight.mode.has_thrusters:
        push = np.linalg.norm(states.thrust, axis=1) / robot.mass
        found["thruster_acceleration"] = push / limits.acceleration[0]
        found["base_velocity"] = base / limits.velocity[0]
    if flight.mode.has_wheels:
        change = np.linalg.norm(states.accelerations[:, 3:6], axis=1)
        found["turn_velocity"] = turn / limits.velocity[1]
        found["turn_acceleration"] = change / limits.acceleration[1]
    return {name: float(np.max(each, initial=0.0)) for name, each in found.items()}
