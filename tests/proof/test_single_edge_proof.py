"""`certify_edge` and the soundness of proofs: no false "free", no needless refusal."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.grazing_obstacles import SURELY_FREE, look_at
from tests.helpers.urdf_builders import cylinder, inertial, link, urdf

BESIDE_THE_ARMS = fp.Scene([[0.1, 1.2, 0.0], [1.0, -1.5, 0.0]], [0.1, 0.1])


def swing_of_the_arms(robot):
    begin = robot.configuration(joints={"left_1": -0.5, "left_2": -1.0})
    end = robot.configuration((0.3, 0.0, 0.0), joints={"left_1": 0.9, "right_1": 0.5})
    return begin, end


@given(st.integers(0, 10**6))
@settings(max_examples=40)
def test_no_touching_motion_is_free_and_no_clear_one_refused(seed):
    found = look_at(seed, scenes=4)
    assert found.false_free == 0
    assert found.wrongly_refused == 0


def test_grazing_motions_are_proven_free_and_refused():
    """The law above alone would hold for a prover that gives no verdict."""
    found = [look_at(seed, scenes=6) for seed in range(8)]
    assert sum(f.grazing_free for f in found) >= 8
    assert sum(f.refused for f in found) >= 8
    assert SURELY_FREE < 1e-2


def test_a_motion_free_at_a_held_attitude_may_collide_reacting(robot):
    begin, end = swing_of_the_arms(robot)
    reacting = fp.certify_edge(robot, BESIDE_THE_ARMS, begin, end)
    held = fp.certify_edge(robot, BESIDE_THE_ARMS, begin, end, mode="attitude-held")
    assert reacting.free
    assert not held.free
    assert (held.link, held.obstacle) == ("left_link_3", 0)
    elsewhere = fp.Scene([[0.8, 1.0, 0.0]], [0.1])
    assert not fp.certify_edge(robot, elsewhere, begin, end).free
    assert fp.certify_edge(robot, elsewhere, begin, end, mode="attitude-held").free


def test_the_nearest_pair_of_a_proof_is_where_it_says(robot):
    begin, end = swing_of_the_arms(robot)
    proof = fp.certify_edge(robot, BESIDE_THE_ARMS, begin, end)
    assert proof.time == 1.0
    here = fp.clearance(robot, BESIDE_THE_ARMS, proof.arrival)
    assert here == pytest.approx(proof.least_clearance, abs=1e-12)
    assert (here.link, here.obstacle) == (proof.link, proof.obstacle) == ("left_link_3", 0)
    assert 0.95 * proof.least_clearance <= proof.proven_clearance <= proof.least_clearance
    assert proof.queries > 0


def test_the_arrival_is_that_of_the_reacting_base(robot):
    begin, end = swing_of_the_arms(robot)
    proof = fp.certify_edge(robot, fp.Scene(), begin, end)
    assert proof.free
    assert proof.least_clearance == proof.proven_clearance == np.inf
    assert (proof.link, proof.obstacle) == ("", None)
    assert np.allclose(proof.arrival[:3], end[:3])
    assert np.allclose(proof.arrival[7:], end[7:])
    assert abs(rotations.to_angles(proof.arrival[3:7])[0]) > 0.3


def test_links_that_sweep_through_each_other_are_named(robot):
    names = robot.joint_names
    begin, end = (-1.6, -1.0, -0.4, 0.9, 1.9, 1.0), (-1.6, -1.5, -0.7, 1.0, -0.6, 0.6)
    first, last = (
        robot.configuration(joints=dict(zip(names, values, strict=True))) for values in (begin, end)
    )
    proof = fp.certify_edge(robot, fp.Scene(), first, last)
    assert not proof.free
    assert proof.link.startswith("left_link")
    assert isinstance(proof.obstacle, str)
    assert proof.obstacle.startswith("right_link")
    assert proof.least_clearance <= 1e-4
    assert proof.proven_clearance == 0.0


def test_standing_still_is_free_where_it_is_clear(robot):
    q = robot.neutral()
    assert fp.certify_edge(robot, fp.Scene([[0.5, 0.0, 0.0]], [0.2]), q, q).free
    inside = fp.certify_edge(robot, fp.Scene([[0.0, 0.0, 0.0]], [0.1]), q, q)
    assert not inside.free
    assert inside.link == "base"
    assert inside.least_clearance < -0.1


def test_a_turn_of_a_whole_radian_and_more_in_one_edge_is_proven(robot):
    begin = robot.configuration(joints={"left_1": -1.5, "right_2": -1.2})
    end = robot.configuration(joints={"left_1": 1.5, "right_2": 1.3})
    assert fp.certify_edge(robot, fp.Scene([[3.0, 0.0, 0.0]], [0.5]), begin, end).free


def test_a_clearance_is_a_number_that_knows_its_pair(robot):
    found = fp.clearance(robot, BESIDE_THE_ARMS, robot.neutral())
    assert isinstance(found, float)
    assert found + 1.0 == float(found) + 1.0
    assert (found.link, found.obstacle) == ("left_link_3", 0)
    again = pickle.loads(pickle.dumps(found))
    assert (again, again.link, again.obstacle) == (found, found.link, found.obstacle)
    nothing = fp.clearance(robot, fp.Scene(), robot.neutral())
    assert nothing == np.inf
    assert (nothing.link, nothing.obstacle) == ("", None)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"robot": "planar_dual_arm"}, "robot"),
        ({"scene": [[0, 0, 0]]}, "scene"),
        ({"start": [0.0, 1.0]}, "start"),
        ({"goal": np.full(13, np.nan)}, "goal"),
        ({"mode": "free-fling"}, "mode.*free-flying"),
        ({"tolerance": 0.0}, "tolerance"),
    ],
)
def test_arguments_are_checked_by_name(robot, wrong, named):
    q = robot.neutral()
    given_ = {"robot": robot, "scene": fp.Scene(), "start": q, "goal": q, **wrong}
    with pytest.raises(fp.InvalidInput, match=named):
        fp.certify_edge(**given_)


def cylinder_beside(gap):
    """A prism of 24 sides with a ball `gap` beside one of its flat sides."""
    robot = robot_from_urdf(
        urdf(link("base", inertial(1.0, (1.0, 1.0, 1.0)), cylinder(0.3, 1.0))), "can"
    )
    return robot, fp.Scene([[0.0, 0.5 + 0.3 + gap, 0.0]], [0.5])


@pytest.mark.parametrize("gap", [1e-3, 1e-4, 1e-6, 3e-7])
def test_a_proof_ends_however_near_a_hull_comes(gap):
    """If the margin for Coal's iterations exceeds the clearance, the motion is refused."""
    robot, scene = cylinder_beside(gap)
    proof = fp.certify_edge(robot, scene, robot.neutral(), robot.neutral())
    assert proof.free or gap < 1e-6
    assert 0.0 <= proof.proven_clearance <= gap + 1e-8


def test_the_margin_of_a_proof_grows_with_the_spheres_radius():
    """The error of Coal's iterations grows with the distance of the centres, here 5 and 50 km."""
    for radius in (5e3, 5e4):
        robot, _ = cylinder_beside(0.1)
        q = robot.neutral()
        for inside in (-2e-7, 2e-7):
            center = [[0.0, radius + 0.3 - inside, 0.0]]
            proof = fp.certify_edge(robot, fp.Scene(center, [radius]), q, q)
            assert proof.proven_clearance <= max(0.0, -inside)


def test_a_robot_without_shapes_is_free_everywhere():
    robot = robot_from_urdf(urdf(link("base", inertial(1.0, (1.0, 1.0, 1.0)))), "ghost")
    begin, end = robot.neutral(), robot.configuration((3, 0, 0))
    for scene in (fp.Scene(), fp.Scene([[1.0, 0.0, 0.0]], [0.5])):
        assert fp.certify_edge(robot, scene, begin, end).free
        lattice = fp.Lattice(4, fp.Axis(1, 0.5))
        plan = fp.plan(fp.Problem(robot, scene, begin, end, lattice=lattice))
        assert plan.verify(10).ok
