"""Problems whose search is watched."""

import pytest

import ffsr_plan as fp


@pytest.fixture(scope="module")
def problem(point):
    """Two axes on demand: few nodes a layer, so that pheromone lies on edges."""
    start, goal = point.configuration(), point.configuration((4.0, 0.0, 0.0))
    scene = fp.Scene([[2.0, 0.1, 0.0]], [0.3])
    lattice = fp.Lattice(8, fp.Axis(3, 0.2))
    return fp.Problem(point, scene, start, goal, lattice=lattice, delta=0.1)


@pytest.fixture(scope="module")
def wide_problem(point):
    """121 nodes a layer, so that pheromone lies on nodes."""
    start, goal = point.configuration(), point.configuration((4.0, 0.0, 0.0))
    scene = fp.Scene([[2.0, 0.1, 0.0]], [0.3])
    lattice = fp.Lattice(8, fp.Axis(5, 0.2), fp.Axis(5, 0.2))
    return fp.Problem(point, scene, start, goal, lattice=lattice, delta=0.1)


@pytest.fixture(scope="module")
def turning_problem(robot):
    """Base offsets and a posture axis."""
    lattice = fp.Lattice(
        6, fp.Axis(2, 0.2), postures=[fp.PostureAxis({"left_2": 1.0, "right_2": 1.0}, 2, 0.3)]
    )
    goal = robot.configuration((3.0, 0.0, 0.0))
    scene = fp.Scene([[1.5, 1.9, 0.0]], [0.3])
    return fp.Problem(robot, scene, robot.neutral(), goal, lattice=lattice)


@pytest.fixture(scope="session")
def flight(fig2a_plan):
    """With pulses at corners, a limit that is reached and one far above what is flown."""
    return fig2a_plan.timed(
        joint_acceleration=0.05, thruster_acceleration=0.01, velocity_jump=0.04, corners="rest"
    )
