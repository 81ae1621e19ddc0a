"""Times of the parts of a plan, as ratios to `pin.computeDistances` over the lattice's nodes.

`pytest benchmarks` runs them; the ratio is in each benchmark's `extra_info`.
"""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from benchmarks.speed.reference import Reference, record
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.robots.loading import robot_from_urdf


@pytest.fixture(scope="module")
def reference(problem):
    return Reference(problem)


@pytest.fixture(scope="module")
def spatial(problem):
    """The same task on 41 layers of 21 x 21 nodes, lateral and normal."""
    return replace(problem, lattice=fp.Lattice(40, fp.Axis(10, 0.3), fp.Axis(10, 0.3)))


@pytest.fixture(scope="module")
def spatial_reference(spatial):
    return Reference(spatial)


@pytest.fixture(scope="module", autouse=True)
def compiled(problem):
    """Compile all kernels, so that no benchmark times their compilation."""
    few = replace(problem, lattice=fp.Lattice(8, fp.Axis(8, 0.3)))
    for planner in (fp.AntSystem(cycles=2), fp.MaxMinAntSystem(cycles=2), fp.LatticeOptimum()):
        fp.plan(few, planner)


def test_reference_compute_distances(benchmark, reference):
    benchmark(reference.run)
    record(benchmark, reference)


def test_node_clearances(benchmark, problem, reference):
    """All node clearances of the lattice, its nominal motion given."""

    def fresh():
        return (Roadmap(problem),), {}

    found = benchmark.pedantic(lambda roadmap: roadmap.clearances, setup=fresh, rounds=20)
    assert np.allclose(found[np.isfinite(found)], reference.run(), atol=1e-12)
    record(benchmark, reference)


def test_clearances_of_any_configurations(benchmark, problem, reference):
    """The same configurations, each with its own forward kinematics."""
    lattice = LayeredLattice(problem)
    query = ObstacleQuery(problem.robot, problem.scene)
    layers = [lattice.layer(i) for i in range(1, lattice.divisions)]
    found = benchmark(lambda: np.concatenate([query.distances(layer) for layer in layers]))
    assert np.allclose(found, reference.run()[1:-1], atol=1e-12)
    record(benchmark, reference)


def test_reaction_of_the_nominal_joint_path(benchmark, problem, reference):
    joints = LayeredLattice(problem).nominal.joint_values
    benchmark(lambda: Reaction.along(problem.robot, joints))
    record(benchmark, reference)


def test_roadmap_with_all_node_clearances(benchmark, problem, reference):
    benchmark(lambda: Roadmap(problem).clearances)
    record(benchmark, reference)


def test_certification_of_1000_edges(benchmark, problem, reference):
    """Edges between neighbouring offsets all over the lattice, none certified before."""
    edges = [
        (int(layer), int(tail), int(np.clip(tail + step, 0, 40)))
        for layer, tail, step in np.random.default_rng(0).integers(
            (1, 0, -3), (39, 41, 4), (1000, 3)
        )
    ]

    def fresh():
        return (Roadmap(problem),), {}

    def certify(roadmap):
        return sum(roadmap.certify(*edge).free for edge in edges)

    free = benchmark.pedantic(certify, setup=fresh, rounds=10)
    assert 0 < free < 1000
    record(benchmark, reference)


def test_one_cycle_of_the_ant_system(benchmark, problem, reference):
    """30 ants, one cycle, including the proofs of the edges that they use."""

    def fresh():
        return (Roadmap(problem), np.random.default_rng(0)), {}

    benchmark.pedantic(fp.AntSystem(cycles=1).search, setup=fresh, rounds=10)
    record(benchmark, reference)


def test_plan_with_the_ant_system(benchmark, problem, reference):
    """`plan` as a whole, until stagnation."""
    plan = benchmark.pedantic(lambda: fp.plan(problem, fp.AntSystem(), seed=0), rounds=3)
    benchmark.extra_info["cycles"] = len(plan.history.best)
    benchmark.extra_info["objective"] = plan.objective
    record(benchmark, reference)


def test_lattice_optimum_build_included(benchmark, problem, reference):
    benchmark(lambda: search_anew(problem, fp.LatticeOptimum()))
    record(benchmark, reference)


