"""`on_bus`: the mass of a bus counts as that of the root link does."""

import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp


def test_masses_and_inertias_add(robot):
    before = robot.model.inertias[1]
    center = [0.1, -0.2, 0.3]
    bus = pin.Inertia(200.0, np.array(center), np.diag([50.0, 60.0, 70.0]))
    heavy = fp.on_bus(robot, 200.0, [50.0, 60.0, 70.0], center)
    assert np.abs((before + bus).matrix() - heavy.model.inertias[1].matrix()).max() < 1e-9
    assert heavy.mass == pytest.approx(robot.mass + 200.0)
    assert heavy.link_names == robot.link_names
    assert heavy.collision_model.ngeoms == robot.collision_model.ngeoms


def test_a_heavy_bus_turns_in_proportion_less(robot):
    joints = {name: [0.0, 0.5] for name in robot.joint_names[:2]}
    joints |= {name: [0.0, 0.0] for name in robot.joint_names[2:]}
    given = fp.Trajectory([0.0, 1.0], joints)
    turns = [fp.certify(fp.on_bus(robot, mass), fp.Scene(), given).turn for mass in (1e4, 1e5)]
    assert turns[0] / turns[1] == pytest.approx(10.0, rel=1e-2)


@pytest.mark.parametrize("given", [{"mass": 0.0}, {"mass": 1.0, "inertia": [1.0, 1.0, 3.0]}])
def test_what_no_bus_has_is_refused(robot, given):
    with pytest.raises(fp.InvalidInput, match="base"):
        fp.on_bus(robot, **given)
