"""All links that touch, deepest first, and an SRDF that exempts them."""

import pickle

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import box, inertial, joint, link, random_robot, urdf

CUBE = inertial(1.0, (1.0, 1.0, 1.0)) + box((0.2, 0.2, 0.2))
SRDF = """<robot name='row'>
<group_state name='up' group='g'><joint name='j1' value='1'/></group_state>
<disable_collisions link1='a' link2='c' reason='Never'/></robot>"""


def row(srdf=""):
    """Cubes on sliders along x: a at 0.5 + j1, b at 1 + j2, c at 1.5 + j3, d fixed to the base."""
    links = [link(name, CUBE) for name in ("base", "a", "b", "c")]
    links.append(link("d", CUBE, box((0.2, 0.2, 0.2), (0, 0.15, 0))))
    joints = [
        joint(f"j{k}", "prismatic", "base", name, (0.5 * k, 0, 0), axis=(1, 0, 0))
        for k, name in enumerate("abc", 1)
    ]
    text = urdf(*links, *joints, joint("bolt", "fixed", "base", "d", (-0.5, 0, 0)))
    return robot_from_urdf(text, "row", srdf=srdf)


def test_all_pairs_are_listed_with_the_deepest_first():
    robot = row()
    touching = fp.self_collisions(robot, robot.configuration(joints={"j2": -0.37, "j3": -0.85}))
    # a 0.4 to 0.6, b 0.53 to 0.73, c 0.55 to 0.75
    assert [each[:2] for each in touching] == [("b", "c"), ("a", "b"), ("a", "c")]
    np.testing.assert_allclose([each.depth for each in touching], [0.18, 0.07, 0.05], atol=1e-9)
    assert repr(touching).startswith("SelfCollisions(3 pairs: b and c by 0.18 m; ")
    assert pickle.loads(pickle.dumps(touching)).pairs == touching.pairs


def test_links_that_may_touch_are_not_listed():
    robot = row(SRDF)
    assert list(fp.self_collisions(robot, robot.neutral())) == []
    touching = fp.self_collisions(robot, robot.configuration(joints={"j1": -0.5, "j3": -1.0}))
    assert [each[:2] for each in touching] == []  # a in the base, adjacent; c in a, exempt
    point = fp.load_robot("point")
    assert len(fp.self_collisions(point, point.neutral())) == 0


def test_two_shapes_of_a_link_are_one_pair_of_their_greatest_depth():
    robot = row()
    q = robot.configuration(joints={"j1": -0.95})  # a at -0.45, d at -0.5 and beside it
    (touching,) = fp.self_collisions(robot, q)
    assert {touching.first, touching.second} == {"a", "d"}
    assert touching.depth == pytest.approx(0.15)


def test_the_srdf_exempts_these_pairs_and_keeps_all_else(tmp_path):
    robot = row(SRDF)
    q = robot.configuration(joints={"j2": -0.37, "j3": -0.85})
    touching = fp.self_collisions(robot, q)
    touching.write_srdf(tmp_path / "more.srdf")
    (tmp_path / "row.urdf").write_text(robot.urdf)
    exempt = fp.load_robot(tmp_path / "row.urdf", srdf=tmp_path / "more.srdf")
    assert exempt.disabled_pairs == (("a", "b"), ("a", "c"), ("b", "c"))
    assert exempt.postures == {"up": {"j1": 1.0}}
    assert list(fp.self_collisions(exempt, q)) == []
    assert robot_from_urdf(robot.urdf, "row", srdf=touching.srdf).disabled_pairs == (
        exempt.disabled_pairs
    )
    for wrong in ("more.txt", 3, tmp_path / "gone" / "x.srdf"):
        with pytest.raises(fp.InvalidInput, match="path"):
            touching.write_srdf(wrong)


@pytest.mark.parametrize("seed", range(6))
def test_a_list_is_empty_where_the_least_distance_is_positive(seed):
    from ffsr_plan.collision.distances import SelfQuery

    robot, rng = random_robot(seed, arms=3), np.random.default_rng(seed)
    query = SelfQuery(robot)
    for _ in range(20):
        q = robot.assemble(np.zeros(3), np.array([0, 0, 0, 1.0]), rng.uniform(-2, 2, robot.nd))
        touching = fp.self_collisions(robot, q)
        assert bool(touching) == (query.distance(q) <= 0.0)
        if touching:
            assert touching[0].depth == pytest.approx(-query.distance(q), abs=1e-12)


def test_things_of_another_kind_are_refused():
    with pytest.raises(fp.InvalidInput, match="robot: got 3"):
        fp.self_collisions(3, [0.0])
    with pytest.raises(fp.InvalidInput, match="q "):
        fp.self_collisions(row(), [0.0])
