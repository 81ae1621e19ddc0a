"""Runs `ffsr-plan plan` on mutated scenarios, each under a limit of memory and time.

A program for a process of its own, because the limit of memory holds for all of it:
`python -m tests.helpers.mutated_scenario_runs SEED COUNT FOLDER` prints one JSON line a run.
"""

import json
import os
import resource
import signal
import sys
import time
from pathlib import Path

import numpy as np
from typer.testing import CliRunner

from ffsr_plan.cli import planning
from ffsr_plan.cli.commands import app
from ffsr_plan.core import bundled_files, cost_estimate
from tests.helpers.mutated_toml import mutated, text_of
from tests.helpers.urdf_distances import least_distances

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MOST_BYTES, MOST_SECONDS = 2_000_000_000, 20
SAMPLES = 60
SHORT = {"ants": 3, "cycles": 2}
PLANS = []


def base_scenarios():
    """The bundled scenarios with short searches."""
    for path in sorted(bundled_files.folder("scenarios").glob("*.toml")):
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        if "lattice" not in data:
            yield data | {"planner": {"checks": 20_000}}
            continue
        postures = bool(data["lattice"].get("postures"))
        if path.stem == "spatial_turn":
            data["lattice"]["divisions"] = 8
            for axis in data["lattice"]["postures"]:
                axis["half_count"] = 1
        data["planner"] = SHORT | ({"annealing_shifts": 5} if postures else {})
        yield data


def record(plan, shown):
    """Keep the plan that the command would print."""
    PLANS.append(plan)
    return shown


def limit_memory():
    with open("/proc/self/statm", encoding="ascii") as file:
        now = int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    resource.setrlimit(resource.RLIMIT_AS, (now + MOST_BYTES, now + MOST_BYTES))


def stop(*_):
    raise TimeoutError(f"more than {MOST_SECONDS} s")


def agrees(plan):
    """Whether sampled distances are not below what the plan claims to be proven."""
    problem = plan.problem
    robot, scene = problem.robot, problem.scene
    least = np.inf
    for q in plan.at(np.linspace(0.0, 1.0, SAMPLES))[:, None]:  # one at a time, to save memory
        parts = robot.components(q)
        here = (parts.position, q[:, 3:7], parts.joints)
        least = min(least, least_distances(robot.urdf, *here, scene.centers, scene.radii)[0])
    claimed = plan.certificate.least_clearance
    return bool(least > 0.0 and (claimed <= least + 1e-6 or not np.isfinite(least)))


def run(text, path):
    """Exit status, output, time and whether the plan is right."""
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    PLANS.clear()
    signal.setitimer(signal.ITIMER_PROF, MOST_SECONDS)
    begin = time.process_time()
    try:
        options = ["--no-verify", "--no-refine", "--time-limit", "2"]
        result = CliRunner().invoke(app, ["plan", str(path), *options], catch_exceptions=True)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    escaped = result.exception
    return {
        "status": result.exit_code,
        "output": " ".join(result.output.split()),
        "escaped": "" if isinstance(escaped, (SystemExit, type(None))) else repr(escaped),
        "seconds": time.process_time() - begin,
        "agrees": agrees(PLANS[0]) if PLANS else None,
    }


def main(seed, count, folder):
    table = planning.plan_table
    planning.plan_table = lambda title, plan, *rest: record(plan, table(title, plan, *rest))
    signal.signal(signal.SIGPROF, stop)
    rng = np.random.default_rng(seed)
    bases = list(base_scenarios())
    whole = [run(text_of(base), folder / "whole.toml") for base in bases]
    cost_estimate.MOST_SECONDS = 5.0  # what is estimated to be less has to end in time
    limit_memory()
    for outcome in whole:
        print(json.dumps({"text": "", **outcome}), flush=True)
    for _ in range(count):
        text = mutated(bases[int(rng.integers(len(bases)))], rng)
        print(json.dumps({"text": text, **run(text, folder / "mutated.toml")}), flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3]))
