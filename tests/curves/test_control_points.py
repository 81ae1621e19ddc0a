"""Control points lie on the edges of a motion."""

import numpy as np
import pytest

from ffsr_plan.core import rotations
from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.dynamics.momentum import centers_of_mass
from tests.helpers.curved_flights import MODES
from tests.helpers.random_motions import bent_motion


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("bend", [False, True])
def test_control_points_are_configurations_on_the_edges(mode, bend):
    motion = bent_motion(2, mode, edges=5, joints_bend=bend)
    parameters = np.sort(np.append(np.arange(6.0), [0.5, 1.25, 4.75]))
    control = control_points_on(motion, parameters)
    edge = np.minimum(parameters.astype(int), 4)
    q = motion.at(edge, parameters - edge)
    assert control.joint_values == pytest.approx(motion.joints_at(edge, parameters - edge))
    if mode == "free-floating":
        centers = centers_of_mass(motion.robot, control.joint_values)
        centers = q[:, :3] + rotations.rotate(q[:, 3:7], centers)
        assert control.positions == pytest.approx(centers, abs=1e-9)
    else:
        assert control.positions == pytest.approx(q[:, :3], abs=1e-12)
    if mode == "attitude-held":
        turned = rotations.exp(control.shares[:, None] * motion.turns.sum(axis=0))
        wanted = rotations.multiply(motion.attitudes[0], turned)
        assert rotations.angle_between(wanted, q[:, 3:7]).max() < 1e-9
    else:
        assert control.shares == pytest.approx(parameters / 5.0)
    assert control.table.shape == (9, 3 + motion.robot.nd + 1)
