"""`ffsr-plan plan --out`, stopped at any moment, leaves whole files and the documented status."""

import random
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

import ffsr_plan as fp
from ffsr_plan.cli.console.result_files import RESULTS, write_results
from tests.cli.test_commands import QUICK
from tests.helpers.sample_sizes import sample

MOMENTS = sample(4, 20)
ENDLESS = '[planner]\nname = "ant-system"\nants = 3000\ncycles = 100000\nrho = 0.999999\n'
OPTIONS = ("--out", "results", "--force", "--time-limit", "30")
COMMAND = (
    "import sys, ffsr_plan_command as command\n"
    "print('begun', flush=True)\n"
    "sys.argv[0] = 'ffsr-plan'\n"
    "command.main()\n"
)


def begun(folder, *arguments):
    """A process that has begun to load the command line."""
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND, *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "begun\n"
    return process


def ended(process):
    _, err = process.communicate(timeout=120)
    assert "Traceback" not in err
    return process.returncode


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Two folders with results of the title "old", and how long it takes to make them [s]."""
    made, seconds = [], 0.0
    for name in ("one", "two"):
        folder = tmp_path_factory.mktemp(name)
        (folder / "old.toml").write_text(QUICK.replace('"quick"', '"old"'))
        (folder / "new.toml").write_text(QUICK.replace('"quick"', '"new"'))
        (folder / "endless.toml").write_text(QUICK.replace('"quick"', '"new"') + ENDLESS)
        begin = time.monotonic()
        assert ended(begun(folder, "plan", "old.toml", *OPTIONS)) == 0
        seconds = time.monotonic() - begin
        made.append(folder)
    return made, seconds


def generation(results):
    """Whether the files are `old` or `new`, after a check that each of them is whole."""
    for name in RESULTS:
        end = (results / name).read_bytes()[-12:]
        whole = end.endswith(b"</html>\n") if name.endswith("html") else True
        assert whole if not name.endswith("png") else end[4:8] == b"IEND", name
    page = (results / "plan.html").read_text()
    title = "new" if '{"title": "new"' in page else "old"
    assert f'{{"title": "{title}"' in page
    return fp.Plan.load(results / "plan.json"), title


def stopped(folder, number, scenario, moment):
    """Status, plan and title after a signal at a moment; the old results are put back."""
    results = folder / "results"
    before = {name: (results / name).read_bytes() for name in RESULTS}
    process = begun(folder, "plan", scenario, "--seed", "5", *OPTIONS)
    time.sleep(moment)
    process.send_signal(number)
    try:
        status = ended(process)
        return status, *generation(results)
    finally:
        for name, content in before.items():
            (results / name).write_bytes(content)


def at_all_moments(folders, number, scenario, count, seed):
    """Results of `stopped` at random moments, two processes at a time."""
    rng, (places, seconds) = random.Random(seed), folders
    moments = [rng.uniform(0.0, seconds) for _ in range(count)]
    with ThreadPoolExecutor(2) as pool:
        runs = [
            pool.submit(
                lambda k=k: [stopped(places[k], number, scenario, m) for m in moments[k::2]]
            )
            for k in range(2)
        ]
        return [result for run in runs for result in run.result()]


@pytest.mark.slow
@pytest.mark.parametrize("scenario", ["new.toml", "endless.toml"])
def test_ctrl_c_leaves_old_or_new_results(folders, scenario):
    met = at_all_moments(folders, signal.SIGINT, scenario, MOMENTS // 2, 1)
    for status, plan, title in met:
        assert (status, title) in ((0, "new"), (130, "old"), (130, "new"))
        assert plan.seed == (5 if title == "new" else 0)
        if scenario == "endless.toml" and title == "new":
            assert plan.interrupted


@pytest.mark.slow
def test_a_kill_leaves_whole_files(folders):
    met = at_all_moments(folders, signal.SIGKILL, "new.toml", MOMENTS, 2)
    assert {status for status, _, _ in met} <= {0, -signal.SIGKILL}
    assert {plan.seed for _, plan, _ in met} <= {0, 5}


def test_ctrl_c_ends_a_view_as_it_should(tmp_path):
    fp.plan(fp.load_scenario("fig2b"), fp.AntSystem(cycles=2)).save(tmp_path / "plan.json")
    process = begun(tmp_path, "view", "plan.json", "--no-browser")
    assert "until Ctrl-C" in process.stdout.readline()
    process.send_signal(signal.SIGINT)
    assert ended(process) == 0


def test_results_that_cannot_be_written_keep_the_plan_and_the_old_results(tmp_path, monkeypatch):
    problem = fp.load_scenario("fig2b")
    old, new = (fp.plan(problem, fp.AntSystem(cycles=2), seed, refine=False) for seed in (0, 1))
    write_results(old, "old", tmp_path)
    before = {name: (tmp_path / name).read_bytes() for name in RESULTS}

    def failing(_):
        raise OSError("no pictures today")

    monkeypatch.setattr("ffsr_plan.display.figures.figure_files", failing)
    with pytest.raises(OSError, match="no pictures"):
        write_results(new, "new", tmp_path)
    assert {name: (tmp_path / name).read_bytes() for name in RESULTS} == before
    assert fp.Plan.load(tmp_path / "plan.json-2") == new


def test_results_replace_one_another_all_at_once(tmp_path, monkeypatch):
    plan = fp.plan(fp.load_scenario("fig2b"), fp.AntSystem(cycles=2), refine=False)
    (tmp_path / "path.png").mkdir()
    with pytest.raises(fp.InvalidInput, match=r"--out: got '.*path\.png'"):
        write_results(plan, "title", tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["path.png", "plan.json"]
