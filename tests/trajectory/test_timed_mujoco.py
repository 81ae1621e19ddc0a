"""MuJoCo's inverse dynamics for the same URDF gives the forces of a timed plan."""

import numpy as np
import pytest

from ffsr_plan.dynamics.actuation_mode import Mode
from tests.helpers.random_motions import USUAL, bent_motion, flown, inside

mujoco = pytest.importorskip("mujoco", minversion="4")

from tests.helpers import mujoco_flight as engine  # noqa: E402 - it cannot be imported where there is no MuJoCo


def inverse_dynamics(robot, states):
    """(N, 3) force on the base, world axes, (N, 3) moment about the centre of mass, base axes, and
    (N, nd) of the joints."""
    model = engine.mujoco_model(robot)
    data = mujoco.MjData(model)
    places, slots = engine.joint_slots(robot, model)
    found = []
    for k in range(len(states.parameters)):
        data.qpos[:3] = states.configurations[k, :3]
        data.qpos[3:7] = np.roll(states.configurations[k, 3:7], 1)
        data.qpos[places] = states.joints[k]
        for own, base, ours in (
            (data.qvel, states.base_velocity, states.velocities),
            (data.qacc, states.base_acceleration, states.accelerations),
        ):
            own[:3], own[3:6], own[slots] = base[k], ours[k, 3:6], ours[k, 6:]
        mujoco.mj_inverse(model, data)
        pose, force = data.xmat[1].reshape(3, 3), np.array(data.qfrc_inverse[:3])
        lever = data.subtree_com[1] - data.xpos[1]
        moment = data.qfrc_inverse[3:6] - pose.T @ np.cross(lever, force)
        found.append(np.concatenate([force, moment, data.qfrc_inverse[slots]]))
    return np.split(np.array(found), [3, 6], axis=1)


@pytest.mark.parametrize("seed", [7, 9, 39])
@pytest.mark.parametrize("mode", list(Mode))
@pytest.mark.parametrize("joints_bend", [False, True])
def test_the_engine_wants_the_same_thrust_wheels_and_torques(seed, mode, joints_bend):
    """A force through the centre of mass, a moment with wheels, neither in free floating."""
    motion = bent_motion(seed, mode, joints_bend=joints_bend)
    flight = flown(motion, **USUAL)
    states = flight.at(inside(flight)[0])
    force, moment, torques = inverse_dynamics(motion.robot, states)
    size = np.abs(states.torques).max()
    assert size > 1e-4
    assert np.allclose(torques, states.torques, atol=1e-9 * max(size, 1.0))
    assert np.allclose(force, states.thrust, atol=1e-9)
    assert np.allclose(moment, states.wheel_torque, atol=1e-9)
    assert np.any(states.thrust != 0.0) == (mode != "free-floating")
    assert np.any(states.wheel_torque != 0.0) == (mode == "attitude-held")
