"""`ffsr-plan bench`: a run, its results, comparisons and the page."""

import io
import json
import shutil

import numpy as np
import pytest
from rich.console import Console
from typer.testing import CliRunner

import ffsr_plan as fp
from ffsr_plan.cli import app
from ffsr_plan.cli.console.report_tables import printed as printed_table
from ffsr_plan.problem_set.best_plans import BestPlan, BestPlans
from ffsr_plan.problem_set.judging.judged_folder import judge_folder
from ffsr_plan.problem_set.judging.result_files import (
    Judged,
    JudgedRow,
    read_judged,
    write_judged,
)
from ffsr_plan.problem_set.report.profiles import (
    cost_over_time,
    performance_profile,
    success_over_time,
)
from ffsr_plan.problem_set.report.summary import compared, family_table, in_common, in_time
from ffsr_plan.problem_set.running.bench_run import planner_named
from tests.problem_set.conftest import SMALL


def bench(*arguments):
    return CliRunner().invoke(app, ["bench", *map(str, arguments)], env={"COLUMNS": "200"})


def row(problem, seconds=1.0, objective=2.0, **more):
    """A judged row; without F it was refused."""
    curve = () if objective is None else ((seconds, objective),)
    fields = {"family": problem.split("/")[0], "seed": 0, "accepted": objective is not None}
    reason = "" if objective is not None else "in contact at 1 s"
    fields |= {"reason": reason, "seconds": seconds, "time_limit": 10.0, "curve": curve}
    return JudgedRow(problem, **fields | {"objective": objective, "length": objective} | more)


def test_a_run_writes_results_that_the_judge_accepts_again(small_run, tmp_path):
    folder, printed = small_run
    assert "2 of 2" in printed
    judged = read_judged(folder)
    assert sorted(each.problem for each in judged.rows) == sorted(SMALL)
    copy = tmp_path / "copy"
    shutil.copytree(folder, copy)
    (copy / "judged.json").unlink()
    assert bench("judge", copy).exit_code == 0
    again = {each.problem: each for each in read_judged(copy).rows}
    for each in judged.rows:
        assert again[each.problem].objective == pytest.approx(each.objective, rel=1e-9)
        costs = [cost for _, cost in each.curve]
        assert costs == sorted(costs, reverse=True)
        assert costs[-1] == pytest.approx(each.objective)


def test_a_second_run_plans_nothing_again(small_run):
    folder, _ = small_run
    before = read_judged(folder)
    done = bench("run", "--problem", SMALL[0], "--problem", SMALL[1], "--time", 3, "--out", folder)
    assert done.exit_code == 0
    assert read_judged(folder) == before  # times included, which another plan would not have


def test_results_are_compared_and_drawn(small_run, tmp_path):
    folder, _ = small_run
    judged = read_judged(folder)
    worse = [row(each.problem, 2.0, 1.25 * each.objective) for each in judged.rows]
    write_judged(tmp_path / "other", Judged("other", judged.set_version, tuple(worse)))
    shown = bench("compare", folder, tmp_path / "other")
    assert shown.exit_code == 0
    assert "1.250" in shown.output
    page = tmp_path / "bench.html"
    assert bench("report", folder, tmp_path / "other", "--out", page).exit_code == 0
    text = page.read_text()
    assert text.count("<svg") == 6
    assert "<script" not in text  # and pictures are in the page
    assert "src=" not in text
    assert bench("report", folder, "--out", page).exit_code == 2  # not without --force


def test_lists_and_schemas_are_printed():
    assert "remounted" in bench("list").output
    assert "traps/07" in bench("list", "--family", "traps").output
    assert json.loads(bench("schema", "results").output)["title"] == "ffsr-plan results"
    data = json.loads(bench("list", "--json").output)
    assert sum(int(each["number"]) for each in data["table"]["rows"]) >= 300


