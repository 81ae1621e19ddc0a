"""Pairs that an SRDF exempts: left out of the plan and of its re-check, and of nothing else."""

import pytest

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.verification.urdf_reading import Bodies
from tests.helpers.urdf_builders import box, inertial, joint, link, urdf

CUBE = inertial(1.0, (1.0, 1.0, 1.0)) + box((0.2, 0.2, 0.2))
CHAIN = urdf(
    *(link(name, CUBE) for name in ("base", "a", "b", "c")),
    joint("j1", "revolute", "base", "a", (0.5, 0, 0)),
    joint("j2", "revolute", "a", "b", (0.5, 0, 0)),
    joint("j3", "revolute", "b", "c", (0.5, 0, 0)),
)


def srdf(*pairs):
    lines = (f"<disable_collisions link1='{a}' link2='{b}' reason='x'/>" for a, b in pairs)
    return f"<robot name='made'><group name='arm'/>{''.join(lines)}</robot>"


def planned_pairs(robot):
    shapes = robot.collision_model.geometryObjects
    return {
        frozenset(robot.link_of(shapes[k]) for k in (p.first, p.second))
        for p in robot.collision_model.collisionPairs
    }


def checked_pairs(robot):
    return {
        frozenset((a.link, b.link))
        for a, b in Bodies(robot.urdf, robot.srdf, robot.replacements).pairs()
    }


def test_disabled_pairs_are_neither_planned_with_nor_verified():
    everything = {frozenset(p) for p in (("base", "b"), ("base", "c"), ("a", "c"))}
    free = robot_from_urdf(CHAIN, "made")
    assert planned_pairs(free) == checked_pairs(free) == everything
    robot = robot_from_urdf(CHAIN, "made", srdf=srdf(("c", "base"), ("base", "a")))
    assert planned_pairs(robot) == checked_pairs(robot) == everything - {frozenset(("base", "c"))}
    assert robot.disabled_pairs == (("a", "base"), ("base", "c"))


def test_an_unknown_link_is_refused_with_the_nearest_name(robot):
    with pytest.raises(fp.InvalidInput, match=r"SRDF.*link2.*did you mean 'left_link_1'"):
        robot_from_urdf(robot.urdf, "made", srdf=srdf(("base", "left_lnk_1")))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot>", "well-formed"),
        ("<!DOCTYPE robot><robot/>", "document type"),
        ("<urdf/>", "<robot> element"),
        ("<robot><disable_collisions link1='a'/></robot>", "link2"),
        (srdf(("a", "a")), "two different links"),
        (" \n", "well-formed"),
        (CHAIN, "made, SRDF: got 'a URDF .*allowed: an SRDF"),
    ],
)
def test_an_srdf_that_is_not_one_is_refused(text, message):
    with pytest.raises(fp.InvalidInput, match=message):
        robot_from_urdf(CHAIN, "made", srdf=text)


@pytest.mark.parametrize("text", ["", " \n"])
def test_an_empty_srdf_file_is_refused_by_name(tmp_path, text):
    (tmp_path / "made.urdf").write_text(CHAIN)
    (tmp_path / "made.srdf").write_text(text)
    with pytest.raises(fp.InvalidInput, match=r"srdf: got '.*made\.srdf'.*not empty"):
        fp.load_robot(tmp_path / "made.urdf", srdf=tmp_path / "made.srdf")


def test_an_srdf_is_read_from_its_file_and_kept_in_the_plan(tmp_path):
    (tmp_path / "made.urdf").write_text(CHAIN)
    (tmp_path / "made.srdf").write_text(srdf(("base", "c")))
    robot = fp.load_robot(tmp_path / "made.urdf", srdf=tmp_path / "made.srdf")
    assert robot.disabled_pairs == (("base", "c"),)
    goal = robot.configuration((3, 0, 0))
    plan = fp.plan(fp.Problem(robot, fp.Scene(), robot.neutral(), goal, lattice=fp.Lattice(4)))
    plan.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded == plan
    assert loaded.problem.robot.disabled_pairs == (("base", "c"),)
    with pytest.raises(fp.InvalidInput, match=r"gone\.srdf.*readable"):
        fp.load_robot(tmp_path / "made.urdf", srdf=tmp_path / "gone.srdf")


FOLDED = {"j1": 2.1, "j2": 2.1, "j3": 2.0}  # a triangle: the last cube lies on the base


def test_exempt_links_that_touch_can_be_planned_and_verified():
    tied = robot_from_urdf(CHAIN, "made", srdf=srdf(("base", "c")))
    for robot, touches in ((tied, False), (robot_from_urdf(CHAIN, "made"), True)):
        start, goal = (robot.configuration((x, 0, 0), joints=FOLDED) for x in (0, 3))
        problem = fp.Problem(robot, fp.Scene(), start, goal, lattice=fp.Lattice(4))
        if touches:
            with pytest.raises(fp.StartInCollision):
                fp.plan(problem)
        else:
            assert fp.plan(problem).verify(20).ok


