"""Bounds on speeds and on the base's rotation hold for points followed along random motions."""

import numpy as np
import pytest

from ffsr_plan.dynamics.momentum import connections
from ffsr_plan.verification.momentum_map import momentum_map
from ffsr_plan.verification.motion_samples import Sampler, base_frame_poses
from ffsr_plan.verification.rate_bounds import RateBounds
from ffsr_plan.verification.sweep import _Sweep
from ffsr_plan.verification.urdf_reading import Bodies
from tests.helpers.careless_plans import MODES, careless_plan, placed
from tests.helpers.urdf_builders import inertial, joint, link, sphere, urdf

STEPS = 40


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("step", [0.05, 1.0, 3.0])
def test_no_point_travels_farther_than_its_bound(mode, step):
    shares = []
    for seed in range(10):
        plan, rng = careless_plan(seed, mode, step)
        robot = plan.problem.robot
        bodies = Bodies(robot.urdf)
        sweep = _Sweep(Sampler(plan, bodies), bodies, 4)
        points = [rng.permutation(s.points)[:3] for s in bodies.shapes]
        order = np.arange(8)
        edge, time = np.arange(9) // 4, (np.arange(9) % 4) / 4
        edge[-1], time[-1] = 1, 1.0
        sweep._samples = sweep.course.at(edge, time)
        begin, end = time[:-1], np.where(edge[1:] > edge[:-1], 1.0, time[1:])
        intervals = sweep._intervals(edge[:-1], begin, end, order, order + 1)
        speeds, reach = sweep._rates.shapes, sweep._rates.reach
        if mode == "free-floating":
            speeds, reach = sweep._rates.afloat()
        else:
            moved = np.linalg.norm(np.diff(plan.motion.positions, axis=0), axis=1)
            speeds = speeds + moved[:, None]
        at = placed(plan, np.linspace(0.0, 1.0, 8 * STEPS + 1))
        for k, ((_, poses), some) in enumerate(zip(at, points, strict=True)):
            tracks = np.einsum("nij,pj->npi", poses[:, :3, :3], some) + poses[:, None, :3, 3]
            ways = np.linalg.norm(np.diff(tracks, axis=0), axis=2).reshape(8, STEPS, -1)
            way = ways.sum(axis=1).max(axis=1)
            part = np.full(8, k)
            bound = intervals.travel(order, speeds[edge[:-1], part], reach[part])
            assert np.all(way <= bound)
            shares.append(way.max() / bound.max())
    if step < 0.1:  # with larger steps they become sharp on shorter intervals only
        assert np.median(shares) > 0.2


@pytest.mark.parametrize("seed", range(8))
def test_no_two_links_approach_faster_than_their_bound(seed):
    plan, rng = careless_plan(seed, "free-flying", 1.0)
    robot = plan.problem.robot
    bodies = Bodies(robot.urdf)
    number = {shape: k for k, shape in enumerate(bodies.shapes)}
    pairs = np.array([(number[a], number[b]) for a, b in bodies.pairs()]).reshape(-1, 2)
    values = plan.motion.joint_values
    bounds = RateBounds(bodies, robot.joint_names, values).of_pairs(pairs)
    at = placed(plan, np.linspace(0.0, 1.0, 201))
    for (a, b), bound in zip(pairs, bounds.T, strict=True):
        (first, here), (second, there) = at[a], at[b]
        p, r = (rng.permutation(shape.points)[0] for shape in (first, second))
        apart = here[:, :3, :3] @ p + here[:, :3, 3] - there[:, :3, :3] @ r - there[:, :3, 3]
        change = np.abs(np.diff(np.linalg.norm(apart, axis=1)))
        assert np.all(change.reshape(2, 100).max(axis=1) <= bound / 100 + 1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_reactions_by_bodies_are_those_of_the_planner(seed):
    plan, rng = careless_plan(seed, "free-flying")
    robot = plan.problem.robot
    values = rng.uniform(-1.0, 1.0, (5, robot.nd))
    q = robot.assemble(np.zeros((5, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (5, 1)), values)
    bodies = Bodies(robot.urdf)
    found = momentum_map(bodies, robot.joint_names, base_frame_poses(plan, bodies, q))
    assert np.allclose(found.reactions, connections(robot, values), atol=1e-12)


def test_the_bound_of_a_stretched_arm_is_the_speed_of_its_tip():
    body = inertial(1.0, (1.0, 1.0, 1.0))
    text = urdf(
        link("base", body), link("arm", body), link("hand", body, sphere(0.1, (0.5, 0, 0))),
        joint("shoulder", "revolute", "base", "arm", (0.2, 0, 0)),
        joint("elbow", "revolute", "arm", "hand", (0.7, 0, 0)),
    )  # fmt: skip
    values = np.array([[0.0, 0.0], [0.3, -0.4], [0.3, 0.0]])
    bounds = RateBounds(Bodies(text), ("shoulder", "elbow"), values)
    assert np.allclose(bounds.shapes[:, 0], [0.3 * 1.3 + 0.4 * 0.6, 0.4 * 0.6])
    assert np.allclose(bounds.reach, 1.5)
