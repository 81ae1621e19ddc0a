"""A colony that is watched does what it would do alone, and what is drawn is what it does."""

import base64
import json
import threading
import urllib.request
from contextlib import contextmanager
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import umsgpack
from PIL import Image

import ffsr_plan as fp
from ffsr_plan.display import live_view
from ffsr_plan.display.cycle_snapshot import commands, take
from ffsr_plan.display.page import page
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from tests.helpers import chromium

in_a_browser = pytest.mark.skipif(chromium.PROGRAM is None, reason="no Chromium on this machine")


@pytest.fixture(scope="module")
def problem(point):
    """Two axes on demand: few nodes a layer, so that pheromone lies on edges."""
    start, goal = point.configuration(), point.configuration((4.0, 0.0, 0.0))
    scene = fp.Scene([[2.0, 0.1, 0.0]], [0.3])
    lattice = fp.Lattice(8, fp.Axis(3, 0.2))
    return fp.Problem(point, scene, start, goal, lattice=lattice, delta=0.1)


@pytest.fixture(scope="module")
def wide_problem(point):
    """121 nodes a layer, so that pheromone lies on nodes."""
    start, goal = point.configuration(), point.configuration((4.0, 0.0, 0.0))
    scene = fp.Scene([[2.0, 0.1, 0.0]], [0.3])
    lattice = fp.Lattice(8, fp.Axis(5, 0.2), fp.Axis(5, 0.2))
    return fp.Problem(point, scene, start, goal, lattice=lattice, delta=0.1)


@pytest.fixture(scope="module")
def turning_problem(robot):
    """Base offsets and a posture axis."""
    lattice = fp.Lattice(
        6, fp.Axis(2, 0.2), postures=[fp.PostureAxis({"left_2": 1.0, "right_2": 1.0}, 2, 0.3)]
    )
    goal = robot.configuration((3.0, 0.0, 0.0))
    scene = fp.Scene([[1.5, 1.9, 0.0]], [0.3])
    return fp.Problem(robot, scene, robot.neutral(), goal, lattice=lattice)


@pytest.fixture
def view(problem):
    with fp.LiveView(problem, open_browser=False) as view:
        yield view


def cycles_of(problem, planner=None):
    """All cycles of a colony, with their pheromone as it was."""
    seen = []
    fp.plan(problem, planner, on_cycle=lambda c: seen.append(c._replace(pheromone=c.pheromone + 0)))
    return seen


@contextmanager
def listening(url):
    """The messages that arrive, as they arrive."""
    heard = []

    def listen():
        for line in answer:
            if line.startswith(b"data: "):
                heard.append(json.loads(line[6:]))

    with urllib.request.urlopen(f"{url}events", timeout=60) as answer:
        thread = threading.Thread(target=listen)
        thread.start()
        try:
            yield heard
        finally:
            thread.join(60)  # ends with the server


def unpacked(packed):
    return {c["path"]: c for c in (umsgpack.unpackb(base64.b64decode(p)) for p in packed)}


def middles(command):
    """(k, 3) middles of the ends at which the quads of a ribbon begin, and where they end."""
    (mesh,) = command["object"]["geometries"]
    data = mesh["data"]["attributes"]["position"]["array"].data
    corners = np.frombuffer(data, dtype=np.float32).reshape(-1, 4, 3)
    return corners[:, :2].mean(axis=1), corners[:, 2:].mean(axis=1)


@pytest.mark.parametrize("planner", [fp.AntSystem(cycles=30), fp.MaxMinAntSystem(cycles=60)])
@pytest.mark.parametrize("name", ["problem", "wide_problem"])
def test_plans_are_the_same_watched_or_not(request, planner, name):
    problem = request.getfixturevalue(name)
    view = fp.LiveView(problem, open_browser=False)
    with listening(view.url) as heard, view:
        watched = fp.plan(problem, planner, 3, on_cycle=view.on_cycle)
    assert watched == fp.plan(problem, planner, 3)
    assert heard[-1]["number"] <= planner.cycles


