"""MuJoCo turns the target of `tumbling` as a free body: where it is, the plan says."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core import rotations

mujoco = pytest.importorskip("mujoco", minversion="4")

STEP, EVERY = 0.005, 20  # of the engine [s], and steps between two looks


def free_body(body):
    """A body in MuJoCo with its inertia, pose and rate at time zero; nothing acts on it."""
    spec = mujoco.MjSpec()
    spec.option.gravity, spec.option.timestep = np.zeros(3), STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    target = spec.worldbody.add_body(name="target")
    target.add_freejoint()
    target.explicitinertial, target.mass = True, 100.0
    target.inertia, target.ipos = np.diag(body.motion.inertia), np.zeros(3)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:3], data.qpos[3:7] = body.position, np.roll(body.attitude, 1)
    data.qvel[:3], data.qvel[3:] = body.motion.velocity, body.motion.rate
    return model, data


def flown(body, duration):
    """Times [s], positions (n, 3) and quaternions (n, 4, xyzw) that MuJoCo integrates."""
    model, data = free_body(body)
    rows = []
    for k in range(round(duration / STEP) + 1):
        if k % EVERY == 0:
            rows.append([data.time, *data.qpos[:3], *np.roll(data.qpos[3:7], -1)])
        mujoco.mj_step(model, data)
    table = np.array(rows)
    return table[:, 0], table[:, 1:4], table[:, 4:]


def test_mujoco_turns_the_target_as_the_plan_expects():
    plan = fp.plan(fp.load_scenario("tumbling"), fp.LatticeOptimum())
    problem = plan.problem
    (target,) = problem.scene.bodies
    times, places, attitudes = flown(target, problem.duration)
    poses = target.poses(np.minimum(times, problem.duration))
    assert rotations.angle_between(poses.attitudes, attitudes).max() < 1e-6
    assert rotations.angle_between(poses.attitudes[0], poses.attitudes).max() > 1.0
    share = np.minimum(times / problem.duration, 1.0) * plan.motion.edges
    edge = np.minimum(share.astype(np.int64), plan.motion.edges - 1)
    q = plan.motion.at(edge, share - edge)
    back = rotations.inverse(attitudes)
    q[:, :3] = rotations.rotate(back, q[:, :3] - places)
    q[:, 3:7] = rotations.multiply(back, q[:, 3:7])
    query = ObstacleQuery(problem.robot, fp.Scene(shapes=target.shapes))
    closest = query.distances(q).min()
    assert closest >= plan.certificate.least_clearance - 1e-6
    assert abs(closest - plan.clearances.min()) < 1e-4
