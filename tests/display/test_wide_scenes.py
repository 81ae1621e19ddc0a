"""Pages of scenes that are far wider than the motion: the robot is seen, and not too small."""

import json

import numpy as np
import pytest
from PIL import Image

import ffsr_plan as fp
from ffsr_plan.display.scenes.shown_space import shown_space
from tests.helpers import chromium

SCENES = {
    "zone of 60 m": fp.Scene(keep_in=[fp.Box([60, 60, 60])]),
    "boom": fp.Scene(shapes=[fp.Box([100, 4, 4], [0, 6, 0])]),
    "far box": fp.Scene(shapes=[fp.Box([1, 1, 1], [-50, -50, 0])]),
    "ten kilometres": fp.Scene(
        [[4000, 3000, 0]], [10], shapes=[fp.Box([5000, 9, 9], [0, 8, 0])], keep_in=[fp.Ball(5000)]
    ),
}
ROBOT = np.array([[-1.0, 0.0, 0.0], [6.0, 0.0, 0.0]]), np.ones(2)


@pytest.mark.parametrize("name", SCENES)
def test_the_motion_fills_much_of_what_is_shown(name):
    low, high = shown_space(SCENES[name], *ROBOT)
    assert np.all(low <= [-2.0, -1.0, -1.0])
    assert np.all(high >= [7.0, 1.0, 1.0])
    assert np.max(high - low) <= 2.0 * 9.0 + 1e-9


def test_what_is_near_is_shown_as_a_whole():
    near = fp.Scene([[0, 9, 0]], [1.0], shapes=[fp.Ball(2.0, [0, 0, -8.0])])
    low, high = shown_space(near, *ROBOT)
    assert (low[2], high[1]) == (-10.0, 10.0)


@pytest.mark.skipif(chromium.PROGRAM is None, reason="no Chromium on this machine")
@pytest.mark.parametrize("name", ["zone of 60 m", "ten kilometres"])
def test_the_page_of_a_wide_scene_shows_the_robot(name, tmp_path):
    robot = fp.load_robot("satellite_ur5")
    goal = robot.configuration((5.0, 0.0, 0.0))
    plan = fp.plan(fp.Problem(robot, SCENES[name], robot.neutral(), goal), until="first")
    plan.write_html(tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    begin = text.index("const data = ") + len("const data = ")
    view = json.JSONDecoder().raw_decode(text, begin)[0]["view"]
    folder = tmp_path / "browser"
    folder.mkdir()
    with chromium.opened((tmp_path / "page.html").as_uri(), folder) as tab:
        tab.wait_until("document.title.startsWith('ready')")
        reaches = tab.ask("viewer.camera.far - viewer.camera.position.length()")
        assert reaches > view["reach"]
        least = plan.certificate.least_clearance
        shown = tab.ask("document.querySelector('[data-name=clearance] .limit').textContent")
        assert 0.98 * least < float(shown.split()[3]) <= least  # what is proven is rounded down
        assert tab.ask("shortBelow(0.018296)") == "0.0182"
        pictures = []
        for shown in ("true", "false"):
            for node in ("robot", "ghosts"):
                tab.ask(f"viewer.set_property(['meshcat', '{node}'], 'visible', {shown})")
            tab.ask(
                "window.drawn = 0; viewer.set_dirty(); "
                "requestAnimationFrame(() => requestAnimationFrame(() => { window.drawn = 1; }))"
            )
            tab.wait_until("window.drawn === 1")
            tab.shoot(tmp_path / "page.png")
            pictures.append(np.asarray(Image.open(tmp_path / "page.png").convert("RGB"), int))
    robot_seen = np.abs(pictures[0] - pictures[1]).sum(axis=2) > 60
    assert robot_seen.mean() > 0.002
