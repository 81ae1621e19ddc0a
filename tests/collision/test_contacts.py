"""Contacts: all pairs that touch, each with its depth, against closed forms of spheres."""

from itertools import pairwise, product

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.contacts import contacts, goal_in_collision, start_in_collision
from ffsr_plan.collision.self_collisions import SelfCollision, SelfCollisions
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import inertial, joint, link, sphere, urdf

BALLS = {"base": (0.5, 0.0), "near": (0.4, 1.0), "far": (0.3, 2.0), "end": (0.2, 3.0)}


@pytest.fixture(scope="module")
def chain():
    """Four balls a metre apart along x; each is hinged to the one before."""
    parts = [
        link(name, inertial(1.0, (0.1,) * 3), sphere(radius)) for name, (radius, _) in BALLS.items()
    ]
    names = list(BALLS)
    joints = [
        joint(f"j_{after}", "revolute", before, after, (1.0, 0, 0))
        for before, after in pairwise(names)
    ]
    return robot_from_urdf(urdf(*parts, *joints), "chain")


def test_every_pair_that_touches_is_listed_with_its_depth(chain):
    rng = np.random.default_rng(1)
    centers, radii = rng.uniform((-1, -1, -1), (4, 1, 1), (40, 3)), rng.uniform(0.2, 0.8, 40)
    scene = fp.Scene(centers[:25], radii[:25]).named("a.stl") + fp.Scene(centers[25:], radii[25:])
    found = contacts(chain, scene, chain.configuration())
    expected = {}
    for (name, (radius, x)), k in product(BALLS.items(), range(40)):
        depth = radius + radii[k] - np.linalg.norm(centers[k] - (x, 0, 0))
        if depth >= 0.0:
            expected[name, k] = depth
    assert len(expected) > 20
    assert {(c.link, c.obstacle): c.depth for c in found} == pytest.approx(expected, abs=1e-7)
    assert [c.depth for c in found] == sorted((c.depth for c in found), reverse=True)
    assert {c.source for c in found if c.obstacle < 25} == {"a.stl"}
    assert {c.source for c in found if c.obstacle >= 25} == {""}


def test_links_that_touch_one_another_are_listed(chain):
    folded = chain.configuration(joints={"j_far": 2.8})  # the end lies near the ball `near`
    found = contacts(chain, fp.Scene(), folded)
    assert [(c.link, c.obstacle) for c in found] == [("near", "end")]
    apart = 2.0 * np.sin(0.5 * (np.pi - 2.8))
    assert found[0].depth == pytest.approx(0.6 - apart, abs=1e-6)


def test_a_refused_start_names_all_that_touches_there_and_at_the_goal(chain):
    scene = fp.Scene([[0, 0.6, 0], [3, 0, 0], [9, 0, 0]], [0.2, 0.1, 0.3]).named("b.stl")
    start = chain.configuration()
    problem = fp.Problem(chain, scene, start, chain.configuration((9, 0, 0)))
    with pytest.raises(fp.StartInCollision) as raised:
        fp.plan(problem)
    error = raised.value
    assert [(c.link, c.obstacle) for c in error.contacts] == [("end", 1), ("base", 0)]
    assert (error.link, error.obstacle, error.depth) == error.contacts[0][:3]
    assert [(c.link, c.obstacle) for c in error.goal_contacts] == [("base", 2)]
    assert "by more than 0.8 m" in str(error)


def test_advice_depends_on_what_touches(chain):
    start = chain.configuration()
    folded = chain.configuration(joints={"j_far": 2.8})
    apart = fp.Scene([[0.0, 0.62, 0.0]], [0.2], excess=0.1)
    assert "a smaller excess of the cover" in str(start_in_collision(chain, apart, start))
    deep = fp.Scene([[0.0, 0.3, 0.0]], [0.2], excess=0.1)
    assert "excess" not in str(goal_in_collision(chain, deep, start))
    assert "SRDF" not in str(goal_in_collision(chain, deep, start))
    assert "fp.self_collisions" in str(goal_in_collision(chain, fp.Scene(), folded))


