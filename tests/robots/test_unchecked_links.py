"""Links with visual shapes only: refused, taken or left out as asked, and named everywhere."""

import warnings

import numpy as np
import pytest
from rich.console import Console

import ffsr_plan as fp
from ffsr_plan.cli.printed_tables import plan_table, robot_table
from ffsr_plan.display.plan_page import page
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.robots.summary import summary
from tests.helpers.urdf_builders import box, inertial, joint, link, urdf

MASS = inertial(2.0, (0.1, 0.2, 0.25))
SEEN = box((0.3, 0.3, 0.3), (0.2, 0, 0)).replace("collision", "visual")


def robot_text(shape=SEEN):
    base = link("base", inertial(20.0, (2.0, 2.0, 2.0)), box((0.8, 0.8, 0.8)))
    return urdf(base, link("arm", MASS, shape), joint("j", "revolute", "base", "arm", (1, 0, 0)))


@pytest.fixture
def path(tmp_path):
    (tmp_path / "seen.urdf").write_text(robot_text())
    return tmp_path / "seen.urdf"


BALL = fp.Scene([[1.2, 0.0, 0.0]], [0.05])  # inside what is seen of the arm


def test_visual_shapes_without_collision_shapes_are_refused_by_name(path):
    with pytest.raises(fp.InvalidInput, match=r"seen, link 'arm'.*='visual' takes.*='ignore'"):
        fp.load_robot(path)
    with pytest.raises(fp.InvalidInput, match="link 'arm'"):
        fp.compose(fp.Bus((1, 1, 1), 50.0), [fp.Mount(path)])
    with pytest.raises(fp.InvalidInput, match=r"collision: got 'visuals'.*did you mean 'visual'"):
        fp.load_robot(path, collision="visuals")


def test_visual_shapes_are_collision_shapes_when_asked_for(path):
    robot = fp.load_robot(path, collision="visual")
    assert robot.unchecked_links == ()
    assert fp.clearance(robot, BALL, robot.neutral()) < -0.1
    arm = fp.Mount(path, (0.5, 0, 0), collision="visual")
    satellite = fp.compose(fp.Bus((1, 1, 1), 50.0), [arm])
    assert "arm_0" in [shape.name for shape in satellite.collision_model.geometryObjects]


def test_ignored_links_are_named_wherever_results_are_shown(path, tmp_path):
    robot = fp.load_robot(path, collision="ignore")
    assert robot.unchecked_links == ("arm",)
    assert "arm" in robot._repr_html_().split("not checked")[1]
    assert fp.clearance(robot, BALL, robot.neutral()) > 0.0
    start, goal = (robot.configuration((0, y, 0)) for y in (-0.1, 0.1))
    plan = fp.plan(fp.Problem(robot, fp.Scene(), start, goal, lattice=fp.Lattice(4)))
    assert plan.certificate.unchecked_links == ("arm",)
    report = plan.verify(samples=5)
    assert report.unchecked == ("arm",)
    assert any("arm" in sentence for sentence in report.not_checked)
    console = Console(width=160, record=True, file=open(tmp_path / "out", "w"))  # noqa: SIM115
    console.print(plan_table("", plan, report, 1.0))
    console.print(robot_table([summary(robot)]))
    text = console.export_text()
    assert "not checked, no shape" in text
    assert "links not checked" in text
    assert "not checked: arm" in text
    assert "links not checked: arm" in page(plan)
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json").certificate == plan.certificate


def test_scenarios_say_what_becomes_of_such_links(path):
    text = "[robot]\nurdf = 'seen.urdf'\n{}\n[goal]\nposition = [1, 0, 0]\n"
    text += "[lattice]\ndivisions = 4\nlateral = {{spacing = 0.5, half_count = 1}}\n"
    scenario = path.with_name("s.toml")
    for line, unchecked in (("collision = 'ignore'", ("arm",)), ("collision = 'visual'", ())):
        scenario.write_text(text.format(line))
        assert fp.load_scenario(scenario).robot.unchecked_links == unchecked
    scenario.write_text(text.format(""))
    with pytest.raises(fp.InvalidInput, match="link 'arm'"):
        fp.load_scenario(scenario)


def test_ignored_links_of_an_arm_stay_visible_on_a_satellite(path):
    satellite = fp.compose(fp.Bus((1, 1, 1), 50.0), [fp.Mount(path, collision="ignore")])
    assert satellite.unchecked_links == ("arm",)
    assert "arm_0" in [shape.name for shape in satellite.visual_model.geometryObjects]


def test_links_with_mass_and_no_shape_warn_once_with_all_names(path):
    second = link("b", MASS) + joint("k", "revolute", "arm", "b", (1, 0, 0))
    path.write_text(robot_text("").replace("</robot>", second + "</robot>"))
    with pytest.warns(fp.UncheckedLinks, match="seen: no shape.* links 'arm', 'b'") as caught:
        robot = fp.load_robot(path)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert robot.unchecked_links == ("arm", "b")
    with pytest.warns(
        fp.UncheckedLinks, match="link 'p_arm', 'p_b'|links 'p_arm', 'p_b'"
    ) as caught:
        fp.compose(fp.Bus((1, 1, 1), 50.0), [fp.Mount(path, prefix="p_")])
    assert caught[0].filename == __file__


def test_bundled_robots_load_without_a_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in fp.robot_names():
            assert fp.load_robot(name).unchecked_links == ()


def test_a_robot_with_all_its_shapes_has_no_unchecked_links():
    robot = robot_from_urdf(robot_text(box((0.3, 0.3, 0.3))), "made")
    assert robot.unchecked_links == ()
    assert np.isfinite(fp.clearance(robot, BALL, robot.neutral()))
