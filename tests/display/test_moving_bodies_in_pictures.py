"""Pages, figures and movies draw bodies that move where they are at the time of each frame."""

import base64
import json
import re
from dataclasses import replace

import numpy as np
import pytest
import umsgpack
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import ffsr_plan as fp
from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pace import Pace
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core import rotations
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display import figures
from ffsr_plan.display.body_drawing import FreeRoom, TimedLabel, chosen_rows, timed_labels
from ffsr_plan.display.live.opening_page import opening_page
from ffsr_plan.display.plan_page import page
from ffsr_plan.display.scenes.body_tracks import body_tracks, key_rows, points_near
from ffsr_plan.display.scenes.plan_samples import sample_plan
from ffsr_plan.display.scenes.projection import view_axes
from ffsr_plan.display.scenes.shape_outlines import outline_of
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from tests.helpers import chromium
from tests.helpers.plan_past_bodies import BODIES, DURATION, data_of, plan_past_bodies

NAMES = ["body 0", "debris", "old satellite"]
in_a_browser = pytest.mark.skipif(chromium.PROGRAM is None, reason="no Chromium on this machine")


@pytest.fixture(scope="module")
def plan():
    return plan_past_bodies()


@pytest.fixture(scope="module")
def html(plan):
    return page(plan)


@pytest.fixture(scope="module")
def data(html):
    return data_of(html)


def commands(data):
    return [umsgpack.unpackb(base64.b64decode(each)) for each in data["commands"]]


def played(data, body, count):
    """Positions and attitudes that the page's player gives a body in all frames."""
    (animation,) = [c for c in commands(data) if c["type"] == "set_animation"]
    (clip,) = [a["clip"] for a in animation["animations"] if a["path"] == f"/meshcat/bodies/{body}"]
    found = {}
    for track in clip["tracks"]:
        rows = np.array([key["time"] for key in track["keys"]])
        values = np.array([key["value"] for key in track["keys"]])
        frames = np.arange(count)
        piece = np.clip(np.searchsorted(rows, frames, side="right") - 1, 0, len(rows) - 2)
        share = (frames - rows[piece]) / np.diff(rows)[piece]
        begin, end = values[piece], values[piece + 1]
        if track["name"].endswith("quaternion"):
            found["attitudes"] = rotations.slerp(begin, end, share)
        else:
            found["positions"] = begin + share[:, None] * (end - begin)
    assert clip["fps"] == pytest.approx((count - 1) / DURATION)
    return found["positions"], found["attitudes"]


def law_of_the_pace(time, ramp):
    """Share of the path that a trapezoid of speed has run, integrated."""
    times = np.linspace(0.0, time, 20001)
    speed = np.clip(np.minimum(times, 1.0 - times) / ramp, 0.0, 1.0) / (1.0 - ramp)
    return float(np.trapezoid(speed, times))


@pytest.mark.parametrize("ramp", [0.0, 0.2, 0.5])
def test_places_are_those_of_the_pace_at_their_times(ramp):
    pace = Pace(30.0, ramp, 7)
    places = np.linspace(0.0, 7.0, 71)
    assert np.allclose(pace.places(pace.instants(places)), places, atol=1e-12)
    for share in (0.1, 0.3, 0.5, 0.8, 0.95):
        expected = 7.0 * law_of_the_pace(share, max(ramp, 1e-9))
        assert float(pace.places(np.array(30.0 * share))) == pytest.approx(expected, abs=1e-3)


def test_a_page_plays_a_plan_with_a_duration_in_true_time(data, plan):
    axis = data["axis"]
    assert (axis["symbol"], axis["unit"], axis["title"]) == ("t", "s", "time [s]")
    assert axis["end"] == axis["seconds"] == DURATION
    count = len(data["base"])
    shares = [law_of_the_pace(k / (count - 1), 0.25) for k in range(0, count, 10)]
    expected = plan.at(np.clip(shares, 0.0, 1.0))[:, :7]
    assert np.allclose(data["base"][::10], expected, atol=1e-4)


