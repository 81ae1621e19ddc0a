"""`warm_up` loads or compiles whatever kernel the planners and the verification call."""

import os
import subprocess
import sys

import pytest

import ffsr_plan as fp
from tests.helpers.sample_sizes import LONG

PROGRAM = """
import importlib, pkgutil, sys
from contextlib import suppress
from dataclasses import replace
import ffsr_plan as fp
from ffsr_plan.core.kernels.compilation import Kernel
from ffsr_plan.display.figures import figure_files

def known():
    modules = [m for n, m in sys.modules.items() if n.startswith("ffsr_plan.")]
    kernels = {id(k): k for m in modules for k in vars(m).values() if isinstance(k, Kernel)}
    made = [k for k in kernels.values() if "dispatcher" in vars(k)]
    return {(k.__module__, k.__name__, str(s)) for k in made for s in k.dispatcher.overloads}

fp.warm_up()
before = known()
for name in sys.argv[1:]:
    scenario = fp.Scenario.load(name)
    if scenario.problem.reach_attitude:  # without a lattice by closed loops of the joints
        with suppress(fp.PlanningError):
            fp.plan(replace(scenario.problem, lattice=None), fp.TreePlanner(checks=20_000))
    if scenario.problem.lattice.progress:
        fp.plan(scenario.problem, "lattice-optimum").verify(5)
        print(name, sorted(known() - before))
        continue
    quick = [fp.MaxMinAntSystem(ants=3, cycles=2), fp.AntSystem(ants=3, cycles=2)]
    if scenario.problem.lattice.postures:
        quick = [fp.PostureAnnealing(ants=3, cycles=2, annealing_shifts=3000)]
    else:
        quick.append(fp.LatticeOptimum())
    for planner in quick:
        try:
            plan = fp.plan(scenario.problem, planner)
        except fp.PlanningError:
            continue
        plan.verify(5)
        mode, limits = plan.problem.mode, {"joint_acceleration": 1.0}
        limits |= {"thruster_acceleration": 1.0} if mode.has_thrusters else {}
        limits |= {"turn_acceleration": 1.0} if mode.has_wheels else {}
        plan.timed(**limits)
        figure_files(plan)
    print(name, sorted(known() - before))
"""


NAMES = (
    "fig2a", "gate", "debris", "door", "tumbling", "fig2b", "inspection", "ring", "double_gate",
    "spatial_turn",
)  # fmt: skip


@pytest.mark.slow
def test_no_bundled_scenario_needs_another_kernel():
    command = [sys.executable, "-c", PROGRAM, *NAMES]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines() == [f"{name} []" for name in NAMES]


@pytest.mark.slow
def test_what_is_warm_is_not_compiled_again(tmp_path):
    # kernels that earlier tests have compiled stay as they are, unless all of it is wanted
    folder = {"NUMBA_CACHE_DIR": str(tmp_path)} if LONG else {}
    command = [sys.executable, "-c", "import ffsr_plan as fp; print(fp.warm_up())"]
    first, second = (
        subprocess.run(command, env={**os.environ, **folder}, capture_output=True, text=True)
        for _ in range(2)
    )
    assert int(first.stdout) > (20 if LONG else -1)
    assert (second.stdout, second.stderr) == ("0\n", "")


def test_progress_ends_at_one():
    shares = []
    fp.warm_up(shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    with pytest.raises(fp.InvalidInput, match="on_progress"):
        fp.warm_up("yes")
