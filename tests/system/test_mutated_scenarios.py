"""Mutated scenarios end in a plan that holds by other formulas, or in one sentence."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.helpers.mutated_scenario_runs import MOST_SECONDS
from tests.helpers.sample_sizes import sample

SEED, COUNT = 12, sample(80, 380)
ENOUGH = COUNT // 6  # plans, and refusals; else the mutations are too coarse or too fine


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory):
    program = [sys.executable, "-m", "tests.helpers.mutated_scenario_runs", str(SEED), str(COUNT)]
    done = subprocess.run(
        [*program, str(tmp_path_factory.mktemp("scenarios"))],
        cwd=Path(__file__).parents[2],
        env=os.environ | {"COLUMNS": "100000", "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return [json.loads(line) for line in done.stdout.splitlines()]


def test_every_mutation_is_run(outcomes):
    assert sum(bool(outcome["text"]) for outcome in outcomes) == COUNT


def test_no_mutation_ends_in_an_error_of_the_program(outcomes):
    for outcome in outcomes:
        assert not outcome["escaped"], outcome
        assert outcome["status"] in (0, 1, 2), outcome
        assert outcome["seconds"] < MOST_SECONDS, outcome


def test_plans_of_mutated_scenarios_hold_by_other_formulas(outcomes):
    plans = [outcome for outcome in outcomes if outcome["status"] == 0]
    assert len(plans) >= ENOUGH
    for outcome in plans:
        assert outcome["agrees"] is True, outcome


def test_refusals_are_one_sentence(outcomes):
    refused = [outcome["output"] for outcome in outcomes if outcome["status"] == 2]
    assert len(refused) >= ENOUGH
    for output in refused:
        sentence = output[output.index("ffsr-plan: ") :].removeprefix("ffsr-plan: ")
        assert ": got " in sentence, output
        assert "; allowed: " in sentence, output
        assert sentence.count("ffsr-plan: ") <= 1, output
        assert "Traceback" not in output
        assert len(output) < 3000