def test_plans_with_posture_axes_are_the_same_watched_or_not(turning_problem):
    planner = fp.MaxMinAntSystem(ants=6, cycles=5)
    view = fp.LiveView(turning_problem, open_browser=False)
    with listening(view.url) as heard, view:
        watched = fp.plan(turning_problem, planner, 3, on_cycle=view.on_cycle)
    assert watched == fp.plan(turning_problem, planner, 3)
    assert unpacked(heard[-1]["commands"])["/meshcat/ants/dots"]["object"]


def test_pheromone_that_a_callback_sees_has_sunk_where_no_ant_laid_any(problem):
    """After one cycle of max-min: rho everywhere, and 1 - rho more along one path, up to 1."""
    first = cycles_of(problem, fp.MaxMinAntSystem(cycles=1, rho=0.6))[0]
    expected = np.full((8, 7, 7), 0.6)
    expected[np.arange(8), first.path[:-1], first.path[1:]] = 1.0
    assert np.allclose(first.pheromone, expected, rtol=1e-12)


def test_pheromone_is_even_again_after_a_restart(problem):
    """Then the cycle after it leaves rho everywhere, and more along one path of eight edges."""
    seen = cycles_of(problem, fp.MaxMinAntSystem(cycles=60, rho=0.6, patience=8))
    restarts = [k for k, c in enumerate(seen[:-1]) if np.all(c.pheromone == 1.0)]
    assert len(restarts) >= 3
    for k in restarts:
        tau = seen[k + 1].pheromone
        assert sorted(np.unique(tau.round(12))) == [0.6, 1.0]
        assert np.array_equal(np.count_nonzero(tau > 0.8, axis=(1, 2)), np.ones(8))


@pytest.mark.parametrize("planner", [fp.AntSystem(cycles=12), fp.MaxMinAntSystem(cycles=12)])
def test_trails_are_the_edges_where_ants_laid_pheromone(problem, planner):
    lattice = LayeredLattice(problem)
    for cycle in cycles_of(problem, planner):
        tau, shot = cycle.pheromone, take(cycle, lattice)
        excess = (tau - tau.min()) / (tau.max() - tau.min())
        expected = {tuple(e) for e in np.argwhere(excess > 1e-3)}
        assert {tuple(e) for e in shot.edges} == expected
        values = excess[tuple(shot.edges.T)]
        assert np.allclose(shot.strength, 1.0 + np.log10(values) / 3.0, atol=1e-12)
        assert shot.strength[-1] == 1.0


def test_only_the_strongest_of_very_many_trails_are_drawn(fig2a_plan):
    problem = fig2a_plan.problem
    cycle = cycles_of(problem, fp.AntSystem(cycles=3, ants=100))[-1]
    shot = take(cycle, LayeredLattice(problem))
    assert len(shot.edges) == 1200
    assert len(np.unique(shot.edges, axis=0)) == 1200
    drawn = cycle.pheromone[tuple(shot.edges.T)]
    assert np.array_equal(np.sort(drawn), np.sort(cycle.pheromone.ravel())[-1200:])


def test_where_pheromone_lies_on_nodes_trails_join_nodes_that_have_some(wide_problem):
    lattice = LayeredLattice(wide_problem)
    for cycle in cycles_of(wide_problem, fp.MaxMinAntSystem(cycles=10)):
        assert cycle.pheromone.shape == (8, 1, 121)
        tau = cycle.pheromone[:, 0]
        marked = [{lattice.origin}, *(set(np.flatnonzero(t > tau.min() + 1e-9)) for t in tau)]
        edges = take(cycle, lattice).edges
        assert all(t in marked[i] and h in marked[i + 1] for i, t, h in edges)
        ends = [{h for i, _, h in edges if i == k} for k in range(8)]
        assert all(
            len(end) == min(len(there), 12) for end, there in zip(ends, marked[1:], strict=True)
        )


