"""Plans made again from the trajectories of best plans, so that `Plan.verify` can check them.

    python -m ffsr_plan.problem_set.making.rebuilt_plans [--family NAME]

verifies the best plan of every problem, and notes in `best.json` whether it passed. The judge of
the set proves a trajectory free with the planner's own distances; `Plan.verify` measures by other
code.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from ffsr_plan.core.arrays import frozen
from ffsr_plan.core.errors import FfsrPlanError, GoalPoseIgnored, InvalidInput
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.lattice.certificate import Certificate, proven_clearance
from ffsr_plan.planning.certified_plan import Plan
from ffsr_plan.portfolio.lattice_left_out import without_lattice
from ffsr_plan.problem.free_objective import least_objective, stations_objective
from ffsr_plan.problem.problem import Problem
from ffsr_plan.problem_set.bench_problem import BenchProblem
from ffsr_plan.problem_set.best_plans import BestPlans
from ffsr_plan.problem_set.set_index import DATA, ProblemSet
from ffsr_plan.proof.prover import Prover
from ffsr_plan.search.records import Branches, History
from ffsr_plan.trajectory.trajectory import Trajectory
from ffsr_plan.tree_search.tree_planner import TreePlanner

_EVEN = 1e-9  # share of the duration by which times may leave even steps


def rebuilt(problem: Problem, trajectory: Trajectory) -> Plan:
    """A plan along a trajectory of linear pieces, proven free edge by edge.

    Args:
        problem: what it solves; a lattice is left out.
        trajectory: joint values of all joints, and of the base what the mode prescribes; at even
            times where bodies move.

    Raises:
        InvalidInput: pieces that are not linear, times that are not even where bodies move, or an
            edge that cannot be proven free.
    """
    if problem.lattice is not None:
        progress = problem.lattice.progress is not None
        problem = replace(problem, lattice=None) if progress else without_lattice(problem)
    motion = _motion(problem, trajectory)
    problem = problem.ending_at(motion.configurations()[-1])  # maybe whole turns away
    m, still = motion.edges, np.zeros((motion.edges + 1, 3))
    prover = Prover(motion, problem.obstacles, problem.tolerance, pace=problem.pace(m))
    clearances = prover.clearances(np.arange(m + 1), still)
    ends = np.column_stack([clearances[:-1], clearances[1:]])
    verdicts = prover.certify_all(np.arange(m), still[1:], still[1:], ends)
    for edge, (verdict, links) in enumerate(zip(verdicts, prover.links.verdicts(), strict=True)):
        if not (verdict.free and links.free):
            raise InvalidInput("trajectory", f"edge {edge}", "edges that can be proven free")
    least, _ = proven_clearance(prover, still, clearances)
    length, value = stations_objective(problem, motion)
    return Plan(
        problem=problem,
        planner=TreePlanner(),
        seed=None,
        lattice=None,
        motion=motion,
        nodes=frozen(np.zeros(0, dtype=np.int64)),
        length=length,
        objective=value,
        lattice_objective=value,
        optimum=min(least_objective(problem), value),
        optimum_is_exact=False,
        clearances=frozen(clearances),
        history=History.of_rows(np.array([[value, value, value, 1.0]])),
        trails=Branches.none(),
        certificate=Certificate(m, 0, m + 1, 0, least, problem.robot.unchecked_links),
        interrupted=False,
        seconds=0.0,
    )


def _motion(problem: Problem, given: Trajectory) -> Motion:
    """The motion of a trajectory, with an edge for each of its pieces."""
    robot, mode = problem.robot, problem.mode
    if given.interpolation != "linear":
        raise InvalidInput("trajectory", f"{given.interpolation} pieces", "linear ones")
    share = (given.times - given.times[0]) / (given.times[-1] - given.times[0])
    even = np.linspace(0.0, 1.0, len(share))
    if problem.duration is not None and not np.allclose(share, even, rtol=0.0, atol=_EVEN):
        raise InvalidInput("trajectory", "times that are not even", "even ones")
    joints = np.column_stack([given.joints[name] for name in robot.joint_names])
    positions, turns = given.base_positions, None
    if positions is None:
        positions = np.tile(problem.start[:3], (len(share), 1))
    whole = float(angle_between(problem.start[3:7], problem.goal[3:7]))
    if mode is Mode.ATTITUDE_HELD and whole > 0.0 and given.base_attitudes is not None:
        turns = angle_between(given.base_attitudes, problem.start[3:7]) / whole
        turns[[0, -1]] = 0.0, 1.0
    joints[0] = robot.joint_values(problem.start)
    goal = robot.assemble(problem.goal[:3], problem.goal[3:7], joints[-1])
    return Motion(robot, mode, problem.start, goal, positions, joints, turns)


def verification_faults(given: BenchProblem, trajectory: Trajectory) -> str:
    """What `Plan.verify` finds wrong with a trajectory; empty if nothing.

    Args:
        given: the problem.
        trajectory: of its best plan.
    """
    try:
        report = rebuilt(given.problem, trajectory).verify()
    except FfsrPlanError as error:
        return str(error)
    return "; ".join(report.problems)


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--family", help="only this one")
    parser.add_argument("--data", type=Path, default=DATA)
    given = parser.parse_args()
    warnings.simplefilter("ignore", GoalPoseIgnored)
    problems, known = ProblemSet(given.data), BestPlans(given.data)
    wrong = 0
    for name in problems.names(given.family):
        row = known.get(name)
        if row is None or row.objective is None:
            continue
        said = verification_faults(problems[name], known.trajectory(name))
        wrong += bool(said)
        known.put(replace(row, verified=not said), None)
        print(f"{name}: {said or 'verified'}", flush=True)
    print(f"{wrong} are not verified")


if __name__ == "__main__":
    main()