def test_a_scenario_names_srdf_and_containers(tmp_path):
    (tmp_path / "made.urdf").write_text(CHAIN)
    (tmp_path / "made.srdf").write_text(srdf(("base", "c")))
    text = """
[robot]
urdf = "made.urdf"
srdf = "made.srdf"
meshes = "capsule"
cylinders = "capsule"
[goal]
position = [3, 0, 0]
[lattice]
divisions = 4
"""
    (tmp_path / "one.toml").write_text(text)
    robot = fp.load_scenario(tmp_path / "one.toml").robot
    assert robot.disabled_pairs == (("base", "c"),)
    assert robot.containers == ("capsule", "capsule")
    (tmp_path / "one.toml").write_text(text.replace('cylinders = "capsule"', 'cylinders = "cap"'))
    with pytest.raises(fp.InvalidInput, match="cylinders"):
        fp.load_scenario(tmp_path / "one.toml")


SWEPT = urdf(
    link("bus", inertial(50.0, (5.0, 5.0, 5.0)) + box((1.0, 1.0, 1.0))),
    link("panel", inertial(5.0, (1.0, 1.0, 1.0)) + box((0.05, 2.0, 0.5))),
    link("mount", inertial(0.1, (0.01, 0.01, 0.01))),
    link("arm", inertial(2.0, (0.1, 0.1, 0.1)) + box((1.6, 0.1, 0.1), (0.8, 0, 0))),
    joint("bolt", "fixed", "bus", "panel", (0, 1.6, 0)),
    joint("plate", "fixed", "bus", "mount", (0.5, 0, 0)),
    joint("j", "revolute", "mount", "arm", (0, 0, 0)),
)


def test_an_arm_avoids_panels_on_fixed_joints():
    """A panel on a fixed joint belongs to the bus, and is still no neighbour of the arm."""
    robot = robot_from_urdf(SWEPT, "swept")
    assert planned_pairs(robot) == checked_pairs(robot) == {frozenset(("panel", "arm"))}
    begin, end = (robot.configuration(joints={"j": angle}) for angle in (1.0, 2.9))
    proof = fp.certify_edge(robot, fp.Scene(), begin, end)
    assert not proof.free
    assert {proof.link, proof.obstacle} == {"panel", "arm"}
    problem = fp.Problem(robot, fp.Scene(), begin, end, lattice=fp.Lattice(20))
    with pytest.raises(fp.NoPath, match="self-collision"):
        fp.plan(problem)


def test_links_that_touch_at_the_start_say_how_to_exempt_them():
    robot = robot_from_urdf(SWEPT, "swept")
    begin, end = (robot.configuration(joints={"j": angle}) for angle in (2.0, 0.0))
    problem = fp.Problem(robot, fp.Scene(), begin, end, lattice=fp.Lattice(20))
    with pytest.raises(fp.StartInCollision, match="links that are designed to touch in an SRDF"):
        fp.plan(problem)


def test_virtual_and_fixed_joints_in_a_state_are_ignored():
    text = """<robot name='made'>
      <virtual_joint name='float' type='floating' parent_frame='world' child_link='base'/>
      <passive_joint name='j3'/><end_effector name='tool' parent_link='c' group='g'/>
      <group_state name='home' group='g'>
        <joint name='float' value='0 0 0 0 0 0 1'/><joint name='j1' value='0.5'/>
      </group_state>
      <group_state name='away' group='g'><joint name='float' value='1'/></group_state></robot>"""
    assert robot_from_urdf(CHAIN, "made", srdf=text).postures == {"home": {"j1": 0.5}}
    with pytest.raises(fp.InvalidInput, match="group_state 'home', joint: got 'float'"):
        robot_from_urdf(CHAIN, "made", srdf=text.replace("<virtual_joint name='float'", "<x n='f'"))
    bolted = CHAIN.replace("name='j3' type='revolute'", "name='j3' type='fixed'")
    state = "<group_state name='n' group='g'><joint name='j3' value='1'/></group_state>"
    assert robot_from_urdf(bolted, "made", srdf=f"<robot>{state}</robot>").postures == {}
    assert robot_from_urdf(CHAIN, "made", srdf=f"<robot>{state}</robot>").postures == {
        "n": {"j3": 1.0}
    }


def states(*named):
    lines = (
        f"<group_state name='{name}' group='{group}'><joint name='{j}' value='{value}'/>"
        "</group_state>"
        for name, group, j, value in named
    )
    return f"<robot name='made'>{''.join(lines)}</robot>"


def test_states_of_one_name_contradict_one_another_nowhere():
    split = states(("a", "g", "j1", 1), ("a", "h", "j2", 2), ("a", "both", "j1", 1))
    robot = robot_from_urdf(CHAIN, "made", srdf=split)
    assert robot.postures == {"a": {"j1": 1.0, "j2": 2.0}}
    for text, message in {
        states(("a", "g", "j1", 1), ("a", "g", "j1", 2)): "'a': got 'two of them'; allowed: one",
        states(("a", "g", "j1", 1), ("a", "g", "j2", 1)): "'a': got 'two of them'; allowed: one",
        states(("a", "g", "j1", 1), ("a", "h", "j1", 2)): "'a', joint 'j1': got '1 and 2'",
    }.items():
        with pytest.raises(fp.InvalidInput, match=f"made, SRDF, group_state {message}"):
            robot_from_urdf(CHAIN, "made", srdf=text)