@pytest.mark.parametrize(
    "wrong",
    [
        ("run", "--planner", "rrt"),
        ("run", "--problem", "paper/03", "--seeds", "0"),
        ("run", "--problem", "paper/03", "--seed", "-1"),
        ("run", "--family", "trapz"),
        ("run", "--problem", "traps/99"),
        ("compare", "nowhere", "nowhere"),
        ("judge", "nowhere"),
        ("schema", "plan"),
    ],
)
def test_bad_input_has_status_2(wrong, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert bench(*wrong).exit_code == 2


def test_tables_of_many_columns_fit_a_terminal_of_80(small_run, problems, best):
    judged, shown = read_judged(small_run[0]), Console(width=80, record=True, file=io.StringIO())
    for table in (family_table(judged, problems, best), compared(judged, judged, problems)):
        shown.print(printed_table(table))
        text = shown.export_text()
        assert all(word in text for heading in table.headings for word in heading.split())
        assert all(cell in text for cells in table.rows for cell in cells)


def test_pictures_are_of_the_tasks_that_all_planners_have():
    first = Judged("one", "1", (row("traps/00"), row("traps/01")))
    second = Judged("other", "1", (row("traps/01"),))
    assert [[each.problem for each in made.rows] for made in in_common([first, second])] == [
        ["traps/01"],
        ["traps/01"],
    ]
    third = Judged("third", "1", (row("traps/02"),))
    assert in_common([first, third]) == [first, third]


def test_results_of_another_planner_are_not_replaced(small_run, tmp_path):
    folder, _ = small_run
    before = (folder / "results.json").read_bytes()
    again = ("run", "--problem", SMALL[0], "--time", 3)
    done = bench(*again, "--planner", "portfolio", "--out", folder)
    assert done.exit_code == 2
    assert "'default'" in done.output
    by_hand = tmp_path / "by-hand"
    by_hand.mkdir()
    (by_hand / "results.json").write_bytes(before)
    assert bench(*again, "--out", by_hand).exit_code == 2
    assert bench(*again, "--out", folder).exit_code == 0
    assert (folder / "results.json").read_bytes() == before  # those of the other problem stay


def test_one_task_has_one_result(small_run, tmp_path, problems):
    folder, _ = small_run
    data = json.loads((folder / "results.json").read_text())
    for rows, message in (([], "at least one"), (data["results"] * 2, "one for each problem")):
        (tmp_path / "results.json").write_text(json.dumps(data | {"results": rows}))
        with pytest.raises(fp.InvalidInput, match=message):
            judge_folder(tmp_path, problems)


def test_planners_are_known_by_name():
    assert planner_named(None).name == "default"
    assert planner_named("tree-planner").name == "tree-planner"
    assert planner_named("ompl-bitstar-straight").name == "ompl-bitstar-straight"
    with pytest.raises(fp.InvalidInput, match="ompl-rrtconnect-at-rest"):
        planner_named("ompl-rrtconnect")


def test_profiles_count_what_no_one_else_solves():
    one = {("a", 0): 1.0, ("b", 0): 4.0, ("c", 0): np.inf, ("d", 0): np.inf}
    other = {("a", 0): 2.0, ("b", 0): 2.0, ("c", 0): 3.0, ("d", 0): np.inf}
    found = performance_profile({"one": one, "other": other})
    assert found == {"one": [1.0, 2.0, np.inf], "other": [1.0, 1.0, 2.0]}


def test_success_counts_the_tasks_without_a_path():
    times, shares = success_over_time([row("traps/00", 3.0), row("traps/01", 1.0, None)])
    assert (times, shares) == ([3.0], [0.5])


def test_costs_over_time_are_infinite_before_the_first_path(tmp_path):
    best = BestPlans(tmp_path)
    for name in ("traps/00", "traps/01", "traps/02"):
        best.put(BestPlan(name, 1.0, "straight way", objective=2.0), None)
    rows = [
        row("traps/00", curve=((1.0, 6.0), (2.0, 3.0))),
        row("traps/01", curve=((1.0, 4.0),)),
        row("traps/02", 1.0, None),
    ]
    found = cost_over_time(rows, best, np.array([0.5, 1.0, 2.0]))
    assert found[:, 1].tolist() == [np.inf, 3.0, 2.0]
    assert found[:, 2].tolist() == [np.inf, np.inf, np.inf]  # a third has no path


def test_late_paths_are_not_in_time():
    assert in_time(row("traps/00", 10.4))
    assert not in_time(row("traps/00", 10.6))
    assert not in_time(row("traps/00", 1.0, None))


def test_results_of_other_versions_are_not_compared(problems):
    one = Judged("one", "1", (row("traps/00"),))
    with pytest.raises(fp.InvalidInput, match="version"):
        compared(one, Judged("two", "2", (row("traps/00"),)), problems)
    with pytest.raises(fp.InvalidInput, match="in common"):
        compared(one, Judged("two", "1", (row("traps/01"),)), problems)
