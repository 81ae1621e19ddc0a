"""Edges proven past drifting spheres, each with its own speed."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.interval_halving import Verdict
from ffsr_plan.proof.prover import Prover
from tests.helpers.drifting_spheres import DURATION, cloud_about


def prover_of(clouds, ramp=0.0, edges=4):
    robot = fp.load_robot("planar_dual_arm")
    goal = robot.configuration((4.0, 0.0, 0.0), joints={"left_1": 0.8, "right_2": -0.6})
    ends = np.linspace(0.0, 4.0, edges + 1)[:, None] * (1.0, 0.0, 0.0)
    motion = Motion(robot, Mode.FREE_FLYING, robot.neutral(), goal, ends)
    pace = fp.Pace(DURATION, ramp, edges)
    return Prover(motion, fp.Scene(debris=clouds), 1e-4, pace=pace), motion, pace


def sampled(motion, pace, cloud, layer, offsets, count=120):
    """Least distance on an edge, sampled."""
    found = []
    for t in np.linspace(0.0, 1.0, count):
        q = motion.at(np.array([layer]), np.array([t]))[0]
        q[:3] += (1.0 - t) * offsets[0] + t * offsets[1]
        there = fp.Scene(cloud.centers_at(pace.instants(np.array(layer + t))), cloud.radii)
        found.append(ObstacleQuery(motion.robot, there).nearest(q).distance)
    return min(found)


@pytest.mark.parametrize("ramp", [0.0, 0.25])
@pytest.mark.parametrize("seed", range(4))
def test_no_edge_is_proven_free_that_touches_a_sphere(seed, ramp):
    cloud, rng = cloud_about(seed, 25), np.random.default_rng(seed)
    prover, motion, pace = prover_of([cloud], ramp)
    layers = np.arange(4)
    tails, heads = rng.uniform(-1.2, 1.2, (2, 4, 3)) * (0.2, 1.0, 0.2)
    ends = np.column_stack([prover.clearances(layers + k, (tails, heads)[k]) for k in (0, 1)])
    for k, verdict in enumerate(prover.certify_all(layers, tails, heads, ends)):
        least = sampled(motion, pace, cloud, k, (tails[k], heads[k]))
        assert verdict.free == (least > 0.0) or abs(least) < 2e-3


def test_a_fast_sphere_far_away_costs_nothing():
    near = fp.DebrisCloud([[2.0, 2.2, 0.0]], [0.1], [[0.0, 0.001, 0.0]])
    fast = fp.DebrisCloud([[2.0, 60.0, 0.0]], [0.1], [[1.0, 0.0, 0.0]])
    still, layers = np.zeros((4, 3)), np.arange(4)

    def verdicts(clouds):
        prover, _, _ = prover_of(clouds)
        ends = np.column_stack([prover.clearances(layers + k, still) for k in (0, 1)])
        return prover.certify_all(layers, still, still, ends)

    alone, both = verdicts([near]), verdicts([near, fast])
    assert all(verdict.free and verdict.queries == 0 for verdict in both)
    assert [each.free for each in alone] == [each.free for each in both]


def test_a_sphere_that_crosses_between_two_samples_is_seen():
    crossing = fp.DebrisCloud([[1.5, -25.0, 0.0]], [0.05], [[0.0, 50.0 / 30.0, 0.0]])
    prover, _, _ = prover_of([crossing])  # it passes the way at 15 s, on edge 1, where the base is
    still = np.zeros(3)
    ends = prover.clearances(np.array([1, 2]), np.zeros((2, 3)))
    assert ends.min() > 5.0
    verdict = prover.certify(1, still, still, (float(ends[0]), float(ends[1])))
    assert isinstance(verdict, Verdict)
    assert not verdict.free
    assert verdict.time == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("seed", [15, 23, 35])  # whose path is free
def test_the_bound_on_a_path_holds_and_is_sharp(seed):
    cloud = cloud_about(seed, 12)
    prover, motion, pace = prover_of([cloud])
    offsets = np.zeros((5, 3))
    offsets[1:4, 1] = (0.3, 0.6, 0.3)
    clearances = prover.clearances(np.arange(5), offsets)
    least = min(sampled(motion, pace, cloud, k, offsets[k : k + 2], 60) for k in range(4))
    bound = prover.least_clearance(offsets, clearances)
    assert 0.0 < 0.9 * least <= bound <= least + 1e-9