def test_max_min_ant_system_build_included(benchmark, problem, reference):
    """30 ants x 242 cycles."""
    benchmark.pedantic(lambda: search_anew(problem, fp.MaxMinAntSystem()), rounds=10)
    record(benchmark, reference)


def test_plan_with_the_default_planner_and_refinement(benchmark, problem, reference):
    plan = benchmark.pedantic(lambda: fp.plan(problem, refine=True), rounds=10)
    benchmark.extra_info["objective"] = plan.objective
    record(benchmark, reference)


def test_plan_with_the_lattice_optimum(benchmark, problem, reference):
    """Not refined."""
    plan = benchmark(lambda: fp.plan(problem, fp.LatticeOptimum(), refine=False))
    benchmark.extra_info["objective"] = plan.objective
    record(benchmark, reference)


def test_lattice_optimum_on_21_by_21_nodes(benchmark, spatial, spatial_reference):
    """Build included."""
    benchmark.pedantic(lambda: search_anew(spatial, fp.LatticeOptimum()), rounds=5)
    record(benchmark, spatial_reference)


def test_max_min_ant_system_on_21_by_21_nodes(benchmark, spatial, spatial_reference):
    """Build included, 30 ants x 242 cycles."""
    benchmark.pedantic(lambda: search_anew(spatial, fp.MaxMinAntSystem()), rounds=5)
    record(benchmark, spatial_reference)


@pytest.mark.parametrize("name", ["gate", "double_gate"])
def test_plan_through_a_gate_with_posture_axes(benchmark, name, reference):
    """Goal attitude met by the arms; the problem is read anew each time."""
    fp.plan(fp.load_scenario(name))  # compiles
    plan = benchmark.pedantic(lambda: fp.plan(fp.load_scenario(name), seed=0), rounds=3)
    benchmark.extra_info["objective"] = plan.objective
    record(benchmark, reference)


def search_anew(problem, planner):
    """Build the roadmap and search it."""
    return planner.search(Roadmap(problem), np.random.default_rng(0))


@pytest.mark.parametrize("scenario", ["fig2a", "inspection"])
def test_verification(benchmark, scenario, reference):
    """`verify` at its defaults; for `inspection` among 4748 spheres, 15 shapes and 66 pairs."""
    plan = fp.plan(fp.load_scenario(scenario), fp.LatticeOptimum())
    assert plan.verify().ok  # compiles
    report = benchmark.pedantic(plan.verify, rounds=5)
    benchmark.extra_info["samples"] = report.samples
    record(benchmark, reference)


def test_verification_of_folded_hulls(benchmark, reference):
    """A stack of eight discs, hulls of some 200 corners, on five edges."""
    plan = stack_of_discs_plan()
    assert plan.verify().ok
    report = benchmark.pedantic(plan.verify, rounds=5)
    benchmark.extra_info["samples"] = report.samples
    record(benchmark, reference)


def stack_of_discs_plan():
    """Discs above one another turn about their common axis while the base flies past a sphere."""
    points = np.random.default_rng(1).normal(size=(200, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    disc = '<collision><geometry><mesh filename="disc.stl"/></geometry></collision>'
    body = (
        '<inertial><mass value="{}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        f"</inertial>{disc}"
    )
    parts = [f'<link name="disc0">{body.format(100)}</link>']
    for k in range(1, 8):
        parts.append(f'<link name="disc{k}">{body.format(3)}</link>')
        parts.append(
            f'<joint name="turn{k}" type="revolute"><parent link="disc{k - 1}"/>'
            f'<child link="disc{k}"/><origin xyz="0 0 0.08"/><axis xyz="0 0 1"/>'
            '<limit lower="-2" upper="2" velocity="1" effort="1"/></joint>'
        )
    text = f'<robot name="stack">{"".join(parts)}</robot>'
    robot = robot_from_urdf(text, "stack", meshes={"disc.stl": points * [0.3, 0.3, 0.02]})
    turned = dict.fromkeys(robot.joint_names, 0.2)
    goal = robot.configuration((3, 0, 0), joints=turned)
    scene = fp.Scene([[3.0, 3.0, 0.0]], [0.5])
    return fp.plan(fp.Problem(robot, scene, robot.neutral(), goal, lattice=fp.Lattice(5)))
