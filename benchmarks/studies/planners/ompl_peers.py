"""Comparison with OMPL's planners on the problem set: times, lengths, verified collisions.

    python -m benchmarks.studies.planners.ompl_peers

needs `pip install ompl==2.0.1`. The problems are those of family `paper`. All planners work
in one plane, (progress [m], lateral offset [m]), with the same whole-body configuration at every
point and the same distances.
"""

import argparse
import sys
import time
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import ompl.base as ob
import ompl.geometric as og
import ompl.util as ou

import ffsr_plan as fp
from benchmarks.paper_scenes import NUMBERS, add_problems_option, paper_problem, problem_name
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import Placements, shape_placements
from ffsr_plan.verification.urdf_reading import Bodies, pose
from tests.helpers.solid_distances import sphere_distance

SEED = 2000  # of OMPL's generator
DEFAULT, FINE = 0.01, 0.002  # of the plane's diagonal between two validity checks
OPTIMISING = ("RRTstar", "InformedRRTstar", "BITstar")
OURS = "plan() (default)"
STEP = 5e-4  # [m] of the re-check
CHUNK = 500  # points at a time
SAME = 1e-3  # lengths closer than this, relative, count as equal


class Plane:
    """The plane of a problem: OMPL's validity checker, and the check in closed form."""

    def __init__(self, problem):
        self.problem, axis = problem, problem.lattice.lateral
        lattice = fp.LayeredLattice(problem)
        self.nominal, self.aside = lattice.nominal, lattice.directions[0]
        self.along = float(np.linalg.norm(problem.base_displacement))
        self.window = axis.half_count * axis.spacing
        self.bodies = Bodies(problem.robot.urdf)
        self.query = ObstacleQuery(problem.robot, problem.scene)
        # OMPL queries one point at a time; a table keeps the time spent in Python small
        self.cells = 20_000
        points = np.linspace(0.0, self.along, self.cells + 1)
        table = self.configurations(np.column_stack([points, np.zeros_like(points)]))
        self.frames = shape_placements(problem.robot, table).frames
        self.rises = np.diff(self.frames, axis=0, append=self.frames[-1:])
        self.place = np.zeros(1, np.int64)

    def configurations(self, points):
        """(N, nq) at points (N, 2) of the plane, attitude by reaction."""
        divisions = self.problem.lattice.divisions
        scaled = np.clip(points[:, 0] / self.along, 0.0, 1.0) * divisions
        edge = np.minimum(scaled.astype(np.int64), divisions - 1)
        q = self.nominal.at(edge, scaled - edge)
        q[:, :3] += points[:, 1:] * self.aside
        return q

    def valid(self, state):
        """Whether a state of OMPL keeps clear of the obstacles."""
        scaled = state[0] / self.along * self.cells
        cell = int(scaled)
        row = slice(cell, cell + 1)
        placed = Placements(self.frames[row] + (scaled - cell) * self.rises[row])
        shift = state[1] * self.aside[None]
        return bool(self.query.closed_at(placed, self.place, shift)[0] > 0.0)

    def depth(self, path):
        """Deepest penetration [m] along corners (N, 2), every STEP in closed form; < 0 if free."""
        corners = [
            a + np.linspace(0.0, 1.0, int(np.linalg.norm(b - a) / STEP) + 2)[:, None] * (b - a)
            for a, b in pairwise(path)
        ]
        points = np.concatenate(corners)
        return max(self._depth(points[i : i + CHUNK]) for i in range(0, len(points), CHUNK))

    def _depth(self, points):
        scene, robot, deepest = self.problem.scene, self.problem.robot, -np.inf
        q = self.configurations(points)
        joints = dict(zip(robot.joint_names, robot.joint_values(q).T, strict=True))
        poses = self.bodies.link_poses(pose(q[:, :3], q[:, 3:7]), joints)
        for shape in self.bodies.shapes:
            placed = poses[shape.link] @ shape.placement
            first = placed[0, :3, 3]
            size = float(np.linalg.norm(shape.points, axis=1).max()) + shape.swell
            reach = size + np.linalg.norm(placed[:, :3, 3] - first, axis=1).max()
            near = np.linalg.norm(scene.centers - first, axis=1) <= scene.radii + reach
            if near.any():
                apart = sphere_distance(shape, placed, scene.centers[near], scene.radii[near])
                deepest = max(deepest, -float(apart.min()))
        return deepest


