"""Proofs among obstacles of every shape, and in zones."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.prover import Prover
from ffsr_plan.scene.shapes.obstacle_shapes import Box
from tests.helpers.grazing_shapes import ZONES, Counts, look_at
from tests.helpers.obstacle_shapes import KINDS
from tests.helpers.single_link_robots import one_link
from tests.helpers.urdf_builders import sphere

STILL = np.zeros(3)


@pytest.mark.parametrize("kind", [*KINDS, *ZONES])
def test_no_motion_that_touches_an_obstacle_is_proven_free(kind):
    found = Counts()
    for seed in range(4):
        one = look_at(seed, kind)
        found = Counts(*(a + b for a, b in zip(found, one, strict=True)))
    assert found.false_free == 0
    assert found.wrongly_refused == 0
    assert found.free >= 5
    assert found.refused >= 2
    assert found.grazing_free >= 1


def test_a_flat_panel_is_passed_at_a_millimetre_and_not_through():
    robot, radius = one_link(sphere(0.3)), 0.3
    panel = fp.Scene(shapes=[Box((4.0, 4.0, 0.0))])
    for height, free in ((radius + 1e-3, True), (radius - 1e-3, False)):
        begin, end = (robot.configuration((x, 0.3, height)) for x in (-5.0, 5.0))
        motion = Motion(robot, "free-flying", begin, end, np.stack([begin[:3], end[:3]]))
        prover = Prover(motion, panel, 1e-4)
        ends = tuple(prover.clearances(np.array([0, 1]), np.zeros((2, 3))).tolist())
        assert prover.certify(0, STILL, STILL, ends).free == free
    begin, end = (robot.configuration((0.0, 0.0, z)) for z in (-1.0, 1.0))
    motion = Motion(robot, "free-flying", begin, end, np.stack([begin[:3], end[:3]]))
    prover = Prover(motion, panel, 1e-4)
    assert not prover.certify(0, STILL, STILL, (1.0 - radius, 1.0 - radius)).free
