"""Whole plans with arms that swing by one to two radians, and proofs of a UR5 in free float.

The reference lattice has 41 layers of 41 nodes, 7 box links and 6 spheres; delta is 1.
"""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from benchmarks.speed.reference import Reference, record
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.prover import Prover
from ffsr_plan.scene.generators import scatter
from ffsr_plan.search.postures.posture_lattice import PostureLattice

SWING = (1.25, 1.95, 1.19, -1.18, -1.35, 1.23)
"""Change of each joint from start to goal [rad]."""


@pytest.fixture(scope="module")
def swinging(problem):
    robot = problem.robot
    values = robot.joint_values(problem.start) + np.array(SWING)
    goal = robot.assemble(problem.goal[:3], problem.goal[3:7], values)
    return replace(problem, goal=goal, delta=1.0)


@pytest.fixture(scope="module")
def reference(swinging):
    return Reference(swinging)


@pytest.mark.parametrize(
    ("planner", "refine"),
    [("lattice-optimum", False), ("max-min-ant-system", False), ("max-min-ant-system", True)],
    ids=["lattice-optimum", "max-min-ant-system", "default"],
)
def test_whole_plan(benchmark, swinging, reference, planner, refine):
    """`plan` as a whole, warm."""
    fp.plan(swinging, planner, refine=refine)  # compiles
    plan = benchmark.pedantic(lambda: fp.plan(swinging, planner, refine=refine), rounds=20)
    benchmark.extra_info["objective"] = plan.objective
    record(benchmark, reference)


def afloat(seed, count, edges=8):
    """A path of a UR5 on a satellite among `count` spheres, in free float."""
    robot, rng = fp.load_scenario("inspection").robot, np.random.default_rng(seed)
    values = rng.uniform(-0.4, 0.4, (2, robot.nd)) + robot.joint_values(robot.neutral())
    start, goal = (robot.assemble(np.zeros(3), np.array([0, 0, 0, 1.0]), v) for v in values)
    motion = Motion(robot, "free-floating", start, goal, np.zeros((edges + 1, 3)))
    ball = scatter(seed, (count, count), (-6.0, -6.0), (6.0, 6.0), (0.05, 0.1))
    away = np.abs(ball.centers[:, :2]).max(axis=1) > 3.5
    return motion, fp.Scene(ball.centers[away], ball.radii[away])


@pytest.mark.parametrize("edges", [1, 8])
def test_proof_of_an_arm_against_its_own_links(benchmark, reference, edges):
    """66 pairs of links on a long edge, and on the same cut into eight."""
    motion, _ = afloat(0, 1, edges)
    Prover(motion, fp.Scene(), 1e-4).links.verdicts()

    def fresh():
        return (Prover(motion, fp.Scene(), 1e-4),), {}

    benchmark.pedantic(lambda prover: prover.links.verdicts(), setup=fresh, rounds=20)
    record(benchmark, reference)


@pytest.mark.parametrize("count", [110, 440])
def test_proof_of_a_path_in_free_float(benchmark, reference, count):
    """Against obstacles and its own links, set-up included."""
    motion, scene = afloat(1, count)
    layers, none = np.arange(motion.edges), np.zeros((motion.edges, 3))

    def prove():
        prover = Prover(motion, scene, 1e-4)
        at = prover.clearances(np.arange(motion.edges + 1), np.zeros((motion.edges + 1, 3)))
        prover.certify_all(layers, none, none, np.column_stack([at[:-1], at[1:]]))
        return prover.links.verdicts()

    prove()
    benchmark.pedantic(prove, rounds=20)
    record(benchmark, reference)


def test_reaction_to_all_joint_steps_of_three_posture_axes(benchmark, problem, reference):
    """156 250 joint steps."""
    names = problem.robot.joint_names[:3]
    axes = [fp.PostureAxis({name: 1.0}, 4, 0.15) for name in names]
    values = problem.robot.joint_values(problem.start) + 0.2
    goal = problem.robot.assemble(problem.goal[:3], problem.goal[3:7], values)
    given = replace(problem, goal=goal, lattice=fp.Lattice(10, postures=axes))

    def fresh():
        return (PostureLattice(given),), {}

    benchmark.pedantic(lambda lattice: lattice.step_rotations, setup=fresh, rounds=2)
    record(benchmark, reference)