def test_every_ant_of_a_cycle_is_on_each_layer_and_postures_count_together(turning_problem):
    lattice = LayeredLattice(turning_problem)
    rng = np.random.default_rng(0)
    for cycle in cycles_of(turning_problem, fp.MaxMinAntSystem(ants=7, cycles=4)):
        anywhere = rng.integers(0, 25, 7)
        shot = take(cycle._replace(path=anywhere), lattice)
        assert shot.counts.shape == (7, 5)
        assert np.array_equal(shot.counts, cycle.counts.reshape(7, 5, 5).sum(axis=2))
        assert np.array_equal(shot.path, np.unravel_index(anywhere, (5, 5))[0])
        assert np.all(shot.counts.sum(axis=1) == cycle.counts.sum(axis=1)[0])


def test_what_is_drawn_stands_where_the_lattice_has_it(problem):
    """Ribbons run from node to node, dots stand on nodes, larger where more ants are."""
    lattice = LayeredLattice(problem)
    cycle = cycles_of(problem, fp.MaxMinAntSystem(cycles=6))[-1]
    shot = take(cycle, lattice)
    drawn = unpacked(commands(shot, lattice))

    def place(layer, node):  # along x, lateral is y
        return np.array([0.5 * layer, 0.2 * (node - 3), 0.0])

    begin, end = middles(drawn["/meshcat/trails/tau"])
    for (layer, tail, head), a, b in zip(shot.edges, begin, end, strict=True):
        assert np.allclose(a, place(layer, tail), atol=0.011)  # a little below the plane
        assert np.allclose(b, place(layer + 1, head), atol=0.011)
    begin, end = middles(drawn["/meshcat/tracks/best"])
    path = np.array([place(i, j) for i, j in enumerate(cycle.path)])
    assert np.allclose(begin, path[:-1], atol=1e-6)
    assert np.allclose(end, path[1:], atol=1e-6)
    dots = drawn["/meshcat/ants/dots"]["object"]["object"]
    placed = np.reshape(dots["instanceMatrix"]["array"], (dots["count"], 4, 4))
    nodes = np.argwhere(cycle.counts)
    assert np.allclose(placed[:, 3, :3], [place(*node) for node in nodes], atol=1e-6)
    volume = placed[:, 0, 0] ** 3
    assert np.allclose(volume / volume[0], cycle.counts[tuple(nodes.T)] / 30, atol=1e-3)


def test_without_pheromone_or_a_path_there_is_nothing_to_draw_but_ants(problem):
    lattice = LayeredLattice(problem)
    cycle = cycles_of(problem, fp.MaxMinAntSystem(cycles=2, pheromone=False))[0]
    drawn = unpacked(commands(take(cycle._replace(best=np.inf), lattice), lattice))
    assert drawn["/meshcat/trails/tau"]["type"] == "delete"
    assert "/meshcat/tracks/best" not in drawn


def test_messages_tell_the_newest_cycle_and_the_course_of_f(view, problem):
    planner = fp.MaxMinAntSystem(cycles=1000)
    with listening(view.url) as heard:
        plan = fp.plan(problem, planner, on_cycle=view.on_cycle)
        view.stop()
    last = heard[-1]
    assert (last["number"], last["cycles"], last["ants"]) == (1000, 1000, 30)
    assert last["best"] == pytest.approx(plan.lattice_objective, rel=1e-12)
    history = np.array(last["history"])
    assert len(history) <= 301
    at = history[:, 0].astype(int) - 1
    assert at[-1] == 999
    assert np.all(np.diff(at) > 0)
    assert np.array_equal(history[:, 1], plan.history.best[at])
    assert np.array_equal(history[:, 2], plan.history.iteration_best[at])


