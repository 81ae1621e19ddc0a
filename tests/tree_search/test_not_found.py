"""What the error says where the search by trees finds no path."""

import numpy as np
import pytest

import ffsr_plan as fp

FEW = fp.TreePlanner(checks=30_000)


@pytest.fixture(scope="module")
def robot():
    return fp.load_robot("planar_dual_arm")


def ring(center, radius):
    """Spheres around a place in the plane, without gaps."""
    angles = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    around = np.stack([np.cos(angles), np.sin(angles), np.zeros(60)], axis=1)
    return fp.Scene(center + radius * around, np.full(60, 0.2))


def refused(robot, around, start, goal):
    problem = fp.Problem(robot, ring(around, 2.5), start, goal)
    with pytest.raises(fp.PathNotFound) as caught:
        fp.plan(problem, FEW)
    return caught.value


@pytest.mark.parametrize("enclosed", ["start", "goal"])
def test_an_enclosed_end_is_named(robot, enclosed):
    ends = {"start": np.zeros(3), "goal": np.array([8.0, 0.0, 0.0])}
    places = [robot.configuration(place) for place in ends.values()]
    error = refused(robot, ends[enclosed], *places)
    side = ("start", "goal").index(enclosed)
    assert error.enclosed == enclosed
    assert error.spread[side] < 4.0 < error.spread[1 - side]
    assert f"the {enclosed} may be enclosed: the trees from it came no farther than" in str(error)


def test_a_wall_between_start_and_goal_encloses_neither(robot):
    places = np.stack([np.full(60, 4.0), np.linspace(-9.0, 9.0, 60), np.zeros(60)], axis=1)
    problem = fp.Problem(
        robot,
        fp.Scene(places, np.full(60, 0.2)),
        robot.neutral(),
        robot.configuration((8.0, 0.0, 0.0)),
    )
    with pytest.raises(fp.PathNotFound) as caught:
        fp.plan(problem, FEW)
    assert caught.value.enclosed == ""
    assert min(caught.value.spread) > 4.0
    assert "enclosed" not in str(caught.value)


@pytest.mark.parametrize(("angles", "out"), [((3.0, 0.0, 0.0), False), ((0.0, 1.0, 0.0), True)])
def test_a_planar_robot_is_said_not_to_turn_out_of_its_plane(robot, angles, out):
    goal = robot.configuration((1.0, 0.0, 0.0), attitude=angles)
    problem = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, reach_attitude=True)
    with pytest.raises(fp.PathNotFound) as caught:
        fp.plan(problem, fp.TreePlanner(checks=500))
    assert any("turned about z alone" in each for each in caught.value.advice) == out


def test_joint_values_in_degrees_are_recognised(robot):
    q = robot.neutral().copy()
    q[7] = 90.0
    with pytest.raises(fp.InvalidInput, match="angles are in radians, not in degrees"):
        fp.Problem(robot, fp.Scene(), robot.neutral(), q)
    q[7] = 4.0
    with pytest.raises(fp.InvalidInput) as caught:
        fp.Problem(robot, fp.Scene(), robot.neutral(), q)
    assert "degrees" not in str(caught.value)
