"""What a user waits for at a terminal: an import, the help, a command from its call to its end."""

import subprocess
import sys
from pathlib import Path

import pytest

import ffsr_plan as fp
from benchmarks.speed.reference import Reference, record

COMMAND = str(Path(sys.executable).with_name("ffsr-plan"))


@pytest.fixture(scope="module")
def reference(problem):
    return Reference(problem)


def timed(benchmark, reference, command, rounds, **options):
    """Run a command several times; all of them have to end well."""

    def run():
        subprocess.run(command, check=True, capture_output=True, **options)

    run()  # what is compiled is kept
    benchmark.pedantic(run, rounds=rounds)
    record(benchmark, reference)


def test_import(benchmark, reference):
    timed(benchmark, reference, [sys.executable, "-c", "import ffsr_plan"], 9)


def test_command_help(benchmark, reference):
    timed(benchmark, reference, [COMMAND, "--help"], 9)


def test_command_that_plans_inspection(benchmark, reference, tmp_path):
    """4748 spheres, a UR5: search, proof, verification, pictures and page."""
    timed(benchmark, reference, [COMMAND, "plan", "inspection"], 3, cwd=tmp_path)


def test_first_plan_of_an_installation(benchmark, reference, tmp_path):
    """`plan` of a scenario without any machine code on disk."""
    program = "import ffsr_plan as fp; fp.plan(fp.load_scenario('fig2a'))"
    folders = iter(tmp_path / str(k) for k in range(1))

    def run(folder):
        subprocess.run(
            [sys.executable, "-c", program],
            check=True,
            capture_output=True,
            env={"NUMBA_CACHE_DIR": str(folder), "PATH": "", "PYTHONPATH": ROOT},
        )

    benchmark.pedantic(run, setup=lambda: ((next(folders),), {}), rounds=1)
    record(benchmark, reference)


ROOT = str(Path(fp.__file__).parents[1])