def test_who_comes_late_sees_the_newest_cycle(view, problem):
    fp.plan(problem, fp.MaxMinAntSystem(cycles=30), on_cycle=view.on_cycle)
    with listening(view.url) as heard:
        view.stop()
    assert [message["number"] for message in heard] == [30]


def test_before_there_is_a_path_messages_are_json_all_the_same(view, problem):
    cycle = cycles_of(problem, fp.MaxMinAntSystem(cycles=1))[0]
    view.on_cycle(cycle._replace(best=np.inf, iteration_best=np.inf))
    with listening(view.url) as heard:
        view.stop()
    assert heard[0]["best"] is None
    assert heard[0]["history"] == [[1, None, None]]


def test_in_the_end_the_plan_is_played(problem):
    with fp.LiveView(problem, open_browser=False, title="the title") as view:
        with urllib.request.urlopen(view.url) as answer:
            assert "EventSource" in answer.read().decode()
        plan = fp.plan(problem, on_cycle=view.on_cycle)
        view.finish(plan)
        with urllib.request.urlopen(view.url) as answer:
            shown = answer.read().decode()
        script = '<script>byId("play").click();</script>\n'
        assert shown.replace(script, "") == page(plan, "the title")
        view_thread = threading.Thread(target=view.stop)
        with listening(view.url) as heard:
            view_thread.start()
        view_thread.join()
        assert heard == [{"over": ""}]


def test_the_page_says_why_there_is_no_plan(point):
    wall = fp.Scene([[2.0, y / 2, 0.0] for y in range(-4, 5)], [0.4] * 9)
    goal = point.configuration((4.0, 0.0, 0.0))
    problem = fp.Problem(point, wall, point.configuration(), goal, lattice=fp.Lattice(8))
    view = fp.LiveView(problem, open_browser=False)
    with listening(view.url) as heard, pytest.raises(fp.NoPath) as caught, view:
        fp.plan(problem, on_cycle=view.on_cycle)
    assert heard == [{"over": str(caught.value)}]