@pytest.mark.parametrize("k", range(len(BODIES)))
def test_a_page_plays_bodies_where_their_motion_has_them(data, k):
    count = len(data["base"])
    poses = BODIES[k].poses(np.linspace(0.0, DURATION, count))
    positions, attitudes = played(data, k, count)
    assert np.abs(positions - poses.positions).max() < 2e-4
    assert np.max(rotations.angle_between(attitudes, poses.attitudes)) < 2e-3
    placed = {
        c["path"]: np.array(c["matrix"]) for c in commands(data) if c["type"] == "set_transform"
    }
    matrix = placed[f"/meshcat/bodies/{k}"].reshape(4, 4).T
    assert np.allclose(matrix[:3, 3], poses.positions[0])
    assert np.allclose(matrix[:3, :3], rotations.matrix(poses.attitudes[0]))


def test_the_mesh_of_a_body_is_along_its_own_axes(data):
    drawn = {c["path"]: c["object"] for c in commands(data) if c["type"] == "set_object"}
    for k, body in enumerate(BODIES):
        entry = drawn[f"/meshcat/bodies/{k}/shapes"]
        (geometry,) = entry["geometries"]
        packed = geometry["data"]["attributes"]["position"]["array"]
        raw = packed.data if hasattr(packed, "data") else packed
        points = np.frombuffer(bytes(raw), np.float32).reshape(-1, 3)
        (track,) = body_tracks(fp.Scene(bodies=[body]), np.array([0.0]))
        assert np.allclose([points.min(axis=0), points.max(axis=0)], track.box, atol=1e-6)
        (material,) = entry["materials"]
        assert material["color"] == 0xE07BB0


def test_the_clearance_of_a_page_is_that_from_all_obstacles_at_their_time(data, plan):
    problem, count = plan.problem, len(data["base"])
    samples = sample_plan(plan, count)
    (chart,) = [c for c in data["charts"] if c["name"] == "clearance"]
    rows = range(0, count, 7)
    expected = [
        fp.clearance(problem.robot, problem.scene.at(samples.times[row]), plan.at(s))
        for row, s in ((row, samples.parameters[row]) for row in rows)
    ]
    assert np.allclose(np.array(chart["curves"][0]["values"])[::7], expected, atol=2e-5)


def test_a_page_lists_how_near_each_body_comes_and_when(data, plan):
    samples = sample_plan(plan, len(data["base"]))
    assert [row["name"] for row in data["bodies"]] == NAMES
    assert [row["motion"] for row in data["bodies"]] == ["Spin", "Drift", "Tumble"]
    for row, body in zip(data["bodies"], BODIES, strict=True):
        scene = fp.Scene(bodies=[body])
        distances = [
            fp.clearance(plan.problem.robot, scene.at(time), plan.at(s))
            for time, s in zip(samples.times, samples.parameters, strict=True)
        ]
        assert row["least"] == pytest.approx(min(distances), abs=1e-4)
        assert row["time"] == pytest.approx(samples.times[int(np.argmin(distances))], abs=1e-3)


def test_clearances_count_beyond_the_least_one_that_is_kept(plan):
    kept = replace(plan, problem=replace(plan.problem, min_clearance=0.05))
    before, after = data_of(page(plan)), data_of(page(kept))
    values = [np.array(d["charts"][0]["curves"][0]["values"]) for d in (before, after)]
    assert np.allclose(values[1], values[0] - 0.05, atol=2e-5)
    for old, new in zip(before["bodies"], after["bodies"], strict=True):
        assert new["least"] == pytest.approx(old["least"] - 0.05, abs=2e-4)


def test_names_on_a_page_move_with_their_bodies(data):
    ways = {name["text"]: np.array(name["way"]) for name in data["names"] if "way" in name}
    assert list(ways) == NAMES
    times = np.linspace(0.0, DURATION, 9)
    for track in body_tracks(fp.Scene(bodies=BODIES), times):
        way = ways[track.name]
        at = np.column_stack([np.interp(times / DURATION, way[:, 0], way[:, k]) for k in (1, 2, 3)])
        assert np.linalg.norm(at - track.middles(), axis=1).max() < 0.06


