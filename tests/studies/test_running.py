"""Studies end with the same rows, whatever happens on the way."""

import os
import random
import resource
import signal
import sqlite3
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

import ffsr_plan as fp
from ffsr_plan.studies.engines import dask_cluster
from tests.helpers.small_studies import Deadly, Slow, small_problem, small_study

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The study that nothing happened to."""
    return small_study().run(tmp_path_factory.mktemp("whole"))


RUN = "import sys; from tests.helpers.small_studies import small_study as made; made().run"


def run_alone(folder, engine="in-process", workers=1):
    """The small study in a process of its own, each plan of which takes some 50 ms longer."""
    command = [sys.executable, "-c", f"{RUN}('{folder}', engine='{engine}', workers={workers})"]
    path = {"PYTHONPATH": str(ROOT), "FFSR_TEST_REST": "0.05"}
    return subprocess.Popen(
        command, cwd=ROOT, env={**os.environ, **path}, stderr=subprocess.PIPE, text=True
    )


def rows_in(folder):
    try:
        with sqlite3.connect(f"file:{folder}/study.sqlite?mode=ro", uri=True) as connection:
            return connection.execute("SELECT count(*) FROM rows").fetchone()[0]
    except sqlite3.Error:
        return 0


def wait_for_rows(process, folder, count):
    while process.poll() is None and rows_in(folder) < count:
        time.sleep(0.01)


def test_there_is_one_row_with_its_plan_for_each_point_of_the_grid(whole):
    rows = whole.rows()
    assert len({(row["problem"], row["planner"], row["seed"]) for row in rows}) == 24
    for row in rows[::7]:
        plan = whole.plan(row)
        assert (plan.length, plan.objective) == (row["length"], row["objective"])
        assert plan.seed == row["seed"]
        assert row["least_clearance"] == plan.certificate.least_clearance


@pytest.mark.parametrize("engine", ["processes", "cluster"])
def test_several_workers_give_the_same_rows_bit_for_bit(whole, tmp_path, engine, monkeypatch):
    monkeypatch.setenv("FFSR_TEST_REST", "0.05")
    if engine == "cluster":
        with dask_cluster.local(2) as client:
            found = small_study().run(tmp_path, scheduler=client)
    else:
        found = small_study().run(tmp_path, workers=2, engine=engine)
    assert found.digest() == whole.digest()
    assert len({row["worker"] for row in found.rows()}) == 2


def test_a_change_of_any_lasting_column_changes_the_digest(tmp_path):
    problem = {"p": small_problem()}
    found = fp.Study(problem, "lattice-optimum").run(tmp_path)
    before = found.digest()
    with sqlite3.connect(found.database) as connection:
        connection.execute("UPDATE rows SET wall = wall + 1, worker = 'x'")
    assert found.digest() == before
    with sqlite3.connect(found.database) as connection:
        connection.execute("UPDATE rows SET objective = objective + 1e-15")
    assert found.digest() != before


def test_a_study_killed_at_random_ends_with_the_same_rows(whole, tmp_path):
    rng, begun = random.Random(3), []
    for _ in range(3):
        process = run_alone(tmp_path)
        wait_for_rows(process, tmp_path, rows_in(tmp_path) + rng.randrange(1, 6))
        time.sleep(rng.random() * 0.1)
        process.kill()
        process.communicate()
        begun.append(rows_in(tmp_path))
    assert begun[0] > 0
    assert begun[-1] < 24
    assert run_alone(tmp_path).wait() == 0
    found = fp.StudyResult(tmp_path)
    again = {row["key"]: row["finished"] for row in found.rows()}
    assert found.digest() == whole.digest()
    told = []
    small_study().run(tmp_path, on_progress=told.append)
    assert [each.done for each in told] == [24]  # nothing twice
    assert {row["key"]: row["finished"] for row in found.rows()} == again


def test_ctrl_c_keeps_what_came_back_and_the_next_run_goes_on(whole, tmp_path):
    process = run_alone(tmp_path, "processes", 2)
    wait_for_rows(process, tmp_path, 3)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert process.returncode != 0
    assert "KeyboardInterrupt" in errors
    left = rows_in(tmp_path)
    assert 3 <= left < 24
    before = {row["key"]: row["finished"] for row in fp.StudyResult(tmp_path).rows()}
    found = small_study().run(tmp_path)
    assert len(found) == 24
    assert before.items() <= {row["key"]: row["finished"] for row in found.rows()}.items()


@pytest.mark.parametrize("engine", ["processes", pytest.param("dask", marks=pytest.mark.slow)])
def test_a_killed_worker_is_named_and_its_task_done_again_or_a_fault(tmp_path, engine):
    notices = []
    study = fp.Study({"p": small_problem()}, {"deadly": Deadly(str(tmp_path))}, 5)
    found = study.run(
        tmp_path, workers=2, engine=engine, on_progress=lambda told: notices.append(told.notice)
    )
    rows = {row["seed"]: row for row in found.rows()}
    outcomes = [rows[seed]["outcome"] for seed in range(5)]
    assert outcomes == ["plan", "plan", "fault", "plan", "plan"]
    assert rows[2]["error"] == "WorkerDied"
    assert len(rows[2]["lost_workers"]) == 3
    lost = rows[1]["lost_workers"]
    assert lost
    assert any(lost[0] in notice and "seed 1" in notice for notice in notices)


class Careless:
    """A planner that finds a path, or fails in each of the ways in which planners fail."""

    name = "careless"

    def plan(self, problem, seed):
        if seed == 1:
            raise fp.NoPath(2, (), 6)
        if seed == 2:
            raise ZeroDivisionError("nobody thought of it")
        if seed == 3:
            return "no plan"
        if seed == 4:
            return fp.plan(problem, "lattice-optimum"), {"tries": 3}
        times, names = [0.0, 1.0], list(problem.robot.joint_names)
        ends = [problem.start[:3], problem.goal[:3]]
        held = fp.Trajectory(times, {name: [0.0, 0.0] for name in names}, base_positions=ends)
        return held  # straight through the sphere


def test_whatever_a_planner_does_becomes_a_row_that_says_so(tmp_path):
    found = fp.Study({"p": small_problem()}, Careless(), 5).run(tmp_path)
    rows = {row["seed"]: row for row in found.rows()}
    outcomes = [rows[seed]["outcome"] for seed in range(5)]
    assert outcomes == ["contact", "no plan", "fault", "invalid", "plan"]
    assert rows[1]["error"] == "NoPath"
    assert "layer 2" in rows[1]["message"]
    assert "nobody thought of it" in rows[2]["traceback"]
    assert rows[4]["figures"] == {"tries": 3}


def test_failures_are_repeated_on_request_only(tmp_path):
    marks = tmp_path / "marks"
    study = fp.Study({"p": small_problem()}, {"late": Late(str(marks))}, 2)
    assert study.run(tmp_path).plans == 0
    marks.touch()
    assert study.run(tmp_path).plans == 0
    assert study.run(tmp_path, retry_failed=True).plans == 2


@dataclass(frozen=True)
class Late:
    """A planner that fails until a file is there."""

    file: str

    def plan(self, problem, seed):
        if not Path(self.file).exists():
            raise fp.OutOfTime(1.0, "the search")
        return fp.plan(problem, "lattice-optimum", seed)


def test_a_full_disk_is_an_error_that_names_the_file_and_no_row_is_damaged(tmp_path):
    study, before = small_study(), resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, before[1]))
    try:
        with pytest.raises(fp.InvalidInput, match=r"study|plan file"):
            study.run(tmp_path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    with sqlite3.connect(tmp_path / "study.sqlite") as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    assert len(study.run(tmp_path)) == 24


def test_a_memory_limit_ends_one_plan_and_not_the_study(tmp_path):
    study = fp.Study({"p": small_problem()}, {"greedy": greedy}, 2, memory_limit=0.5)
    rows = study.run(tmp_path, workers=1).rows()
    assert [row["error"] for row in rows] == [None, "MemoryError"]


def greedy(problem, seed):
    kept = bytearray(seed * 2_000_000_000)
    del kept
    return fp.plan(problem, "lattice-optimum", seed)


def test_other_problems_by_the_same_names_are_refused(tmp_path):
    fp.Study({"p": small_problem()}, "lattice-optimum").run(tmp_path)
    other = fp.Study({"p": small_problem(0.2)}, "lattice-optimum")
    with pytest.raises(fp.InvalidInput, match="problem 'p'"):
        other.run(tmp_path)
    more = {"p": small_problem(), "q": small_problem(0.2)}
    assert len(fp.Study(more, "lattice-optimum").run(tmp_path)) == 2


def test_two_runs_at_the_same_time_are_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("FFSR_TEST_REST", "1.0")
    study, refused = fp.Study({"p": small_problem()}, {"slow": Slow()}), []
    first = threading.Thread(target=study.run, args=(tmp_path,))
    first.start()
    while not (tmp_path / "study.lock").exists():
        time.sleep(0.01)
    time.sleep(0.1)
    try:
        with pytest.raises(fp.InvalidInput, match="no other run") as error:
            study.run(tmp_path)
        refused.append(error)
    finally:
        first.join()
    assert refused


def test_a_key_depends_on_whatever_decides_the_plan():
    def keys(problem, planner, **more):
        return {task.key for task in fp.Study({"p": problem}, {"x": planner}, **more).grid.tasks()}

    problem, planner = small_problem(), fp.AntSystem(ants=3)
    own = keys(problem, planner)
    assert own == keys(small_problem(), fp.AntSystem(ants=3))
    for other in (
        keys(small_problem(0.11), planner),
        keys(replace(problem, delta=0.2), planner),
        keys(replace(problem, alternatives=[problem.goal]), planner),
        keys(problem, fp.AntSystem(ants=4)),
        keys(problem, planner, seeds=[1]),
        keys(problem, planner, refine=False),
        keys(problem, planner, time_limit=5.0),
    ):
        assert not own & other
