"""Side by side with OMPL without a lattice: same space, distances and length, flown with reaction.

    python -m benchmarks.studies.general.ompl_free_space

needs `pip install ompl==2.0.1`. OMPL's states are base position and joints; they cannot carry the
attitude, which depends on the path. So it is assumed (`assumed_attitudes.py`), and the paths are
then flown by the integrator of `tests/helpers/dense_flight.py`, with the true reaction.
"""

import argparse
import sys
import time
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import ompl.base as ob
import ompl.geometric as og
import ompl.util as ou

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.studies.general.assumed_attitudes import HELD, STRAIGHT, Checker
from benchmarks.studies.general.free_space import problems
from tests.helpers.dense_flight import flown, least_gap

STEP, FINE = 0.02, 0.002  # [m or rad] between checks of OMPL's ways, and when checked again
OPTIMISING = ("BITstar", "InformedRRTstar")
CHECKS_A_SECOND = 240_000  # of our planner
OURS = "TreePlanner"


class Run(NamedTuple):
    """One run; the path is that of states (n, D), None without one."""

    planner: str
    assumed: str
    seconds: float
    path: np.ndarray | None
    length: float
    assumed_clear: bool = True
    depth: float = -np.inf
    touching: bool = False


class Ways(ob.MotionValidator):
    """OMPL's validator of ways: one call of compiled code for each."""

    def __init__(self, information, checker):
        super().__init__(information)
        self._checker, self._size = checker, len(checker.free)

    def checkMotion(self, begin, end, *last):  # noqa: N802 - OMPL's name
        """Whether the way between two states is clear; OMPL calls it."""
        both = [self._checker.state([s[k] for k in range(self._size)]) for s in (begin, end)]
        return not last and self._checker.clear(*both, STEP)


def until(moment):
    """End a run by its processor time, which other processes do not affect."""
    return ob.PlannerTerminationCondition(lambda: time.process_time() >= moment)


def setup_of(checker, planner):
    """OMPL's setup of a problem; its length is L, Euclidean in positions and joints."""
    size = len(checker.free)
    space, bounds = ob.RealVectorStateSpace(size), ob.RealVectorBounds(size)
    for k, (low, high) in enumerate(checker.bounds.T):
        bounds.setLow(k, low)
        bounds.setHigh(k, high)
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    information = setup.getSpaceInformation()

    def valid(state):
        full = checker.state([state[k] for k in range(size)])
        return checker.clear(full, full, STEP)

    setup.setStateValidityChecker(valid)
    information.setMotionValidator(Ways(information, checker))
    start, goal = space.allocState(), space.allocState()
    for k, column in enumerate(checker.free):
        start[k] = checker.space.start[column]
        goal[k] = checker.space.goals[0][column]
    setup.setStartAndGoalStates(start, goal)
    setup.setOptimizationObjective(ob.PathLengthOptimizationObjective(information))
    setup.setPlanner(getattr(og, planner)(information))
    setup.setup()
    return setup


def solution(setup, checker):
    """(n, D) states of the path, or None."""
    if not setup.haveExactSolutionPath():
        return None
    size = len(checker.free)
    states = setup.getSolutionPath().getStates()
    return np.array([checker.state([s[k] for k in range(size)]) for s in states])


def judged(problem, checker, run):
    """The run with what its path meets: at the assumed attitude, and when flown."""
    if run.path is None:
        return run
    motion = SimpleNamespace(
        positions=run.path[:, :3], joint_values=run.path[:, 4:], turn_shares=None
    )
    plan = SimpleNamespace(problem=problem, motion=motion)
    least, touching = least_gap(plan, flown(plan).path)
    held = all(checker.clear(a, b, FINE) for a, b in pairwise(run.path))
    length = float(np.linalg.norm(np.diff(run.path, axis=0), axis=1).sum())
    return run._replace(assumed_clear=held, depth=-least, touching=touching, length=length)


def ompl_runs(problem, assumed, seconds):
    """RRTConnect, plain and simplified, and the optimising planners."""
    checker = Checker(problem, assumed)
    if not checker.clear(checker.space.goals[0], checker.space.goals[0], STEP):
        names = ("RRTConnect", "RRTConnect, simplified", *OPTIMISING)
        yield from (Run(name, assumed, np.inf, None, np.inf) for name in names)
        return
    setup, begin = setup_of(checker, "RRTConnect"), time.process_time()
    setup.solve(until(begin + seconds))
    spent, path = time.process_time() - begin, solution(setup, checker)
    yield judged(problem, checker, Run("RRTConnect", assumed, spent, path, np.inf))
    if path is not None:
        setup.simplifySolution()
        spent, path = time.process_time() - begin, solution(setup, checker)
    yield judged(problem, checker, Run("RRTConnect, simplified", assumed, spent, path, np.inf))
    for planner in OPTIMISING:
        setup, begin = setup_of(checker, planner), time.process_time()
        setup.solve(until(begin + seconds))
        spent, path = time.process_time() - begin, solution(setup, checker)
        yield judged(problem, checker, Run(planner, assumed, spent, path, np.inf))


