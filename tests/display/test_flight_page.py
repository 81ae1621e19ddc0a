"""The page of a flight plays in true time, with plots, views and names that follow."""

import json
import re
import time

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.display.motion_page import obstacle_names
from tests.helpers import chromium
from tests.helpers.picture_measures import colours_and_edges

in_a_browser = pytest.mark.skipif(chromium.PROGRAM is None, reason="no Chromium on this machine")


@pytest.fixture(scope="module")
def file(flight, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "flight.html"
    flight.write_html(path, "the title")
    return path


@pytest.fixture(scope="module")
def data(file):
    text = file.read_text(encoding="utf-8")
    return json.JSONDecoder().raw_decode(text, text.index("const data = ") + len("const data = "))[
        0
    ]


@pytest.fixture(scope="module")
def tab(file, tmp_path_factory):
    with chromium.opened(file.as_uri(), tmp_path_factory.mktemp("browser")) as tab:
        tab.wait_until("document.title.startsWith('ready')")
        yield tab


def test_the_axis_is_the_true_time(data, flight):
    axis = data["axis"]
    assert (axis["symbol"], axis["unit"], axis["title"]) == ("t", "s", "time [s]")
    assert axis["end"] == axis["seconds"] == flight.duration
    assert axis["speed"] == 5  # at 2 the flight would take more than a minute


def test_the_plots_hold_the_quantities_of_the_flight(data, flight):
    charts = {chart["name"]: chart for chart in data["charts"]}
    units = {name: chart["unit"] for name, chart in charts.items()}
    assert units == {
        "speed": "m/s", "thrust": "mm/s²", "joints": "rad/s", "attitude": "°", "clearance": "m",
    }  # fmt: skip
    assert charts["thrust"]["limits"] == pytest.approx([10.0])
    assert charts["joints"]["limits"] == [0.5]
    times = np.linspace(0.0, flight.duration, len(data["base"]))
    states = flight.at(times)
    assert np.allclose(data["base"], states.configurations[:, :7], atol=1e-5)
    names = [curve["label"] for curve in charts["joints"]["curves"]]
    rates = np.transpose([curve["values"] for curve in charts["joints"]["curves"]])
    assert names == list(flight.motion.robot.joint_names)
    assert np.allclose(rates, states.joint_velocities, atol=1e-6)
    speed = np.linalg.norm(states.base_velocity, axis=1)
    assert np.allclose(charts["speed"]["curves"][0]["values"], speed, rtol=1e-4, atol=1e-9)


def test_the_same_flight_gives_the_same_page_and_it_loads_nothing(file, flight, tmp_path):
    flight.write_html(tmp_path / "again.html", "the title")
    text = file.read_text(encoding="utf-8")
    assert (tmp_path / "again.html").read_text(encoding="utf-8") == text
    assert not re.search(r"https?://|fetch\(|import\(", text[text.rindex("<script>") :])


def test_a_served_page_is_that_of_the_file(flight):
    with flight.show(block=False, open_browser=False, title="served") as server:
        assert "served" in server.page().decode()


def test_obstacles_have_the_names_of_their_sources_and_numbers_without():
    centers = [[float(k), 0.0, 0.0] for k in range(40)]
    alone = fp.Scene(centers[:2], [0.1] * 2, sources=[("mast", 1), ("dish", 1)])
    assert [name["text"] for name in obstacle_names(alone)] == ["mast", "dish"]
    assert obstacle_names(alone)[1]["at"] == centers[1]
    assert [name["text"] for name in obstacle_names(fp.Scene(centers[:2], [0.1] * 2))] == ["0", "1"]
    (station,) = obstacle_names(fp.Scene(centers, [0.1] * 40, sources=[("station", 40)]))
    assert station == {"text": "station", "at": [19.5, 0.0, 0.0]}
    assert obstacle_names(fp.Scene(centers, [0.1] * 40)) == []


@in_a_browser
@pytest.mark.slow
def test_the_plots_follow_the_slider(tab, data, flight):
    tab.ask("byId('time').value = 0.25; byId('time').oninput()")
    state = f"{0.25 * flight.duration:.0f} / {flight.duration:.0f} s"
    assert tab.ask("byId('state').textContent") == state
    values = data["charts"][0]["curves"][0]["values"]
    expected = np.interp(0.25 * (len(values) - 1), np.arange(len(values)), values)
    read = "document.querySelector('[data-name=speed] output').textContent"
    assert float(tab.ask(read)) == pytest.approx(expected, abs=1e-3)
    assert tab.ask("document.querySelector('[data-name=joints] .now').getAttribute('x1')") == "250"
    assert (
        tab.ask("[...byId('ticks').children].map(t => t.textContent).join()") == "0,50,100,150,200"
    )


@in_a_browser
@pytest.mark.slow
def test_playing_takes_true_time_divided_by_the_speed_and_pauses(tab, flight):
    tab.ask("halt(0); byId('speed').value = '5'; byId('play').click()")
    tab.wait_until("position > 0")
    position, began = tab.ask("position"), time.monotonic()
    time.sleep(2.0)
    played, took = tab.ask("position") - position, time.monotonic() - began
    assert played * flight.duration == pytest.approx(5.0 * took, rel=0.5)
    tab.ask("byId('play').click()")
    stopped = tab.ask("position")
    time.sleep(0.5)
    assert tab.ask("position") == stopped


@in_a_browser
@pytest.mark.slow
def test_a_loop_begins_anew_at_the_end_and_without_it_the_motion_stops_there(tab):
    tab.ask("byId('loop').checked = true; halt(0.995); byId('speed').value = '5'; play(true)")
    tab.wait_until("position < 0.9")
    assert tab.ask("playing")
    tab.ask("byId('loop').checked = false; halt(0.995); play(true)")
    tab.wait_until("!playing")
    assert tab.ask("position") == 1


@in_a_browser
@pytest.mark.slow
def test_named_views_look_from_their_sides(tab):
    tab.ask("halt(0)")
    away = "viewer.camera.position.clone().sub(viewer.controls.target).normalize().toArray().join()"
    for name, expected in (("top", (0, 1, 0)), ("side", (0, 0, 1)), ("front", (1, 0, 0))):
        tab.ask(f"document.querySelector('[data-view={name}]').click()")
        seen = [float(x) for x in tab.ask(away).split(",")]
        assert np.allclose(seen, expected, atol=1e-3)  # y is upwards there
        assert tab.ask("document.querySelector('#views .on').textContent") == name


@in_a_browser
@pytest.mark.slow
def test_the_camera_follows_the_base_and_rides_on_it(tab, flight):
    tab.ask("halt(0); choose('top'); follow.click()")
    before = np.array(json.loads(tab.ask("JSON.stringify(viewer.controls.target.toArray())")))
    tab.ask("halt(1)")
    after = np.array(json.loads(tab.ask("JSON.stringify(viewer.controls.target.toArray())")))
    moved = flight.at([0.0, flight.duration]).configurations[:, :3]
    assert np.linalg.norm(after - before) == pytest.approx(
        np.linalg.norm(moved[1] - moved[0]), 1e-3
    )
    tab.ask("follow.click(); choose('body')")
    tab.wait_until("document.querySelector('#views .on').textContent === 'body'")
    side = "viewer.camera.position.clone().sub(viewer.controls.target).toArray()"
    ends = []
    for share in (0, 1):
        tab.ask(f"halt({share})")
        ends.append(json.loads(tab.ask(f"JSON.stringify({side})")))
    angle = np.arctan2(*np.array(ends)[:, [2, 0]].T)
    turned = np.degrees(np.abs((angle[1] - angle[0] + np.pi) % (2 * np.pi) - np.pi))
    assert turned == pytest.approx(17.6, abs=0.2)  # as the base has


@in_a_browser
@pytest.mark.slow
def test_names_axes_and_scale_are_where_the_camera_sees_them(tab, flight, tmp_path):
    tab.ask("halt(0.5); choose('top')")
    time.sleep(1.0)
    place = "(() => {const r = byId('names').children[%d].getBoundingClientRect();"
    place += " return r.x + r.width / 2})()"
    pixels = tab.ask(place % 4) - tab.ask(place % 5)
    centers = flight.problem.scene.centers
    per_metre = pixels / (centers[4] - centers[5])[0]
    scale = float(tab.ask("byId('compass').dataset.scale").removesuffix(" m"))
    assert 40.0 < scale * per_metre < 130.0  # the length of the bar
    tab.ask("byId('named').click()")
    assert tab.ask("byId('names').hidden")
    tab.ask("byId('named').click()")
    tab.shoot(tmp_path / "shot.png")
    colours, edges = colours_and_edges(tmp_path / "shot.png")
    assert colours > 2000
    assert 0.005 < edges < 0.2


@in_a_browser
@pytest.mark.slow
def test_the_address_opens_the_page_at_a_time_and_a_view(file, flight, tmp_path):
    half = 0.5 * flight.duration
    with chromium.opened(f"{file.as_uri()}#t={half}&view=side&follow=1", tmp_path) as tab:
        tab.wait_until("document.title.startsWith('ready')")
        assert tab.ask("position") == pytest.approx(0.5, abs=1e-3)
        assert tab.ask("document.querySelector('#views .on').textContent") == "side"
        assert tab.ask("follow.checked")
