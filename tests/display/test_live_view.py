"""A live view does not change the search, and shows what the search does."""

import json
import threading
import urllib.request
from contextlib import contextmanager
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

import ffsr_plan as fp
from ffsr_plan.display.live import live_view, tree_picture
from ffsr_plan.display.plan_page import page
from tests.helpers import chromium
from tests.helpers.watched_cycles import cycles_of, unpacked

TREES = fp.TreePlanner(checks=200_000)
in_a_browser = pytest.mark.skipif(chromium.PROGRAM is None, reason="no Chromium on this machine")


@pytest.fixture
def view(problem):
    with fp.LiveView(problem, open_browser=False) as view:
        yield view


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


@pytest.mark.parametrize("planner", [fp.AntSystem(cycles=30), fp.MaxMinAntSystem(cycles=60)])
@pytest.mark.parametrize("name", ["problem", "wide_problem"])
def test_plans_are_the_same_watched_or_not(request, planner, name):
    problem = request.getfixturevalue(name)
    view = fp.LiveView(problem, open_browser=False)
    with listening(view.url) as heard, view:
        watched = fp.plan(problem, planner, 3, on_cycle=view.on_cycle)
    assert watched == fp.plan(problem, planner, 3)
    assert heard[-1]["number"] <= planner.cycles


def test_posture_plans_are_the_same_watched_or_not(turning_problem):
    planner = fp.PostureAnnealing(ants=6, cycles=5)
    view = fp.LiveView(turning_problem, open_browser=False)
    with listening(view.url) as heard, view:
        watched = fp.plan(turning_problem, planner, 3, on_cycle=view.on_cycle)
    assert watched == fp.plan(turning_problem, planner, 3)
    assert unpacked(heard[-1]["commands"])["/meshcat/ants/dots"]["object"]


def test_messages_hold_the_newest_cycle_and_the_history_of_f(view, problem):
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


def test_a_late_listener_receives_the_newest_cycle(view, problem):
    fp.plan(problem, fp.MaxMinAntSystem(cycles=30), on_cycle=view.on_cycle)
    with listening(view.url) as heard:
        view.stop()
    assert [message["number"] for message in heard] == [30]


def test_messages_without_a_path_are_valid_json(view, problem):
    cycle = cycles_of(problem, fp.MaxMinAntSystem(cycles=1))[0]
    view.on_cycle(cycle._replace(best=np.inf, iteration_best=np.inf))
    with listening(view.url) as heard:
        view.stop()
    assert heard[0]["best"] is None
    assert heard[0]["history"] == [[1, None, None]]


def test_finally_the_plan_is_played(problem):
    with fp.LiveView(problem, open_browser=False, title="the title") as view:
        with urllib.request.urlopen(view.url) as answer:
            assert "EventSource" in answer.read().decode()
        plan = fp.plan(problem, on_cycle=view.on_cycle)
        view.finish(plan)
        with urllib.request.urlopen(view.url) as answer:
            shown = answer.read().decode()
        assert shown == page(plan, "the title", playing=True)
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


@pytest.fixture(scope="module")
def rounds(robot):
    """A problem without a lattice, its plan, and the rounds of its search."""
    goal = robot.configuration((4.0, 0.0, 0.0), joints={"left_1": 0.7})
    problem = fp.Problem(robot, fp.Scene([[2.0, 0.2, 0.0]], [0.35]), robot.neutral(), goal)
    seen = []
    plan = fp.plan(problem, TREES, on_cycle=seen.append)
    return problem, plan, seen


def test_searches_by_trees_are_shown_and_are_the_same_watched_or_not(rounds):
    problem, plan, seen = rounds
    view = fp.LiveView(problem, open_browser=False)
    with listening(view.url) as heard, view:
        assert fp.plan(problem, TREES, on_cycle=view.on_cycle) == plan
    last = heard[-1]
    assert (last["number"], last["checks"], last["nodes"]) == (
        len(seen), seen[-1].checks, seen[-1].nodes
    )  # fmt: skip
    assert last["best"] == plan.objective
    assert last["history"][-1][:2] == [len(seen), plan.objective]


def test_the_picture_of_a_round_has_branches_the_best_path_and_the_robot_at_its_end(rounds):
    problem, plan, seen = rounds
    shown = unpacked(tree_picture.commands(seen[-1], problem))
    assert {"/meshcat/trails/tau", "/meshcat/tracks/best"} <= shown.keys()
    assert shown["/meshcat/ants/dots"]["type"] == "delete"
    (mesh,) = shown["/meshcat/trails/tau"]["object"]["geometries"]
    corners = np.frombuffer(mesh["data"]["attributes"]["position"]["array"].data, np.float32)
    assert corners.size == 12 * len(seen[-1].branches.tree)  # a ribbon has four corners a branch
    placed = np.array(shown["/meshcat/robot/joint_1"]["matrix"]).reshape(4, 4).T
    assert placed[:3, 3] == pytest.approx(plan.problem.goal[:3])
    assert np.array_equal(seen[-1].arrival, plan.configurations[-1])