class Clock:
    """Time that passes as it is told to."""

    def __init__(self):
        self.now = 0.0

    def monotonic(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    namespace = SimpleNamespace(monotonic=clock.monotonic, sleep=clock.sleep)
    monkeypatch.setattr(live_view, "time", namespace)
    return clock


def test_of_cycles_that_come_fast_ten_a_second_are_drawn_and_the_last(
    problem, view, clock, monkeypatch
):
    drawn = []
    monkeypatch.setattr(view, "_show", lambda _, cycle: drawn.append(cycle.number))

    def see(cycle):
        view.on_cycle(cycle)
        clock.now += 0.04

    fp.plan(problem, fp.MaxMinAntSystem(cycles=12), on_cycle=see)
    assert drawn == [1, 4, 7, 10, 12]


def test_pictures_that_take_long_are_taken_rarely(problem, view, clock, monkeypatch):
    """A picture of half a second is next due after 25 s, 2 % of the time."""
    drawn = []

    def draw(_, cycle):
        drawn.append(cycle.number)
        clock.now += 0.5

    def see(cycle):
        view.on_cycle(cycle)
        clock.now += 1.0

    monkeypatch.setattr(view, "_show", draw)
    fp.plan(problem, fp.MaxMinAntSystem(cycles=60), on_cycle=see)
    assert drawn == [1, 26, 51, 60]


def test_a_pace_is_the_least_time_of_a_cycle(problem, clock):
    ends = []
    with fp.LiveView(problem, open_browser=False, pace=0.25) as view:

        def see(cycle):
            clock.now += (cycle.number % 3) * 0.2
            view.on_cycle(cycle)
            ends.append(clock.now)

        fp.plan(problem, fp.MaxMinAntSystem(cycles=9), on_cycle=see)
    assert np.diff(ends) == pytest.approx([0.4, 0.25, 0.25, 0.4, 0.25, 0.25, 0.4, 0.25])


def test_another_lattice_than_the_one_watched_is_refused(view, wide_problem):
    with pytest.raises(fp.InvalidInput, match="layers of"):
        fp.plan(wide_problem, on_cycle=view.on_cycle)


@pytest.mark.parametrize(
    "wrong", [{"problem": "fig2a"}, {"pace": -1.0}, {"pace": np.nan}, {"port": -1},
              {"open_browser": 1}],
    ids=str,
)  # fmt: skip
def test_what_cannot_be_is_refused(problem, wrong):
    given = {"problem": problem, "open_browser": False, **wrong}
    with pytest.raises(fp.InvalidInput, match=next(iter(wrong))):
        fp.LiveView(**given)


def test_the_command_line_watches_too(tmp_path, monkeypatch):
    from typer.testing import CliRunner

    from ffsr_plan.cli import app

    def run(*options):
        return CliRunner().invoke(app, ["plan", "fig2b", "--no-verify", *options])

    seen = []
    kept = fp.LiveView.on_cycle
    monkeypatch.setattr(
        fp.LiveView, "on_cycle", lambda self, c: (seen.append(c.number), kept(self, c))
    )
    watched = run("--watch", "--no-browser", "--out", str(tmp_path / "watched"))
    assert watched.exit_code == 0, watched.output
    assert "http://127.0.0.1:" in watched.stderr
    assert seen == list(range(1, len(seen) + 1))
    assert run("--out", str(tmp_path / "alone")).exit_code == 0
    plans = [fp.Plan.load(tmp_path / name / "plan.json") for name in ("watched", "alone")]
    assert plans[0] == plans[1]
    for wrong in (["--watch", "--colonies", "2"], ["--pace", "1"], ["--port", "8000"]):
        refused = run(*wrong)
        assert refused.exit_code == 2
        assert "--watch" in refused.stderr


@in_a_browser
@pytest.mark.slow
def test_in_a_browser_the_picture_follows_the_colony_and_then_the_plan(fig2a_plan, tmp_path):
    problem, cycles = fig2a_plan.problem, cycles_of(fig2a_plan.problem, fp.AntSystem(cycles=9))
    shots = [tmp_path / f"{name}.png" for name in ("waiting", "first", "ninth", "plan")]
    with (
        fp.LiveView(problem, open_browser=False) as view,
        chromium.opened(view.url, tmp_path / "profile") as tab,
    ):
        tab.wait_until("document.title.startsWith('ready')")
        tab.shoot(shots[0])
        for k, cycle in enumerate((cycles[0], cycles[-1])):
            view._due = 0.0
            view.on_cycle(cycle)
            tab.wait_until(f"document.title.startsWith('{k + 1} shown')")
            assert f"cycle {cycle.number} of" in tab.ask("byId('state').textContent")
            tab.shoot(shots[k + 1])
        view.finish(fig2a_plan)
        tab.wait_until("document.title.startsWith('ready') && typeof slider === 'object'")
        tab.wait_until("Number(slider.value) > 0.01")
        tab.shoot(shots[3])
        view.stop()
        tab.wait_until("Number(slider.value) === 1")  # it no longer needs the server
    pictures = [np.asarray(Image.open(s).convert("RGB")).astype(int)[100:450] for s in shots]
    for picture in pictures:
        assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 2000
    for one, other in pairwise(pictures):
        assert np.mean(np.abs(one - other).sum(axis=2) > 60) > 0.005


@in_a_browser
@pytest.mark.slow
def test_a_page_whose_planner_is_gone_says_so(problem, tmp_path):
    with (
        fp.LiveView(problem, open_browser=False) as view,
        chromium.opened(view.url, tmp_path / "profile") as tab,
    ):
        tab.wait_until("document.title.startsWith('ready')")
        fp.plan(problem, fp.MaxMinAntSystem(cycles=3), on_cycle=view.on_cycle)
        tab.wait_until("document.title.includes('shown')")
        view.stop()
        tab.wait_until("byId('state').textContent.includes('no longer connected')")
