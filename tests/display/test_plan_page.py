"""The page of a plan is complete, reproducible and not blank."""

import base64
import json
import re
import subprocess

import numpy as np
import pytest
import umsgpack

import ffsr_plan as fp
from ffsr_plan.display import figures
from ffsr_plan.display.plan_page import page
from ffsr_plan.display.scenes.picture_data import motion_frames, near_track
from tests.helpers import chromium
from tests.helpers.picture_measures import colours_and_edges

CHROMIUM = chromium.PROGRAM
in_a_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")
FLAGS = [*chromium.FLAGS, "--virtual-time-budget=4000"]
SCENE = slice(140, 560), slice(0, 940)  # rows and columns between the panels


@pytest.fixture(scope="module")
def html(fig2a_plan):
    return page(fig2a_plan, "the title")


def unpacked(command):
    return umsgpack.unpackb(base64.b64decode(command))


def browse(folder, *arguments):
    """What the browser prints; its files lie in a folder."""
    command = [CHROMIUM, *FLAGS, f"--user-data-dir={folder / 'profile'}", *arguments]
    return subprocess.run(command, check=True, capture_output=True, timeout=120, text=True).stdout


def test_the_page_loads_nothing_from_the_network(html):
    markup = re.sub(r"<script>.*?</script>", "", html, flags=re.S)
    assert not re.search(r"(src|href)\s*=", markup)
    assert html.count("</script>") == 2
    own = html[html.rindex("<script>") :]
    assert not re.search(r"https?://|ws://|fetch\(|import\(", own)


def test_the_same_plan_gives_the_same_page(fig2a_plan, html):
    assert page(fig2a_plan, "the title") == html


def test_a_title_cannot_break_out_of_the_page(fig2a_plan):
    assert "</script><b>" not in page(fig2a_plan, "</script><b>")


@in_a_browser
@pytest.mark.slow
def test_the_robot_moves_on_the_page_in_a_browser(html, tmp_path):
    (tmp_path / "plan.html").write_text(html, encoding="utf-8")
    shots = []
    for s in ("0.1", "0.6"):
        shot = tmp_path / f"{s}.png"
        browse(tmp_path, f"--screenshot={shot}", f"file://{tmp_path}/plan.html#s={s}")
        shots.append(shot)
        colours, edges = colours_and_edges(shot, SCENE)
        assert colours > 2000
        assert 0.005 < edges < 0.2
    assert shots[0].read_bytes() != shots[1].read_bytes()
    dom = browse(tmp_path, "--dump-dom", f"file://{tmp_path}/plan.html")
    assert "<title>ready: the title</title>" in dom


@in_a_browser
@pytest.mark.slow
def test_a_page_without_a_scene_would_be_noticed(html, tmp_path):
    """What the test above relies on: an empty scene has few colours."""
    commands = re.search(r'"commands": (\[.*?\])', html, flags=re.S)[1]
    settings = [c for c in json.loads(commands) if unpacked(c)["type"] == "set_property"]
    empty = html.replace(commands, json.dumps(settings))
    empty = re.sub(r'"names": \[.*?\}\]', '"names": []', empty, count=1)
    (tmp_path / "plan.html").write_text(empty, encoding="utf-8")
    browse(tmp_path, f"--screenshot={tmp_path / 'shot.png'}", f"file://{tmp_path}/plan.html")
    colours, _ = colours_and_edges(tmp_path / "shot.png", SCENE)
    assert colours < 1000


def test_a_scene_without_obstacles_can_be_drawn_too(point, tmp_path):
    lattice = fp.Lattice(4, fp.Axis(1, 0.5))
    start, goal = point.configuration(), point.configuration((4, 0, 0))
    plan = fp.plan(fp.Problem(point, fp.Scene(), start, goal, lattice=lattice))
    assert "no obstacle" in page(plan)
    (subtitle,) = re.findall(r'"subtitle": "(.*?)"', page(plan))
    assert subtitle.endswith("no obstacles")
    assert "inf" not in subtitle
    figures.write_figures(plan, tmp_path)


def test_thousands_of_spheres_need_few_triangles():
    """Near ones solid, the others faint; each sphere once, where it is."""
    plan = fp.plan(fp.load_scenario("debris"), fp.LatticeOptimum(), refine=False)
    scene = plan.problem.scene
    frames = motion_frames(plan.problem.robot, plan.at(np.linspace(0.0, 1.0, 321)))
    near = near_track(scene, frames.bounding_spheres()[0], 0.8)
    text = re.search(r'"commands": (\[.*?\])', page(plan), flags=re.S)[1]
    commands = [unpacked(c) for c in json.loads(text)]
    drawn = {
        c["path"]: c["object"]
        for c in commands
        if c["type"] == "set_object" and c["object"]["object"]["type"] == "InstancedMesh"
    }
    assert sorted(drawn) == ["/meshcat/obstacles/far", "/meshcat/obstacles/near"]
    triangles = 0
    for path, chosen in (("far", ~near), ("near", near)):
        entry = drawn[f"/meshcat/obstacles/{path}"]
        count = entry["object"]["count"]
        placed = np.reshape(entry["object"]["instanceMatrix"]["array"], (count, 4, 4))
        assert np.allclose(placed[:, 3, :3], scene.centers[chosen], atol=1e-6)
        assert np.allclose(placed[:, 0, 0], scene.radii[chosen], atol=1e-6)
        (ball,) = entry["geometries"]
        triangles += 2 * count * ball["widthSegments"] * ball["heightSegments"]
    assert 0 < np.count_nonzero(near) < 500
    assert triangles < 300_000
