"""Shapes that may touch a body, from an edge on."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.bodies.pace import Pace
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.moving_obstacles import Touching
from ffsr_plan.proof.prover import Prover

EDGES = 4


@pytest.fixture(scope="module")
def motion():
    """A way of 2 m along x in four edges, at whose end a link touches a ball."""
    robot = fp.load_robot("planar_dual_arm")
    ways = np.linspace((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), EDGES + 1)
    ends = (robot.configuration(way) for way in ways[[0, -1]])
    return Motion(robot, "free-flying", *ends, ways)


def verdicts(motion, touching, at=(2.0, 1.0, 0.0)):
    """Whether each edge is proven past a ball that hardly moves, and clearances at the layers."""
    ball = fp.MovingBody([fp.Ball(0.1)], fp.Drift((0.0, 1e-6, 0.0)), at)
    scene, pace = fp.Scene(bodies=[ball]), Pace(10.0, 0.0, EDGES)
    prover = Prover(motion, scene, 1e-6, pace=pace, touching=touching)
    still, layers = np.zeros((EDGES + 1, 3)), np.arange(EDGES + 1)
    clearances = prover.clearances(layers, still)
    ends = np.column_stack([clearances[:-1], clearances[1:]])
    found = prover.certify_all(layers[:-1], still[1:], still[1:], ends)
    least = prover.least_clearance(still, clearances) if all(v.free for v in found) else 0.0
    return [verdict.free for verdict in found], clearances, least


def owners(motion, ball):
    """Which shapes touch a ball at the end."""
    robot, q = motion.robot, motion.configurations()[-1]
    query = ObstacleQuery(robot, fp.Scene([ball], [0.1]))
    return query.links_at(shape_placements(robot, q[None]), 0, np.zeros(3)) <= 0.0


def test_contact_is_allowed_from_an_edge_on(motion):
    at = (2.0, 1.0, 0.0)
    arm = owners(motion, at)
    assert 0 < arm.sum() < len(arm)
    free, clearances, _ = verdicts(motion, None)
    assert free == [True, True, True, False]
    assert clearances[-1] <= 0.0
    late, clearances, least = verdicts(motion, Touching.since(0, arm, 3, EDGES))
    assert late == [True] * EDGES
    assert 0.0 < least <= clearances.min() + 1e-9
    everything = np.ones(len(arm), dtype=bool)
    middle = (1.37, 1.0, 0.0)  # touched in the middle of edge 2, and at none of its ends
    free, clearances, _ = verdicts(motion, Touching.since(0, everything, 3, EDGES), middle)
    assert np.all(clearances > 0.0)
    assert free == [True, True, False, True]
    assert verdicts(motion, Touching.since(0, everything, 2, EDGES), middle)[0] == [True] * EDGES
    others = np.ones(len(arm), dtype=bool) & ~arm
    assert verdicts(motion, Touching.since(0, others, 3, EDGES))[0] == [True, True, True, False]


def test_contact_is_allowed_until_an_edge(motion):
    middle, arm = (1.37, 1.0, 0.0), np.ones(len(motion.robot.collision_model.geometryObjects), bool)
    assert verdicts(motion, Touching.until(0, arm, 2, EDGES), middle)[0][2] is False
    assert verdicts(motion, Touching.until(0, arm, 3, EDGES), middle)[0] == [True] * EDGES
    at_start = verdicts(motion, None, (0.0, 1.0, 0.0))
    assert at_start[1][0] <= 0.0
    free, clearances, _ = verdicts(motion, Touching.until(0, arm, 1, EDGES), (0.0, 1.0, 0.0))
    assert free == [True] * EDGES
    assert clearances[0] > 1.0
    assert np.array_equal(clearances[1:], at_start[1][1:])