def test_twenty_bodies_make_a_page_little_larger(plan, html):
    rng = np.random.default_rng(5)
    many = [
        MovingBody(
            [fp.Box(rng.uniform(0.1, 0.5, 3))],
            Tumble(
                (1, 2, 2.5), rng.normal(size=3) * 0.2, rng.normal(size=3) * 0.02, known_until=60
            ),
            rng.uniform(-4, 4, 3),
        )
        for _ in range(20)
    ]
    crowded = replace(plan, problem=replace(plan.problem, scene=fp.Scene(bodies=many)))
    alone = replace(plan, problem=replace(plan.problem, scene=fp.Scene()))
    assert len(page(crowded)) < 1.5 * len(page(alone))


def test_key_frames_are_few_and_tell_the_others():
    times = np.linspace(0.0, 100.0, 401)
    straight = np.column_stack([times, 2.0 * times, 0.0 * times])
    assert key_rows(straight).tolist() == [0, 400]
    half = rotations.exp(np.column_stack([0.0 * times, 0.0 * times, 0.02 * times]))
    assert len(key_rows(half)) == 2
    turns = rotations.exp(np.column_stack([0.0 * times, 0.0 * times, 0.5 * times]))
    assert 10 < len(key_rows(turns)) < 60
    corner = straight.copy()
    corner[200:, 1] = 150.0
    assert 200 in key_rows(corner)
    assert len(key_rows(np.random.default_rng(0).normal(size=(9, 3)))) == 9
    assert key_rows(straight[:2]).tolist() == [0, 1]


@pytest.mark.parametrize("view", ["path", "side"])
def test_a_flat_figure_has_each_body_at_the_times_of_its_shades(plan, view):
    figure = figures.path_figure(plan, 5, view=view, colours={"bodies": "#aa0044"})
    (ax,) = figure.axes
    axes = view_axes(plan.problem)[[0, 1] if view == "path" else [0, 2]]
    count = sum(len(body.shapes) for body in BODIES)
    drawn = [
        c
        for c in ax.collections
        if isinstance(c, PolyCollection)
        and len(c.get_edgecolor())
        and np.allclose(c.get_edgecolor()[:, :3], to_rgb("#aa0044"))
    ]
    assert len(drawn) == 5
    for collection, time in zip(drawn, np.linspace(0.0, DURATION, 5), strict=True):
        shapes = [shape for body in BODIES for shape in body.shapes_at(time)]
        assert len(collection.get_paths()) == count
        for path, shape in zip(collection.get_paths(), shapes, strict=True):
            outline = outline_of(shape, axes)
            assert np.allclose(path.vertices[: len(outline)], outline)
    light = [float(c.get_facecolor()[0, :3].sum()) for c in drawn]
    assert light == sorted(light, reverse=True)
    assert np.allclose(drawn[-1].get_facecolor()[0, :3], to_rgb("#aa0044"))
    (legend,) = figure.legends
    texts = [text.get_text() for text in legend.get_texts()]
    assert "moving bodies, light at 0 s, dark at 40 s" in texts


def test_a_figure_writes_the_times_at_the_robot_and_at_the_bodies(plan):
    (ax,) = figures.path_figure(plan, 5).axes
    base = {t.get_text(): np.array(t.xy) for t in ax.texts if t.get_color() == "black"}
    assert list(base) == ["0 s", "10 s", "20 s", "30 s", "40 s"]
    view = view_axes(plan.problem)[:2]
    shares = [law_of_the_pace(share, 0.25) for share in (0.25, 0.5)]
    assert np.allclose(base["10 s"], view @ plan.at(shares[0])[:3], atol=1e-3)
    assert np.allclose(base["20 s"], view @ plan.at(shares[1])[:3], atol=1e-3)
    own = [t for t in ax.texts if t.get_color() == "#c2528b"]
    (first,) = [t for t in own if t.get_text().startswith("debris\n")]
    assert np.allclose(first.xy, view @ BODIES[1].position)
    assert {t.get_text().split("\n")[0] for t in own if "\n" in t.get_text()} == set(NAMES)


