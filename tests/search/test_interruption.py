"""Ctrl-C: the first one ends the search with its best plan, the next one is always raised."""

import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.refinement.band_search import BandSearch
from ffsr_plan.search import interruption, lattice_planner, optimum_planner
from ffsr_plan.search.postures import annealing_kernels, posture_annealing
from ffsr_plan.search.postures.path_proof import RefusedEdge
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.postures.posture_lattice_arrays import posture_grid
from tests.helpers.spatial_robot import spatial_problem

ENDLESS = fp.MaxMinAntSystem(cycles=10**6)


@pytest.fixture(autouse=True)
def nothing_pending(monkeypatch):
    monkeypatch.setattr(interruption, "_ended", -float("inf"))


@pytest.fixture(scope="module")
def problem():
    return fp.load_scenario("fig2a")


def press(*_):
    signal.raise_signal(signal.SIGINT)


def press_at(*cycles):
    return lambda cycle: [press() for k in cycles if k == cycle.number]


@pytest.mark.parametrize("planner", [ENDLESS, fp.AntSystem(rho=0.999999)])
def test_the_first_ctrl_c_ends_the_search_with_its_best_plan(problem, planner):
    plan = fp.plan(problem, planner, on_cycle=press_at(3))
    assert plan.interrupted
    assert len(plan.history.best) == 3
    assert plan.verify(20).ok
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_the_second_ctrl_c_is_raised(problem):
    with pytest.raises(KeyboardInterrupt):
        fp.plan(problem, ENDLESS, on_cycle=press_at(3, 3))
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_the_first_ctrl_c_is_raised_on_request(problem):
    with pytest.raises(KeyboardInterrupt):
        fp.plan(problem, ENDLESS, on_cycle=press_at(3), on_interrupt="raise")
    with pytest.raises(fp.InvalidInput, match="on_interrupt: got 'ignore'"):
        fp.plan(problem, on_interrupt="ignore")


def test_a_loop_over_plans_ends_at_one_ctrl_c(problem):
    plans = []

    def study():
        for seed in range(4):
            pressed = press_at(2) if seed == 1 else None
            planner = ENDLESS if seed == 1 else fp.MaxMinAntSystem(cycles=3)
            plans.append(fp.plan(problem, planner, seed, on_cycle=pressed, refine=False))

    with pytest.raises(KeyboardInterrupt):
        study()
    assert [plan.interrupted for plan in plans] == [False, True]
    assert not fp.plan(problem, fp.MaxMinAntSystem(cycles=3), refine=False).interrupted


def test_a_call_that_begins_later_is_not_concerned(problem, monkeypatch):
    fp.plan(problem, ENDLESS, on_cycle=press_at(2), refine=False)
    monkeypatch.setattr(interruption, "_PENDING_SECONDS", 0.0)
    assert not fp.plan(problem, fp.MaxMinAntSystem(cycles=3), refine=False).interrupted


def test_a_time_limit_leaves_the_next_call_alone(problem):
    assert fp.plan(problem, ENDLESS, time_limit=0.3, refine=False).interrupted
    assert not fp.plan(problem, fp.MaxMinAntSystem(cycles=3), refine=False).interrupted


def test_ctrl_c_during_the_refinement_keeps_the_plan(problem, monkeypatch):
    best_path, rounds = BandSearch.best_path, []

    def pressed(search, candidates):
        rounds.append(candidates)
        if len(rounds) == 2:
            press()
        return best_path(search, candidates)

    monkeypatch.setattr(BandSearch, "best_path", pressed)
    plan = fp.plan(replace(problem, delta=0.0), fp.MaxMinAntSystem(cycles=20))
    assert plan.interrupted
    assert len(rounds) == 2
    assert plan.objective < plan.lattice_objective
    assert plan.verify(20).ok


def test_ctrl_c_where_there_is_no_plan_yet_is_raised(problem, monkeypatch):
    with monkeypatch.context() as patched:
        patched.setattr(optimum_planner, "lattice_optimum", press)
        with pytest.raises(KeyboardInterrupt):
            fp.plan(problem, fp.LatticeOptimum())
    monkeypatch.setattr(fp.AntSystem, "search", lambda *_: press() or no_path_found())
    with pytest.raises(KeyboardInterrupt) as raised:
        fp.plan(problem, fp.AntSystem())
    assert "none found" in str(raised.value.__cause__)


def no_path_found():
    raise fp.PlanningError("none found")


def test_a_search_by_postures_ends_without_a_proven_path(monkeypatch):
    problem = fp.load_scenario("gate")
    prove, calls = posture_annealing.prove_path, []

    def refusing(*arguments):
        calls.append(press())
        return prove(*arguments)._replace(refused=[RefusedEdge(3, "base", 0, 0.0)])

    monkeypatch.setattr(posture_annealing, "prove_path", refusing)
    with pytest.raises(KeyboardInterrupt) as raised:
        fp.plan(problem, fp.PostureAnnealing(ants=2, cycles=2, annealing_shifts=5))
    assert isinstance(raised.value.__cause__, fp.UnprovenPath)
    assert len(calls) == 1


