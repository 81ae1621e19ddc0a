"""Plans of robots with all kinds of collision shapes: saved, verified, drawn."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.robots.collision_shapes import Containers
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.verification.distances.solid_distance_kernels import sphere_distances
from ffsr_plan.verification.separation import arrays_of
from ffsr_plan.verification.solids import Shape
from ffsr_plan.verification.urdf_reading import Bodies
from tests.helpers.single_link_robots import MASS, blob, inside_out, one_link
from tests.helpers.solid_distances import sphere_distance
from tests.helpers.urdf_builders import box, capsule, cylinder, inertial, joint, link, mesh, urdf

seeds = st.integers(0, 10_000)


def test_a_plan_keeps_what_its_cylinders_were_put_in(tmp_path):
    robot = one_link(cylinder(0.1, 0.5), containers=Containers(cylinders="capsule"))
    goal = robot.configuration((2, 0, 0))
    plan = fp.plan(fp.Problem(robot, fp.Scene([[1.0, 0.5, 0.0]], [0.1]), robot.neutral(), goal,
                              lattice=fp.Lattice(4)))  # fmt: skip
    plan.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded == plan
    assert loaded.problem.robot.containers == robot.containers
    assert loaded.problem.robot.replacements == robot.replacements
    assert loaded.verify(20).ok


def chain(folder):
    """A base with an arm of all kinds of shapes, whose forearm can reach the base."""
    blob(4).export(folder / "blob.stl")
    (folder / "arm.urdf").write_text(
        urdf(
            link("base", inertial(5.0, (1.0, 1.0, 1.0)), box((0.6, 0.4, 0.4))),
            link("upper", MASS, cylinder(0.05, 0.5, (0.3, 0, 0), (0, np.pi / 2, 0))),
            link("fore", MASS, capsule(0.05, 0.4, (0.3, 0, 0), (0, np.pi / 2, 0))),
            link("hand", MASS, mesh("blob.stl", (0.3, 0.3, 0.3), (0.15, 0, 0))),
            joint("shoulder", "revolute", "base", "upper", (0.4, 0, 0)),
            joint("elbow", "revolute", "upper", "fore", (0.65, 0, 0)),
            joint("wrist", "continuous", "fore", "hand", (0.65, 0, 0)),
        )
    )
    return folder / "arm.urdf"


@pytest.fixture(scope="module")
def arm_plan(tmp_path_factory):
    folder = tmp_path_factory.mktemp("arm")
    robot = fp.load_robot(chain(folder))
    start = robot.configuration(joints={"shoulder": 0.9, "elbow": 0.6})
    goal = robot.configuration((6, 0, 0), joints={"shoulder": -0.9, "elbow": 0.2, "wrist": 1.0})
    scene = fp.Scene([[3.0, 0.4, 0.1], [4.5, -0.9, 0.0]], [0.5, 0.3])
    problem = fp.Problem(robot, scene, start, goal, delta=0.5,
                         lattice=fp.Lattice(12, fp.Axis(6, 0.25)))  # fmt: skip
    plan = fp.plan(problem, fp.AntSystem(ants=8, cycles=3), 0)
    (folder / "blob.stl").unlink()
    return plan


def test_a_plan_of_all_kinds_of_shapes_verifies(arm_plan):
    report = arm_plan.verify(100)
    assert report.ok, report.problems
    assert report.clearance_error < 1e-9
    assert report.objective_error < 1e-9


def test_a_plan_loads_and_verifies_without_its_mesh_files(arm_plan, tmp_path):
    import json

    arm_plan.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded == arm_plan
    assert loaded.problem.robot.replacements == arm_plan.problem.robot.replacements
    assert loaded.verify(20).ok
    loaded.save(tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "plan.json").read_bytes()
    robot = json.loads((tmp_path / "plan.json").read_text())["problem"]["robot"]
    assert [r["shape"] for r in robot["replacements"]] == ["cylinder", "mesh blob.stl"]
    assert robot["replacements"][0]["excess"] == pytest.approx(0.05 * 0.0086, rel=1e-2)


@pytest.mark.parametrize(
    "change",
    [
        lambda replaced: replaced.clear(),
        lambda replaced: replaced.reverse(),
        lambda replaced: replaced[0].update(link="base"),
        lambda replaced: replaced[0].update(excess=0.0),
        lambda replaced: replaced[0].update(excess="0"),
        lambda replaced: replaced[0].update(by="capsule"),
        lambda replaced: replaced[1].pop("by"),
    ],
)
def test_a_plan_file_that_misstates_its_replacements_is_refused(arm_plan, tmp_path, change):
    from ffsr_plan.plans.plan_file import to_dict

    data = to_dict(arm_plan)
    assert fp.Plan.from_dict(data) == arm_plan
    change(data["problem"]["robot"]["replacements"])
    with pytest.raises(fp.InvalidInput, match="replacements"):
        fp.Plan.from_dict(data)


def test_verification_finds_a_replacement_that_is_too_small(arm_plan):
    robot = arm_plan.problem.robot
    for k, who in enumerate(("upper", "hand")):
        forged = list(robot.replacements)
        points = np.array(forged[k].points)
        small = points.mean(axis=0) + 0.99 * (points - points.mean(axis=0))
        forged[k] = forged[k]._replace(points=tuple(map(tuple, small.tolist())))
        bodies = Bodies(robot.urdf, robot.srdf, forged)
        assert bodies.uncovered(robot.meshes) == [who]
    assert Bodies(robot.urdf, robot.srdf, robot.replacements).uncovered(robot.meshes) == []
    problem = fp.Problem(
        replace(robot, replacements=tuple(forged)), arm_plan.problem.scene,
        arm_plan.problem.start, arm_plan.problem.goal, lattice=arm_plan.problem.lattice,
    )  # fmt: skip
    report = replace(arm_plan, problem=problem).verify(20)
    assert any("'hand' is not contained" in problem for problem in report.problems)


@given(seeds)
@settings(max_examples=30)
def test_hull_distances_of_verification_agree_with_trimesh(seed):
    solid = blob(seed)
    shape = Shape("", np.eye(4), np.array(solid.vertices))
    centers = solid.center_mass + np.random.default_rng(seed).normal(size=(40, 3)) * 0.3
    radii = np.linspace(0.01, 0.1, 40)
    poses = np.tile(np.eye(4), (300, 1, 1))
    poses[:, 0, 3] = np.linspace(-0.2, 0.2, 300)
    found = sphere_distance(shape, poses, centers, radii)
    true = inside_out(solid, centers - poses[7, :3, 3]) - radii
    assert np.allclose(found[7], true, atol=1e-9)
    order, still = np.arange(40), np.tile(np.eye(3), (1, 1, 1, 1))
    asked, ranges = np.zeros((40, 2), dtype=np.int64), np.column_stack([order, order + 1])
    compiled = sphere_distances(
        arrays_of([shape]), asked, still, poses[7:8, None, :3, 3], still[0], np.zeros((1, 3)),
        centers, radii, order, ranges,
    )  # fmt: skip
    inside = true + radii <= 0.0  # the centre lies in the hull: a lower bound will do
    assert np.allclose(compiled[~inside], true[~inside], atol=1e-9)
    assert np.all(compiled[inside] <= true[inside] + 1e-9)


def test_a_page_and_pictures_can_be_made_of_all_kinds_of_shapes(arm_plan, tmp_path):
    from ffsr_plan.display.figures import write_figures
    from ffsr_plan.display.plan_page import page

    assert page(arm_plan) == page(arm_plan)
    assert len(write_figures(arm_plan, tmp_path)) == 3


def test_links_without_visual_shapes_show_their_collision_shapes(tmp_path):
    """A visual capsule, or a mesh that is not there, takes no other shape with it."""
    visual = box((1, 1, 1)).replace("collision", "visual")
    lost = mesh("gone.stl").replace("collision", "visual")
    pill = capsule(0.1, 0.2).replace("collision", "visual")
    text = urdf(
        link("base", MASS, visual, pill, lost, box((1, 1, 1))),
        link("arm", MASS, lost, capsule(0.1, 0.3)),
        joint("j", "revolute", "base", "arm", (1, 0, 0)),
    )
    robot = robot_from_urdf(text, "made", [str(tmp_path)])
    assert [robot.link_of(g) for g in robot.visual_model.geometryObjects] == ["base"]
    import meshcat

    from ffsr_plan.display.scenes.meshcat_objects import CommandLog
    from ffsr_plan.display.scenes.scene_objects import add_robot

    log = CommandLog()
    add_robot(meshcat.Visualizer(window=log)["robot"], robot, robot.neutral())
    # a box in one part, a capsule in three; object and transform of each, and of each joint
    assert len(log.commands) == 2 * (1 + 3) + 2