def test_labels_of_a_body_are_at_it_at_their_times():
    times = np.linspace(0.0, DURATION, 5)
    spun, drifted, _ = body_tracks(fp.Scene(bodies=BODIES), times)
    labels = timed_labels(drifted, range(5), np.eye(3), 5.0)
    assert [label.text for label in labels] == ["debris\n0 s", "10 s", "20 s", "30 s", "40 s"]
    expected = BODIES[1].poses(times).positions
    assert np.allclose([label.at for label in labels], expected)
    for label, turn in zip(
        timed_labels(spun, range(5), np.eye(3), 5.0), rotations.matrix(spun.attitudes), strict=True
    ):
        tip = (label.at - BODIES[0].position) @ turn  # along the body's own axes
        assert np.allclose(tip, [0.7, 0.0, 0.0], atol=0.02)
    together = timed_labels(drifted, range(5), np.eye(3), 100.0)
    assert [label.text for label in together] == ["debris\n0, 10, 20, 30, 40 s"]


@pytest.mark.parametrize(
    ("count", "expected"),
    [(2, [0, 1]), (3, [0, 1, 2]), (6, [0, 1, 2, 4, 5]), (7, [0, 2, 4, 6]), (9, [0, 2, 4, 6, 8])],
)
def test_bodies_are_drawn_at_some_of_the_silhouettes_times(count, expected):
    assert chosen_rows(range(count)) == expected


def test_labels_hide_no_other_label():
    room = FreeRoom(10.0)
    first = TimedLabel("0 s", np.zeros(2))
    assert np.array_equal(room.place(first), [0.0, 0.0])
    assert room.place(first) is None
    beside = room.place(first, aside=True)
    assert beside is not None
    assert np.linalg.norm(beside) > 0.1
    assert room.place(TimedLabel("1 s", np.array([3.0, 0.0]))) is not None


def test_the_figure_in_perspective_holds_the_bodies_at_several_times(plan):
    with_bodies = figures.path_figure(plan, 3, view="3d")
    still = replace(plan, problem=replace(plan.problem, scene=plan.problem.scene.at_rest))
    without = figures.path_figure(still, 3, view="3d")
    (ax,), (bare,) = with_bodies.axes, without.axes
    (solids,), (others,) = ax.collections, bare.collections
    assert len(solids._faces) > len(others._faces) + 3 * 5 * 12
    corners = np.concatenate([np.asarray(face) for face in solids._faces])
    corners = corners[np.all(np.abs(corners) < 50.0, axis=1)]  # triangles are filled up to four
    for time in (0.0, 20.0, 40.0):
        (place,) = BODIES[1].poses([time]).positions
        assert np.sum(np.abs(np.linalg.norm(corners - place, axis=1) - 0.2) < 1e-9) > 100
    texts = [text.get_text() for text in ax.texts]
    assert {"0 s", "20 s", "40 s", "debris\n0 s"} <= set(texts)
    assert not any(text.endswith(" s") for text in (t.get_text() for t in bare.texts))


def test_the_figure_of_clearances_is_over_time_and_counts_bodies(plan):
    (ax,) = figures.clearance_figure(plan, 6).axes
    assert ax.get_xlabel() == "time [s]"
    curve, nodes = ax.lines[:2]
    times, found = curve.get_data()
    assert times[-1] == DURATION
    s = np.linspace(0.0, 1.0, len(times))
    for k in range(0, len(s), 5):
        assert law_of_the_pace(times[k] / DURATION, 0.25) == pytest.approx(s[k], abs=1e-4)
        scene = plan.problem.scene.at(times[k])
        assert found[k] == pytest.approx(fp.clearance(plan.problem.robot, scene, plan.at(s[k])))
    assert np.allclose(nodes.get_xdata(), times[::6])
    assert np.allclose(nodes.get_ydata(), found[::6], atol=1e-6)


def test_axes_without_a_duration_are_the_path_parameter(fig2a_plan):
    (ax,) = figures.clearance_figure(fig2a_plan).axes
    assert ax.get_xlabel() == "path parameter s"
    assert data_of(page(fig2a_plan))["axis"]["symbol"] == "s"
    assert data_of(page(fig2a_plan))["bodies"] == []