def our_runs(problem, seconds):
    """The first path, and that after about as much time."""
    longer = fp.TreePlanner(checks=int(CHECKS_A_SECOND * seconds))
    for name, planner, end in (("first path", None, "first"), (f"{seconds:g} s", longer, "end")):
        begin, label = time.process_time(), f"{OURS}, {name}"
        try:
            plan = fp.plan(problem, planner, seed=0, until=end)
        except fp.PathNotFound:
            yield Run(label, "carried", time.process_time() - begin, None, np.inf)
            continue
        spent = time.process_time() - begin
        least, touching = least_gap(plan, flown(plan).path)
        path = plan.motion.joint_values
        yield Run(label, "carried", spent, path, plan.length, True, -least, touching)


def rows_of(runs, best):
    """One row for each planner and assumption; `best` is our length by problem."""
    groups = {}
    for key, run in runs:
        groups.setdefault((run.planner, run.assumed), []).append((key, run))
    for (planner, assumed), group in groups.items():
        found = [(key, run) for key, run in group if run.path is not None]
        hits = [run for _, run in found if run.depth >= 0.0 or run.touching]
        usable = [(key, run) for key, run in found if run.depth < 0.0 and not run.touching]
        ratios = [run.length / best[key] for key, run in found if key in best]
        deepest = max((1e3 * run.depth for run in hits), default=0.0)
        yield [
            planner,
            assumed,
            f"{len(found)} of {len(group)}",
            f"{np.median([run.seconds for _, run in found]):.2f}" if found else "",
            f"{np.median(ratios):.2f}" if ratios else "",
            f"{sum(not run.assumed_clear for _, run in found)}",
            f"{len(hits)}" + (f" ({deepest:.0f} mm)" if hits else ""),
            f"{len(usable)} of {len(group)}",
        ]


HEAD = (
    "planner; attitude; paths found; processor time, median [s]; L against ours, median; "
    "collide as assumed; collide when flown (deepest); free when flown"
)
NOTES = f"""
- Comparable: the space (base position in the problem's window, joints in their limits), the
  compiled distances to spheres and between links, a margin of 1 mm, the length L, and the flight by
  which all paths are judged: it samples every .02 rad and .01 m and uses neither planner nor proof.
- Attitude: held as at the start, or that of the straight flight from the start to each state. The
  second is exact for states on the first edge of a path only. A planner whose states carry no
  attitude can hardly do better; `{OURS}` carries the true one along its trees.
- Not comparable: times. OMPL's ways are checked at states {STEP:g} (m or rad) apart, by one call
  from OMPL into Python and from there into compiled code for each way; `{OURS}` is compiled as a
  whole, and its time includes the proof. OMPL's settings are its defaults.
- Collide as assumed: the path collides at the attitude that was assumed, checked every {FINE:g};
  that is what the spacing of checks misses. The other collisions are due to the reaction.
- Where the goal is not free at the attitude assumed there is nothing to search: not found. L is
  that of all paths found, also of those that collide when flown.
- The first path of `{OURS}` may take the default number of checks; the other row has
  {CHECKS_A_SECOND:,} a second of the limit, and finds nothing where these are too few for a path.
- The optimising planners run for the whole time. OMPL's Python package 2.0.1 does not offer AIT*;
  InformedRRTstar is in its place.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=6, help="problems of each kind")
    parser.add_argument("--seconds", type=float, default=3.0, help="longest run of a planner")
    parser.add_argument("--out", type=Path, default=RESULTS / "ompl_free_space.md")
    args = parser.parse_args()
    begin = time.process_time()
    ou.setLogLevel(ou.LogLevel.LOG_ERROR)
    ou.RNG.setSeed(1)
    for problem in (problems(1, 1)[0], problems(4, 1)[0]):  # compiles
        fp.plan(problem, until="first")
        for assumed in (HELD, STRAIGHT):
            checker = Checker(problem, assumed)
            checker.clear(checker.space.start, checker.space.start, STEP)
    runs = []
    for kind in range(1, 6):
        for number, problem in enumerate(problems(kind, args.count)):
            found = list(our_runs(problem, args.seconds))
            for assumed in (HELD, STRAIGHT):
                found += ompl_runs(problem, assumed, args.seconds)
            runs += [((kind, number), run) for run in found]
            spent = time.process_time() - begin
            print(f"kind {kind}, problem {number}: {spent:.0f} s", file=sys.stderr, flush=True)
    last = f"{OURS}, {args.seconds:g} s"
    best = {key: run.length for key, run in runs if run.planner == last and run.path is not None}
    spent = (time.process_time() - begin) / 60.0
    options = f"--count {args.count} --seconds {args.seconds:g}"
    text = f"""# Side by side with OMPL, without a lattice

`python -m benchmarks.studies.general.ompl_free_space {options}`

The first {args.count} problems of kinds 1 to 5 of `problems.json`; at most {args.seconds:g} s a
run, OMPL 2.0.1. Times are processor time of one thread; {spent:.0f} minutes in all.

{table(HEAD.split("; "), rows_of(runs, best))}
{NOTES}"""
    publish(text, args.out)


if __name__ == "__main__":
    main()
