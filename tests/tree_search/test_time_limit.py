"""A time limit on a clock that ticks at every look, without a lattice: what is proven is kept."""

import time
from itertools import count

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.planning import plan_and_refine
from ffsr_plan.search.records import SearchMonitor
from ffsr_plan.time_limit.deadline import Deadline
from ffsr_plan.tree_search import path_proof
from ffsr_plan.tree_search.search_rounds import SearchRounds
from tests.helpers.free_scenes import gap, scattered

QUICK = fp.TreePlanner(checks=60_000)


@pytest.fixture
def limited(monkeypatch):
    """Plan with a limit in looks at the clock."""

    def plan(problem, looks):
        plan.ticks = ticks = count()
        deadline = Deadline(float(looks), clock=lambda: float(next(ticks)))
        monkeypatch.setattr(plan_and_refine, "_deadline", lambda _: deadline)
        return fp.plan(problem, QUICK)

    return plan


def test_at_any_moment_there_is_a_proven_plan_or_an_error(limited, robot):
    problem, plans, errors = gap(robot, 0), [], []
    whole = limited(problem, 10**9)
    looks = next(limited.ticks)
    for each in [*np.linspace(1, looks, 25).astype(int).tolist(), 10**9]:
        try:
            plans.append(limited(problem, each))
        except (fp.OutOfTime, fp.PathNotFound) as error:
            plans.append(None)
            errors.append(str(error))
    first = next(k for k, plan in enumerate(plans) if plan is not None)
    assert errors
    assert all("a longer time_limit" in each for each in errors)
    assert not any("divisions" in each for each in errors)
    assert None not in plans[first:]
    assert plans[first].interrupted
    assert all(plan.verify(5).ok for plan in plans[first::6])
    assert plans[-1] == whole


def test_the_plan_returns_within_its_time(robot):
    problem = scattered(robot, 1, delta=0.05, clearance_cap=0.5)
    fp.plan(problem, QUICK)
    late = []
    for seed in range(5):
        begin = time.perf_counter()
        assert fp.plan(problem, seed=seed, time_limit=0.5).interrupted
        late.append(time.perf_counter() - begin - 0.5)
    assert min(late) < 0.045


def test_looks_at_the_clock_change_nothing(robot):
    problem = scattered(robot, 0)
    assert fp.plan(problem, QUICK, 3, time_limit=1e3).motion.positions.tolist() == (
        fp.plan(problem, QUICK, 3).motion.positions.tolist()
    )


def test_ctrl_c_waits_for_the_proof_of_the_first_path(robot, monkeypatch):
    pressed, prove = [], path_proof.prove

    def proof(*arguments):
        pressed.append(True)
        return prove(*arguments)

    monkeypatch.setattr("ffsr_plan.tree_search.proven_paths.prove", proof)
    monitor = SearchMonitor(deadline=Deadline(stop_requested=lambda: bool(pressed)))
    rounds = SearchRounds(gap(robot, 0), QUICK, np.random.default_rng(0), monitor)
    assert rounds.run(10**6, False)
    assert rounds.proven.best is not None
    assert len(pressed) == 1