@pytest.mark.parametrize("depth", [0.0, 1e-16, 1e-12])
def test_what_touches_exactly_is_to_keep_the_tolerance(chain, depth):
    touching = fp.Scene([[0.0, 0.75, 0.0]], [0.25 + depth])
    text = str(start_in_collision(chain, touching, chain.neutral()))
    assert "start in collision: link 'base' touches obstacle 0; what may help: " in text
    assert "move the base or the joints out by more than the tolerance" in text
    deep = fp.Scene([[0.0, 0.7, 0.0]], [0.3])
    text = str(start_in_collision(chain, deep, chain.neutral()))
    assert "is 0.1 m inside obstacle 0" in text
    assert "out by more than 0.1 m" in text


@pytest.mark.parametrize("round_body", [fp.Cylinder(2.0, 6.0), fp.Ellipsoid([2.0, 2.0, 3.0])])
def test_what_is_inside_a_round_body_is_said_first_and_without_a_depth(chain, round_body):
    scene = fp.Scene([[0.0, 0.62, 0.0]], [0.2], shapes=[round_body])
    found = contacts(chain, scene, chain.configuration())
    assert found[0].obstacle == 1
    assert {c.obstacle for c in found} == {0, 1}
    error = start_in_collision(chain, scene, chain.configuration())
    assert error.obstacle == 1
    assert f"link 'base' is inside {round_body.word} (shapes.0)" in str(error)
    assert f"move the base or the joints out of {round_body.word} (shapes.0)" in str(error)
    assert fp.clearance(chain, scene, chain.configuration()).obstacle == 0


def test_a_robot_outside_of_a_zone_is_to_be_moved_into_it(chain):
    zone = fp.Scene(keep_in=[fp.Box([6, 4, 4], [4.0, 0, 0], name="hall")])
    text = str(start_in_collision(chain, zone, chain.configuration()))
    assert "move the base or the joints into box 'hall' by more than 1.5 m" in text
    assert " out " not in text


def test_zones_without_a_common_point_are_told(chain):
    zones = [fp.Box([2, 2, 2]), fp.Ball(1.0, [3.0, 0, 0])]
    text = str(start_in_collision(chain, fp.Scene(keep_in=zones), chain.configuration()))
    assert "zones that overlap: no point is in all of them, they miss it by 0.5 m" in text


@pytest.mark.parametrize("zone", [fp.Box([2.5, 5, 5]), fp.Ball(1.25)])
def test_a_zone_smaller_than_the_robot_is_told(chain, zone):
    text = str(start_in_collision(chain, fp.Scene(keep_in=[zone]), chain.configuration()))
    assert f"larger zones than {zone.word} (keep_in.0)" in text
    assert "at least 1.2 m too wide" in text  # it is 3.7 m long
    assert " out by" not in text


def test_links_that_touch_exactly_are_shown_so():
    pairs = [SelfCollision("a", "b", 0.1), SelfCollision("b", "c", 5e-17)]
    robot = fp.load_robot("point")
    assert repr(SelfCollisions(robot, pairs)).endswith("a and b by 0.1 m; b and c touch)")


def test_joints_outside_their_limits_are_named_with_what_touches(robot):
    joints = dict.fromkeys(robot.joint_names, 0.0)
    joints |= {"left_1": 3.0, "right_2": -3.0}
    values = np.array(list(joints.values()))
    outside = robot.assemble(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), values)
    scene = fp.Scene([[0.0, 0.0, 0.0]], [0.1]).named("c.stl")
    goal = robot.configuration((5.0, 0.0, 0.0))
    message = (
        r"start \(joints left_1, right_2\): got \[3.0, -3.0\]; allowed: left_1 -1.8 to 1.8, "
        r"right_2 -2.6 to 2.6; at these values, link .* inside c.stl \(sphere 0\)"
    )
    with pytest.raises(fp.InvalidInput, match=message):
        fp.Problem(robot, scene, outside, goal)
    with pytest.raises(fp.InvalidInput, match=r"goal \(joints left_1, right_2\)") as raised:
        fp.Problem(robot, scene, goal, outside)
    assert "c.stl" not in str(raised.value)  # where the base is at the goal depends on the mode
