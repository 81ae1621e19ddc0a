"""Links that keep apart: lower bounds of their distances, and the proof that uses them."""

import numpy as np
import pytest

from ffsr_plan.collision.distances import SelfQuery
from ffsr_plan.collision.shape_gap_kernels import least_gap
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.course import course_in_base
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.interval_halving import certify
from ffsr_plan.proof.kernels import apart
from ffsr_plan.proof.kernels.course import memory_for
from ffsr_plan.proof.motion_edges import SelfCollisionEdge
from ffsr_plan.proof.prover import Prover
from ffsr_plan.scene.scene import Scene
from tests.helpers.urdf_builders import capsule, cylinder, random_robot

TOLERANCE = 1e-4


def robot_of(seed):
    """Boxes and spheres, and in half of the robots capsules and hulls."""
    solids = (capsule, cylinder) if seed % 2 else ()
    return random_robot(seed, solids=solids, arms=3, depth=3)


def configuration(robot, rng, scale=1.5):
    values = np.clip(rng.uniform(-scale, scale, robot.nd), robot.lower, robot.upper)
    return robot.assemble(np.zeros(3), rotations.IDENTITY, values)


@pytest.mark.parametrize("seed", range(30))
def test_no_gap_is_above_the_distance_and_few_are_far_below(seed):
    robot, rng = robot_of(seed), np.random.default_rng(seed)
    query, kinds, shares = SelfQuery(robot), robot.primitives.kinds, []
    for _ in range(20):
        q = configuration(robot, rng)
        frames = shape_placements(robot, q[None]).frames[0]
        for (i, j), distance in zip(query.pairs, query.distances(q), strict=True):
            gap = least_gap(kinds[i], frames[i], kinds[j], frames[j], np.inf)
            if distance > 0.0:
                assert gap <= distance + 1e-7
                shares.append(gap / distance)
            elif robot.primitives.exact[[i, j]].all():
                assert gap <= 1e-9
    assert np.median(shares) > 0.7


def motion_of(seed):
    robot, rng = robot_of(seed), np.random.default_rng(seed)
    start, goal = (configuration(robot, rng) for _ in range(2))
    return Motion(robot, "free-flying", start, goal, np.linspace(start[:3], goal[:3], 4))


@pytest.mark.parametrize("seed", range(80))
def test_verdicts_are_those_of_coal_alone(seed):
    motion = motion_of(seed)
    prover = Prover(motion, Scene(), TOLERANCE)
    query, every = SelfQuery(motion.robot), np.arange(len(SelfQuery(motion.robot).pairs))
    if query.empty:
        return
    rounding = 1e-9 + 1e-7
    for layer, verdict in enumerate(prover.links.verdicts()):
        edge = SelfCollisionEdge(query, motion, prover._travel, layer, every, rounding)
        alone = certify(edge, (edge.clearance(0.0), edge.clearance(1.0)), TOLERANCE)
        assert verdict.free == alone.free
        if not verdict.free:
            assert verdict.least_clearance == pytest.approx(alone.least_clearance, abs=2e-4)


@pytest.mark.parametrize("seed", range(40))
def test_pairs_proven_apart_do_not_touch(seed):
    motion = motion_of(seed)
    query = SelfQuery(motion.robot)
    if query.empty:
        return
    prover = Prover(motion, Scene(), TOLERANCE)
    course = course_in_base(motion, prover._travel)
    proven = np.zeros((motion.edges, len(query.pairs)), dtype=bool)
    memory, known = memory_for(course), apart.known_for(course)
    apart.prove_apart(course, query.pairs, 1e-7, memory, known, proven)
    for layer in range(motion.edges):
        for q in motion.at(np.full(60, layer), np.linspace(0.0, 1.0, 60)):
            assert np.all(query.distances(q)[proven[layer]] > 0.0)
    assert proven.any()


@pytest.mark.parametrize("seed", range(5))
def test_the_travel_of_a_pair_is_that_of_both_links(seed):
    motion = motion_of(seed)
    query, travel = SelfQuery(motion.robot), EdgeTravel(motion)
    pairs = np.arange(len(query.pairs))[::2]
    edge = SelfCollisionEdge(query, motion, travel, 1, pairs, 0.0)
    each = travel.bounds(1, 0.25, 0.5)
    expected = [each[i] + each[j] for i, j in query.pairs[pairs]]
    assert np.array_equal(edge.travel(0.25, 0.5), expected)
    assert len(edge.parts(0.5)) == len(pairs)