@dataclass
class Run:
    """The path of one planner for one problem after some time; None if it has no path.

    Attributes:
        number: of the problem in family `paper`.
        planner: name of the planner.
        resolution: OMPL's edge resolution, relative to the plane's diagonal; None if proven.
        budget: time after which the planner was stopped [s], if it was.
        seconds: processor time [s].
        path: (N, 2) corners in the plane [m].
        depth: deepest penetration along the path [m].
    """

    number: int
    planner: str
    resolution: float | None
    budget: float | None
    seconds: float
    path: np.ndarray | None
    depth: float = -np.inf

    @property
    def length(self):
        """Length of the base's track [m]."""
        return float(np.linalg.norm(np.diff(self.path, axis=0), axis=1).sum())

    @property
    def clean(self):
        """Whether there is a path without a collision at any sample."""
        return self.path is not None and self.depth < 0.0


def ompl_setup(plane, planner, resolution):
    space, bounds = ob.RealVectorStateSpace(2), ob.RealVectorBounds(2)
    for axis, (low, high) in enumerate([(0.0, plane.along), (-plane.window, plane.window)]):
        bounds.setLow(axis, low)
        bounds.setHigh(axis, high)
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    information = setup.getSpaceInformation()
    setup.setStateValidityChecker(plane.valid)
    information.setStateValidityCheckingResolution(resolution)
    start, goal = space.allocState(), space.allocState()
    start[0], start[1], goal[0], goal[1] = 0.0, 0.0, plane.along, 0.0
    setup.setStartAndGoalStates(start, goal)
    setup.setPlanner(getattr(og, planner)(information))
    setup.setup()
    return setup


def seconds_of_a_check(plane, count=5000):
    """Processor time of a validity check [s]."""
    limits = (0.0, -plane.window), (plane.along, plane.window)
    states = np.random.default_rng(0).uniform(*limits, (count, 2))
    begin = time.process_time()
    for state in states:
        plane.valid(state)
    return (time.process_time() - begin) / count


def solution(setup):
    if not setup.haveExactSolutionPath():
        return None
    return np.array([[s[0], s[1]] for s in setup.getSolutionPath().getStates()])


def until(moment):
    """End a run by its processor time, which other processes do not affect."""
    return ob.PlannerTerminationCondition(lambda: time.process_time() >= moment)


def ompl_runs(plane, number, seconds):
    """RRTConnect, plain and simplified; then the optimising planners at several times."""
    for resolution in (DEFAULT, FINE):
        setup = ompl_setup(plane, "RRTConnect", resolution)
        begin = time.process_time()
        setup.solve(until(begin + seconds))
        spent, path = time.process_time() - begin, solution(setup)
        yield Run(number, "RRTConnect", resolution, None, spent, path)
        if path is not None:
            setup.simplifySolution()
            spent, path = time.process_time() - begin, solution(setup)
        yield Run(number, "RRTConnect, simplified", resolution, None, spent, path)
        for planner in OPTIMISING:
            setup, spent = ompl_setup(plane, planner, resolution), 0.0
            longest = seconds if resolution == FINE else min(seconds, 1.0)
            for budget in [*(b for b in (0.1, 1.0) if b < longest), longest]:
                begin = time.process_time()
                setup.solve(until(begin + budget - spent))
                spent = spent + time.process_time() - begin
                yield Run(number, planner, resolution, budget, spent, solution(setup))


def our_runs(plane, number):
    """The lattice's optimum and the default ants, each with and without refinement."""
    for name, planner, refine in (
        ("LatticeOptimum, no refinement", fp.LatticeOptimum(), False),
        ("LatticeOptimum, refined", fp.LatticeOptimum(), True),
        ("plan(refine=False)", None, False),
        (OURS, None, True),
    ):
        begin = time.process_time()
        path = base_track(plane, planner, refine)
        yield Run(number, name, None, None, time.process_time() - begin, path)


def base_track(plane, planner, refine):
    """Corners (m + 1, 2) of our path in the plane, or None."""
    try:
        plan = fp.plan(plane.problem, planner, seed=0, refine=refine)
    except fp.NoPath:
        return None
    aside = (plan.configurations[:, :3] - plane.nominal.positions) @ plane.aside
    return np.column_stack([np.linspace(0.0, plane.along, len(aside)), aside])


HEAD = (
    "planner; edge resolution; time to a path, median (90th percentile) [ms]; paths found; "
    "with a collision (deepest); length against `plan()`, median; shorter : longer"
)


def rows(runs):
    """One row for each planner, resolution and time."""
    ours = {r.number: r.length for r in runs if r.planner == OURS and r.path is not None}
    groups = {}
    for run in runs:
        groups.setdefault((run.planner, run.resolution, run.budget), []).append(run)
    for (planner, resolution, budget), group in groups.items():
        found = [r for r in group if r.path is not None]
        depths = [1e3 * r.depth for r in found if not r.clean]
        ratio = np.array([r.length / ours[r.number] for r in found if r.clean and r.number in ours])
        times = 1e3 * np.array([r.seconds for r in found] or [np.nan])
        yield [
            f"{planner}, {budget:g} s" if budget else planner,
            f"{resolution:g}" if resolution else "proven",
            "" if budget else f"{np.median(times):.1f} ({np.quantile(times, 0.9):.1f})",
            f"{len(found)} of {len(group)}",
            f"{len(depths)} ({max(depths):.1f} mm)" if depths else "0",
            f"{100 * (np.median(ratio) - 1):+.2f} %" if len(ratio) else "",
            f"{np.sum(ratio < 1 - SAME)} : {np.sum(ratio > 1 + SAME)}",
        ]


