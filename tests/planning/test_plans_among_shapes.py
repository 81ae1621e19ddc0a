"""Plans among obstacles of every shape, from end to end."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.scene.shapes.keep_in_zones import HalfSpace
from ffsr_plan.scene.shapes.obstacle_shapes import Box, Capsule, Cylinder, Ellipsoid

BUS = [
    Box((1.2, 1.2, 1.2), (4.0, 0.0, 0.0), name="bus"),
    Box((1.2, 3.0, 0.0), (4.0, 2.2, 0.0), name="panel"),
    Capsule(0.1, 2.0, (4.0, -1.8, 0.0), (0.0, 0.0, np.pi / 2), name="boom"),
]
DISH = [Cylinder(0.4, 0.3, (4.0, 0.0, 0.9)), Ellipsoid((0.3, 0.2, 0.2), (4.0, 0.0, -0.8))]
ROOM = [Box((14.0, 9.0, 9.0), (3.0, 0.0, 0.0)), HalfSpace((0.0, 0.0, -1.0), (0.0, 0.0, -3.0))]
LATTICE = fp.Lattice(12, lateral=fp.Axis(6, 0.5), normal=fp.Axis(6, 0.5))


@pytest.fixture(scope="module")
def robot():
    return fp.load_robot("spatial_dual_arm")


def problem(robot, shapes, **options):
    scene = fp.Scene([[2.0, 1.0, 1.0]], [0.3], shapes=shapes, keep_in=ROOM)
    goal = robot.configuration((7.5, 0.3, 0.0), joints={robot.joint_names[0]: 0.3})
    return fp.Problem(robot, scene, robot.neutral(), goal, delta=0.02, **options)


@pytest.mark.parametrize("shapes", [BUS, BUS + DISH], ids=["closed forms", "coal"])
@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
def test_trees_find_a_way_that_verifies(robot, shapes, mode):
    plan = fp.plan(problem(robot, shapes, mode=mode), fp.TreePlanner(checks=60_000))
    report = plan.verify()
    assert report.ok, report.problems
    assert plan.certificate.least_clearance > 0.0
    assert plan.optimum <= plan.objective


@pytest.mark.parametrize("shapes", [BUS, BUS + DISH], ids=["closed forms", "coal"])
def test_the_optimum_of_a_lattice_is_below_every_colony(robot, shapes):
    given = problem(robot, shapes, lattice=LATTICE)
    best = fp.plan(given, fp.LatticeOptimum(), refine=False)
    ants = fp.plan(given, refine=False)
    refined = fp.plan(given, fp.LatticeOptimum())
    assert best.gap == 0.0
    assert best.objective <= ants.objective + 1e-9
    assert refined.objective < best.objective
    for plan in (best, ants, refined):
        report = plan.verify()
        assert report.ok, report.problems


def test_a_floating_arm_moves_beside_a_satellite():
    robot = fp.load_robot("satellite_ur5")
    target = fp.Scene.from_urdf("planar_dual_arm", (0.0, 0.0, 3.5))
    goal = robot.configuration(joints={"arm_shoulder_pan_joint": 1.4, "arm_elbow_joint": -0.8})
    plan = fp.plan(fp.Problem(robot, target, robot.neutral(), goal, "free-floating"), until="first")
    assert plan.verify().ok


def test_what_is_kept_free_grows_with_the_clearance_that_is_demanded(robot):
    plan = fp.plan(problem(robot, BUS, min_clearance=0.25), fp.TreePlanner(checks=40_000))
    assert plan.verify().ok
    assert min(fp.clearance(robot, plan.problem.scene, q) for q in plan.configurations) >= 0.25


def test_flights_along_such_plans_verify(robot):
    plan = fp.plan(problem(robot, BUS + DISH), fp.TreePlanner(checks=40_000))
    limits = {"joint_acceleration": 0.05, "thruster_acceleration": 0.01}
    for each in (plan, plan.smooth(), plan.least_fuel(margin=0.02)):
        assert each.timed(**limits).verify().ok


def test_a_zone_that_cannot_be_left_blocks_a_goal_outside(robot):
    given = problem(robot, BUS)
    outside = fp.Problem(
        robot, given.scene, robot.neutral(), robot.configuration((14.0, 0.0, 0.0)), given.mode
    )
    with pytest.raises(fp.GoalInCollision, match=r"outside of box \(keep_in.0\)"):
        fp.plan(outside)


@pytest.mark.parametrize(
    "large", [Box((40.0, 25.0, 10.0), (0.0, 16.0, 0.0)), Cylinder(200.0, 400.0, (0.0, 204.0, 0.0))]
)
def test_correct_plans_beside_large_bodies_verify(large):
    """Coal's distances to them are too small by a share of their size."""
    arm = fp.load_robot("satellite_ur5")
    goal = arm.configuration((5.0, 0.0, 0.0))
    given = fp.Problem(arm, fp.Scene(shapes=[large]), arm.neutral(), goal)
    report = fp.plan(given, until="first").verify()
    assert report.ok, report.problems
    assert report.clearance_error > 1e-9
