"""The compiled proof decides as the proof on Coal's distances does, or leaves the edge to it."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import records
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.course import course_of
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.interval_halving import certify
from ffsr_plan.proof.kernels.course import measure, memory_for, place_shapes, travel_of_shapes
from ffsr_plan.proof.kernels.edge_proof import (
    EDGE,
    OPEN,
    PROVEN,
    TOUCHED,
    intervals_for,
    prove,
)
from ffsr_plan.proof.prover import Prover
from tests.helpers.urdf_builders import random_robot

MODES = ["free-flying", "free-floating", "attitude-held", "held unevenly"]


def case(seed, mode, bent):
    """A motion of a random robot among spheres, and a generator of random numbers."""
    rng, robot, m = np.random.default_rng(seed), random_robot(seed), 4
    values = np.cumsum(rng.normal(size=(m + 1, robot.nd)) * 10.0 ** rng.uniform(-2.0, 0.0), axis=0)
    if not bent:
        values = np.linspace(values[0], values[-1], m + 1)
    values = np.clip(values, robot.lower, robot.upper)
    start = robot.assemble(rng.normal(size=3), rotations.exp(rng.normal(size=3)), values[0])
    goal = robot.assemble(rng.normal(size=3), rotations.exp(rng.normal(size=3)), values[-1])
    places = np.linspace(start[:3], goal[:3], m + 1)
    shares = None
    if mode == "held unevenly":  # an edge without a turn, and a turn back
        shares, mode = np.array([0.0, 0.7, 0.7, 0.4, 1.0]), "attitude-held"
    motion = Motion(robot, mode, start, goal, places, values if bent else None, shares)
    centers = motion.positions[rng.integers(m + 1, size=12)] + 1.5 * rng.normal(size=(12, 3))
    return motion, fp.Scene(centers, rng.uniform(0.02, 0.4, 12)), rng


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("bent", [True, False])
@pytest.mark.parametrize("seed", range(10))
def test_placements_and_distances_are_those_of_the_motion(seed, bent, mode):
    motion, scene, rng = case(seed, mode, bent)
    travel = EdgeTravel(motion)
    course, robot = course_of(motion, scene, travel), motion.robot
    memory, found = memory_for(course), np.empty(len(robot.primitives.kinds))
    query = ObstacleQuery(robot, scene)
    for layer, time in zip(rng.integers(4, size=20).tolist(), rng.uniform(size=20), strict=True):
        q = motion.at(np.array([layer]), np.array([time]))
        placed = shape_placements(robot, q)
        place_shapes(course, layer, time, memory)
        assert np.allclose(memory.frames, placed.frames[0], atol=1e-11)
        shift = rng.normal(size=3)
        least = measure(course, layer, time, shift, memory, found)
        assert np.allclose(found, query.links_at(placed, 0, shift), atol=1e-11)
        assert least == found.min()


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("seed", range(20))
def test_travel_is_bounded_as_along_the_edges_of_the_motion(seed, mode):
    motion, scene, rng = case(seed, mode, seed % 2 == 0)
    travel = EdgeTravel(motion)
    course, step = course_of(motion, scene, travel), rng.normal(size=3)
    step *= 0.0 if motion.mode.floats else 0.3
    memory, found = memory_for(course), np.empty(len(motion.robot.primitives.kinds))
    for _ in range(20):
        layer, parts = int(rng.integers(4)), 2 ** int(rng.integers(6))
        part = int(rng.integers(parts))
        begin, end = part / parts, (part + 1) / parts
        memory.vectors[1] = step
        travel_of_shapes(course, layer, begin, end, memory, found)
        expected = travel.bounds(layer, begin, end, step)
        if parts == 1 or travel.over(0.0, 1.0)[1][layer]:
            assert np.allclose(found, expected, rtol=1e-11, atol=1e-12)
        else:  # the interval itself, not a wider straight one around it
            assert np.all(found <= expected * 1.05)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("seed", range(40))
def test_decisions_are_verdicts_of_the_proof_by_coal(seed, mode):
    motion, scene, rng = case(seed, mode, seed % 3 > 0)
    robot, prover = motion.robot, Prover(motion, scene, 1e-4)
    course, count = course_of(motion, scene, EdgeTravel(motion)), 25
    layers = rng.integers(4, size=count)
    tails, heads = (rng.normal(size=(count, 3)) * 0.4 for _ in range(2))
    if motion.mode.floats:
        tails[:] = heads[:] = 0.0
    ends = np.column_stack([prover.clearances(layers, tails), prover.clearances(layers + 1, heads)])
    found, memory = records(EDGE, count), memory_for(course)
    found["layer"], found["tail"], found["head"], found["ends"] = layers, tails, heads, ends
    halving = intervals_for(course)
    prove(course, prover.speeds, found, prover.rounding, 1e-4, memory, halving)
    exact = bool(robot.primitives.exact.all())
    for k, state in enumerate(found["state"]):
        edge = prover.obstacle_edge(int(layers[k]), tails[k], heads[k])
        verdict = certify(edge, tuple(ends[k]), 1e-4)
        if state == PROVEN:
            assert verdict.free
        if state == TOUCHED and exact:
            assert not verdict.free
            assert verdict.time == found["time"][k]
            assert verdict.least_clearance == pytest.approx(found["least"][k], abs=1e-9)
        if state == OPEN and exact:
            assert verdict.least_clearance < 1.1e-4
        if exact and state == PROVEN and verdict.queries == found["count"][k]:
            assert verdict.least_clearance == pytest.approx(found["least"][k], abs=1e-9)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("seed", range(30))
def test_the_least_clearance_of_a_path_is_that_of_the_proof_by_coal(seed, mode, monkeypatch):
    motion, _, rng = case(seed, mode, seed % 3 > 0)
    ways = motion.positions[rng.integers(5, size=8)] + rng.normal(size=(8, 3)) * 2.5
    prover = Prover(motion, fp.Scene(ways, np.full(8, 0.1)), 1e-4)
    offsets = np.zeros((5, 3)) if motion.mode.floats else rng.normal(size=(5, 3)) * 0.2
    ends = prover.clearances(np.arange(5), offsets)
    if ends.min() <= 0.0:
        return
    ours = prover.least_clearance(offsets, ends)
    monkeypatch.setattr(Prover, "_course", None)
    theirs = prover.least_clearance(offsets, ends)
    assert ours == pytest.approx(theirs, rel=0.06, abs=1e-7)
    times = np.tile(np.arange(200) / 200.0, 4)
    edges = np.repeat(np.arange(4), 200)
    moved = motion.displaced(offsets) if not motion.mode.floats else motion
    sampled = ObstacleQuery(motion.robot, prover._scene).distances(moved.at(edges, times))
    assert ours <= max(sampled.min(), 0.0) + 1e-9  # zero where the path is not free