def test_a_body_counts_in_a_picture_only_where_it_is_near():
    times = np.linspace(0.0, 100.0, 101)
    comet = MovingBody([fp.Ball(0.1)], Drift((10.0, 0.0, 0.0)), (-500.0, 0.5, 0.0))
    tracks = body_tracks(fp.Scene(bodies=[comet]), times)
    cloud = np.array([[0.0, 0.0, 0.0], [8.0, 1.0, 0.0]])
    points = points_near(tracks, cloud, np.eye(3))
    assert len(points)
    assert points[:, 0].min() >= -4.0
    assert points[:, 0].max() <= 12.0
    far = replace_position(comet, (-500.0, 50.0, 0.0))
    assert not len(points_near(body_tracks(fp.Scene(bodies=[far]), times), cloud, np.eye(3)))


def replace_position(body, position):
    return MovingBody(body.shapes, body.motion, position)


def test_a_body_that_turns_too_often_for_a_page_is_refused(plan):
    body = MovingBody([fp.Ball(0.2)], Spin((0, 0, 100.0)), (0.0, 3.0, 0.0), name="top")
    whirl = replace(plan, problem=replace(plan.problem, scene=fp.Scene(bodies=[body])))
    with pytest.raises(InvalidInput, match=r"turn of the body 'top'.*at most 2000 rad"):
        page(whirl)


def test_no_body_turns_far_between_two_frames_of_a_page(plan):
    body = MovingBody([fp.Ball(0.2)], Spin((0, 0, 9.0)), (0.0, 3.0, 0.0))
    whirl = replace(plan, problem=replace(plan.problem, scene=fp.Scene(bodies=[body])))
    count = len(data_of(page(whirl))["base"])
    assert 9.0 * DURATION / (count - 1) <= 0.5


def test_a_live_view_has_bodies_at_the_start_and_says_when_they_are_elsewhere(plan):
    data = data_of(opening_page(plan.problem, LayeredLattice(plan.problem), ""))
    assert data["subtitle"].endswith("moving bodies at 0 s, faint at 13.3, 26.7, 40 s")
    placed = {
        c["path"]: np.array(c["matrix"]).reshape(4, 4).T
        for c in commands(data)
        if c["type"] == "set_transform"
    }
    for k, body in enumerate(BODIES):
        poses = body.poses(DURATION * np.arange(4) / 3)
        paths = [f"{k}", *(f"later/{k}/{row}" for row in (20, 40, 60))]
        found = [placed[f"/meshcat/bodies/{path}"][:3, 3] for path in paths]
        assert np.allclose(found, poses.positions)


def test_figures_of_bodies_can_be_drawn_on_given_axes(plan):
    figure = Figure()
    left, right = figure.subplots(1, 2)
    assert figures.path_figure(plan, ax=right) is figure
    assert not left.collections
    labels = [text.get_text() for text in right.get_legend().get_texts()]
    assert any(re.match("moving bodies, light at 0 s", label) for label in labels)


@in_a_browser
@pytest.mark.slow
def test_bodies_move_on_the_page_in_a_browser(html, tmp_path):
    (tmp_path / "plan.html").write_text(html, encoding="utf-8")
    place = "JSON.stringify(viewer.scene_tree.find(['meshcat', 'bodies', '1']).object.position)"
    with chromium.opened((tmp_path / "plan.html").as_uri(), tmp_path / "browser") as tab:
        tab.wait_until("document.title.startsWith('ready')")
        for time in (0.0, 10.0, 40.0):
            tab.ask(f"halt({time / DURATION})")
            found = list(json.loads(tab.ask(place)).values())[:3]
            assert np.allclose(found, BODIES[1].poses([time]).positions[0], atol=1e-3)
        tab.ask("byId('bodies').rows[1].onclick()")
        at = data_of(html)["bodies"][0]["time"]
        assert tab.ask("position") == pytest.approx(at / DURATION)
        assert tab.ask("byId('bodies').rows.length") == 1 + len(BODIES)
