"""Compiling is counted apart, in workers too, and announced once for all processes."""

import os
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from ffsr_plan.core.kernels import announcement, compiling_time
from ffsr_plan.core.kernels.compiling_time import Stopwatch, add_compiled
from ffsr_plan.search.records import SearchRequest
from ffsr_plan.search.workers import run_on_workers

PROGRAM = """
import time
import ffsr_plan as fp
from ffsr_plan.core.kernels.compiling_time import Stopwatch

if __name__ == "__main__":
    robot = fp.load_robot("point")  # alone in space: few kernels
    goal = robot.configuration((4.0, 0.0, 0.0))
    lattice = fp.Lattice(8, fp.Axis(3, 0.2))
    problem = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, "attitude-held", lattice=lattice)
    for _ in range(2):
        watch, begin = Stopwatch(), time.perf_counter()
        plan = fp.plan(problem, fp.AntSystem(cycles=2), refine=False, colonies=2, workers=2)
        print(time.perf_counter() - begin, plan.seconds, watch.compiling)
"""


@pytest.mark.slow
def test_seconds_leave_out_compiling_which_is_announced_once(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    first, second = ([float(x) for x in line.split()] for line in run.stdout.splitlines())
    whole, seconds, compiling = first
    assert compiling > 2.0
    assert seconds == pytest.approx(whole - compiling, abs=0.2 * compiling)
    assert second[2] == 0.0
    assert run.stderr.count("compiling numerical kernels") == 1


def test_of_workers_the_one_that_compiled_longest_counts():
    def run(job, rngs, monitor):
        add_compiled(job * len(rngs))
        return [None] * len(rngs)

    watch, rngs = Stopwatch(), np.random.default_rng(0).spawn(3)
    assert run_on_workers(run, 2.0, rngs, SearchRequest(colonies=3, workers=2)) == [None] * 3
    assert watch.compiling == 4.0


def test_nested_kernels_count_once(monkeypatch):
    now = iter([1.0, 10.0, 20.0])
    watch = Stopwatch()
    monkeypatch.setattr(time, "perf_counter", lambda: next(now))
    compiling_time.count_begin()
    compiling_time.count_begin()
    compiling_time.count_end()
    compiling_time.count_end()
    monkeypatch.undo()
    assert (watch.compiling, watch.kernels) == (9.0, 2)


def test_what_another_thread_compiles_is_not_counted():
    watch = Stopwatch()
    other = threading.Thread(target=add_compiled, args=(5.0,))
    other.start()
    other.join()
    assert watch.compiling == 0.0
    add_compiled(5.0)
    assert watch.compiling == 5.0


def test_the_right_to_announce_is_given_once(monkeypatch):
    monkeypatch.setattr(announcement, "_token", threading.Lock())
    shared = threading.Lock()
    announcement.share(shared)
    assert announcement.is_due()
    assert not announcement.is_due()
    assert shared.locked()  # so the other processes see it
    later = threading.Lock()
    announcement.share(later)
    assert later.locked()