def test_a_ctrl_c_that_a_library_swallows_is_raised_later(problem, monkeypatch):
    def swallowing(*_):
        with suppress(KeyboardInterrupt):
            press()

    monkeypatch.setattr(lattice_planner, "Roadmap", lambda *given: swallowing() or Roadmap(*given))
    for choice in ("return", "raise"):
        with pytest.raises(KeyboardInterrupt):
            fp.plan(problem, fp.LatticeOptimum(), on_interrupt=choice)


def test_a_handler_of_the_user_is_left_alone(problem):
    received = []
    before = signal.signal(signal.SIGINT, lambda number, _: received.append(number))
    try:
        plan = fp.plan(problem, fp.MaxMinAntSystem(cycles=5), on_cycle=press_at(3), refine=False)
    finally:
        signal.signal(signal.SIGINT, before)
    assert received == [signal.SIGINT]
    assert not plan.interrupted


def test_other_threads_plan_without_ctrl_c(problem):
    plans = []
    planner = fp.MaxMinAntSystem(cycles=3)
    thread = threading.Thread(target=lambda: plans.append(fp.plan(problem, planner, refine=False)))
    thread.start()
    thread.join()
    assert not plans[0].interrupted


def annealed(grid, path, stop_requested=bool):
    found, weights = np.empty_like(path), np.array([5.0, 100.0])
    rng = np.random.default_rng(7)
    arguments = grid, rng, path, 5000, 1.0, 1e-3, weights, found, stop_requested
    return annealing_kernels.anneal(*arguments), found, rng.random()


def test_an_annealing_in_parts_is_the_same_annealing(monkeypatch):
    grid = posture_grid(PostureLattice(spatial_problem(20, (1, 1, 0), divisions=20, levels=2)))
    path = np.tile(grid.origin, (21, 1))
    results = []
    for first, seconds in ((5000, 0.0), (7, 0.0), (1, 1e9)):
        monkeypatch.setattr(annealing_kernels, "_FIRST_PART", first)
        monkeypatch.setattr(annealing_kernels, "_SECONDS_OF_A_PART", seconds)
        results.append(annealed(grid, path))
    for cost, found, drawn in results[1:]:
        assert (cost, drawn) == (results[0][0], results[0][2])
        assert np.array_equal(found, results[0][1])
    calls = []
    annealed(grid, path, lambda: bool(calls.append(0)) or len(calls) == 2)
    assert len(calls) == 2


def test_a_time_limit_acts_within_one_annealing():
    problem = fp.load_scenario("gate")
    fp.plan(problem, fp.PostureAnnealing(ants=2, cycles=2, annealing_shifts=5))  # compile
    begin = time.monotonic()
    slow = fp.PostureAnnealing(ants=2, cycles=2, annealing_shifts=10**6)
    with suppress(fp.PlanningError):  # the path so far need not lead to the goal
        assert fp.plan(problem, slow, time_limit=0.3).interrupted
    assert time.monotonic() - begin < 10.0  # hours without the limit


WORKERS = """
import ffsr_plan as fp
problem = fp.load_scenario("fig2a")
fp.plan(problem, fp.MaxMinAntSystem(cycles=2))  # compile
print("begin", flush=True)
plan = fp.plan(problem, fp.MaxMinAntSystem(cycles=10**6), colonies=4, workers=2, refine=False)
print(plan.interrupted, flush=True)
"""


@pytest.fixture
def group():
    """A process group that plans on two workers; killed in the end."""
    process = subprocess.Popen(
        [sys.executable, "-c", WORKERS],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stdout.readline() == "begin\n"
    yield process
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


def ends(group, seconds):
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        try:
            os.killpg(group.pid, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.1)
    return False


@pytest.mark.parametrize("presses", [[0.3], [4.0], [0.7, 0.1]])
def test_ctrl_c_on_a_terminal_ends_all_workers_quietly(group, presses):
    for delay in presses:  # a terminal sends it to every process of the group
        time.sleep(delay)
        os.killpg(group.pid, signal.SIGINT)
    out, err = group.communicate(timeout=60)
    if group.returncode == 0:
        assert out == "True\n"
        assert [line for line in err.splitlines() if "compiling" not in line] == []
    else:
        assert group.returncode == -signal.SIGINT, err
        assert err.count("Traceback") == 1, err
        assert err.endswith("KeyboardInterrupt\n"), err
    assert ends(group, 5.0)


def test_workers_end_with_a_killed_caller(group):
    time.sleep(4.0)
    group.kill()
    group.wait()
    assert ends(group, 10.0)