def sentences(runs):
    """Problems in which only one side has a path."""
    ours, theirs = {r.number: r for r in runs if r.planner == OURS}, {}
    for run in sorted((r for r in runs if r.clean), key=lambda r: -r.length):
        if run.resolution == FINE:
            theirs[run.number] = run.path
    refused = [r for r in ours.values() if r.path is None]
    only = [r.number for r in refused if r.number in theirs]
    turning = sum(bool(np.any(np.diff(theirs[number][:, 0]) < -1e-9)) for number in only)
    finer = fp.Lattice(40, fp.Axis(80, 0.0375))
    planes = [Plane(paper_problem(number, 0.0, finer)) for number in only]
    opened = sum(base_track(p, fp.LatticeOptimum(), False) is not None for p in planes)
    lost = sum(r.path is not None and r.number not in theirs for r in ours.values())
    spent = np.median([1e3 * r.seconds for r in refused] or [0.0])
    return f"""
- OMPL has a free path (any planner at {FINE:g}, re-checked), `plan()` none: {len(only)} of
  {len(ours)} problems. OMPL's shortest path goes back in {turning} of them. With a four times
  finer lateral spacing the lattice has a path in {opened} of them.
- `plan()` has a path, OMPL no free one: {lost}. Neither has one: {len(refused) - len(only)}.
- `plan()` found no path {len(refused)} times, after {spent:.0f} ms (median). OMPL's planners search
  until their time limit.
"""


NOTES = f"""
Notes:

- All planners work in one plane: progress along the straight line [m] and lateral offset [m],
  within the lattice's window; the same configuration at each point, reaction included. OMPL's
  checks are distances in closed form, which agree with Coal's to rounding.
- Lengths are those of the base's track in the plane. Our planners minimise Eq. 6, in which the
  joints' displacement is part of each step, and have corners on the layers only. The last two
  columns count problems where `plan()` has a path and this one is free of collisions; "shorter" and
  "longer" begin at {100 * SAME:g} %.
- Our paths are monotone in progress, one node in each layer. OMPL's paths may go back, and so
  there are OMPL paths, some of them shorter, that no such lattice contains.
- Our times are those of `plan()` as a whole, proofs included. OMPL's are those of `solve` alone
  (and of the simplification where named), with a validity checker in Python that reads the
  links' places from a table; the time to make the table is not counted. Times of OMPL's planners
  are mostly times of these checks, and would be shorter with a checker in C++.
- The edge resolution is OMPL's, relative to the plane's diagonal; {DEFAULT:g} is its default.
  Collisions are found by distances in closed form every {1e3 * STEP:g} mm, with the exact reaction.
- OMPL's generator is seeded once; the results of its planners in a given time still vary.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    add_problems_option(parser)
    parser.add_argument("--seconds", type=float, default=5.0, help="longest run of a planner")
    parser.add_argument("--out", type=Path, default=RESULTS / "ompl.md", help="report to write")
    given = parser.parse_args()
    begin = time.process_time()
    ou.setLogLevel(ou.LogLevel.LOG_ERROR)
    ou.RNG.setSeed(SEED)
    for planner in (None, fp.LatticeOptimum()):
        fp.plan(fp.load_scenario("fig2a"), planner)  # compiles
    runs, spent = [], seconds_of_a_check(Plane(paper_problem(NUMBERS[0], 0.0)))
    for number in NUMBERS[: given.problems]:
        plane = Plane(paper_problem(number, 0.0))
        found = [*our_runs(plane, number), *ompl_runs(plane, number, given.seconds)]
        for run in found:
            run.depth = -np.inf if run.path is None else plane.depth(run.path)
        runs += found
        print(f"{problem_name(number)}: {time.process_time() - begin:.0f} s", file=sys.stderr)
    options = f"--problems {given.problems} --seconds {given.seconds:g}"
    introduction = f"""# Side by side with OMPL 2.0.1

    python -m benchmarks.studies.planners.ompl_peers {options}

{given.problems} problems of family `paper` of [the problem set](../howto/problem_set.md), with
delta = 0. All times are processor times of one thread. One check of a state for OMPL takes
{1e6 * spent:.0f} µs;
{(time.process_time() - begin) / 60.0:.0f} minutes in all.

"""
    results = table(HEAD.split("; "), rows(runs))
    publish(f"{introduction}{results}\n{sentences(runs)}{NOTES}", given.out)


if __name__ == "__main__":
    main()