def test_a_round_without_path_and_branches_clears_the_picture(rounds):
    problem, _, seen = rounds
    empty = seen[0]._replace(
        path=np.zeros((0, 3)), arrival=np.zeros(0), branches=fp.Branches.none(), best=np.inf
    )
    shown = unpacked(tree_picture.commands(empty, problem))
    assert {path: each["type"] for path, each in shown.items()} == {
        "/meshcat/ants/dots": "delete", "/meshcat/trails/tau": "delete"
    }  # fmt: skip


def test_a_portfolio_shows_ants_then_trees_with_a_history_of_each(problem):
    portfolio, view = fp.Portfolio(trees=TREES), fp.LiveView(problem, open_browser=False)
    kinds = []
    with view:

        def see(cycle):
            view.on_cycle(cycle)
            kinds.append(type(cycle))

        watched = fp.plan(problem, portfolio, on_cycle=see)
        rounds = kinds.count(fp.TreeCycle)
        assert 0 < rounds < len(kinds)
        assert [each[0] for each in view._history] == list(range(1, rounds + 1))
    assert watched == fp.plan(problem, portfolio)


def test_where_the_robot_floats_there_is_a_live_view_too(robot):
    goal = robot.configuration(joints={"left_1": 0.7})
    problem = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, "free-floating")
    with fp.LiveView(problem, open_browser=False) as view:
        fp.plan(problem, TREES, on_cycle=view.on_cycle)


def test_a_colony_is_refused_where_there_is_no_lattice(rounds, problem):
    cycle = cycles_of(problem, fp.MaxMinAntSystem(cycles=1))[0]
    with (
        fp.LiveView(rounds[0], open_browser=False) as view,
        pytest.raises(fp.InvalidInput, match="rounds of trees"),
    ):
        view.on_cycle(cycle)


class Clock:
    """A clock that advances only in `sleep` and by hand."""

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


def test_at_most_ten_cycles_a_second_and_the_last_are_drawn(problem, view, clock, monkeypatch):
    drawn = []
    monkeypatch.setattr(view, "_show", lambda cycle: drawn.append(cycle.number))

    def see(cycle):
        view.on_cycle(cycle)
        clock.now += 0.04

    fp.plan(problem, fp.MaxMinAntSystem(cycles=12), on_cycle=see)
    assert drawn == [1, 4, 7, 10, 12]


def test_slow_pictures_are_drawn_rarely(problem, view, clock, monkeypatch):
    """A picture of half a second is next due after 25 s, 2 % of the time."""
    drawn = []

    def draw(cycle):
        drawn.append(cycle.number)
        clock.now += 0.5

    def see(cycle):
        view.on_cycle(cycle)
        clock.now += 1.0

    monkeypatch.setattr(view, "_show", draw)
    fp.plan(problem, fp.MaxMinAntSystem(cycles=60), on_cycle=see)
    assert drawn == [1, 26, 51, 60]


def test_pace_is_the_least_duration_of_a_cycle(problem, clock):
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
    "wrong",
    [{"problem": "fig2a"}, {"pace": -1.0}, {"pace": np.nan}, {"port": -1}, {"open_browser": 1}],
    ids=str,
)
def test_invalid_arguments_are_refused(problem, wrong):
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
def test_a_browser_shows_the_search_and_then_the_plan(fig2a_plan, tmp_path):
    problem, cycles = fig2a_plan.problem, cycles_of(fig2a_plan.problem, fp.AntSystem(cycles=9))
    shots = [tmp_path / f"{name}.png" for name in ("waiting", "first", "ninth", "plan")]
    with (
        fp.LiveView(problem, open_browser=False) as view,
        chromium.opened(view.url, tmp_path / "profile") as tab,
    ):
        tab.wait_until("document.title.startsWith('ready')")
        tab.shoot(shots[0])
        for k, cycle in enumerate((cycles[0], cycles[-1])):
            view._next_picture = 0.0
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
def test_a_browser_shows_the_branches_of_trees(rounds, tmp_path):
    problem, _, seen = rounds
    shots = [tmp_path / f"{name}.png" for name in ("waiting", "last")]
    with (
        fp.LiveView(problem, open_browser=False) as view,
        chromium.opened(view.url, tmp_path / "profile") as tab,
    ):
        tab.wait_until("document.title.startsWith('ready')")
        tab.shoot(shots[0])
        view.on_cycle(seen[-1])
        tab.wait_until("document.title.startsWith('1 shown')")
        assert f"round {seen[-1].number} of" in tab.ask("byId('state').textContent")
        assert tab.ask("byId('trails').textContent") == "trees"
        tab.shoot(shots[1])
    one, other = (np.asarray(Image.open(s).convert("RGB")).astype(int)[100:450] for s in shots)
    assert np.mean(np.abs(one - other).sum(axis=2) > 60) > 0.002


@in_a_browser
@pytest.mark.slow
def test_a_page_reports_a_lost_connection(problem, tmp_path):
    with (
        fp.LiveView(problem, open_browser=False) as view,
        chromium.opened(view.url, tmp_path / "profile") as tab,
    ):
        tab.wait_until("document.title.startsWith('ready')")
        fp.plan(problem, fp.MaxMinAntSystem(cycles=3), on_cycle=view.on_cycle)
        tab.wait_until("document.title.includes('shown')")
        view.stop()
        tab.wait_until("byId('state').textContent.includes('no longer connected')")
