"""Edges sampled together: what counts as free is free, and how close it comes is known by half."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.proof.interval_halving import ROUNDING
from ffsr_plan.proof.sampled_edges import LEVELS, sample_edges
from tests.helpers.urdf_builders import random_scene

TOLERANCE, RADIUS = 1e-4, 0.05
seeds = st.integers(0, 100_000)


class Discs:
    """Points that pass small discs at lateral distances `y` (k,), nearest at times `t`; travel 4.

    The discs are so small that the clearance falls nearly as fast as a point travels.
    """

    def __init__(self, y, t):
        self.y, self.t, self.asked = np.array(y), np.array(t), 0

    def clearances(self, which, times):
        """(t, j) clearances of some edges."""
        along = 4.0 * (np.asarray(times)[:, None] - self.t[which])
        return np.hypot(along, self.y[which]) - RADIUS

    def measure(self, which, parts):
        self.asked += len(which) * parts // 2
        return self.clearances(which, np.arange(1, parts, 2) / parts)

    def verdicts(self):
        every = np.arange(len(self.y))
        ends = self.clearances(every, [0.0, 1.0]).T
        speeds = np.full(len(every), 4.0)
        return sample_edges(self.measure, ends, speeds, ROUNDING, TOLERANCE)


@given(st.lists(st.tuples(st.floats(0.02, 1.0), st.floats(0.0, 1.0)), min_size=1, max_size=20))
@example([(0.26, 0.125)])  # 0.21 m are left between two of five samples of 0.51 m
@settings(max_examples=200)
def test_free_edges_are_clear_by_half_of_the_least_sample(cases):
    y, t = np.array(cases).T
    discs = Discs(y, t)
    verdicts = discs.verdicts()
    for each, true in zip(verdicts, y - RADIUS, strict=True):
        assert each.least_clearance >= true - 1e-12
        if each.free:
            assert each.least_clearance / 2.0 <= true + 1e-9
        if true > 4.0 / LEVELS[-1] + 1e-6:  # than the travel over the finest step
            assert each.free
    for k, each in enumerate(verdicts):
        at = discs.clearances(np.array([k]), [each.time])[0, 0]
        assert at == pytest.approx(each.least_clearance, abs=1e-12)


def test_no_more_samples_are_taken_than_a_proof_needs():
    far, near = Discs([4.0], [0.5]), Discs([0.35], [0.4])
    (clear,), (close,) = far.verdicts(), near.verdicts()
    assert clear.free
    assert far.asked == clear.queries == 1
    assert close.free
    assert near.asked == close.queries == 15


def test_an_edge_within_the_tolerance_is_not_free():
    (touching,) = Discs([RADIUS + TOLERANCE / 2.0], [0.5]).verdicts()
    assert not touching.free
    assert touching.least_clearance <= TOLERANCE
    assert touching.time == 0.5


@given(seeds)
@settings(max_examples=25)
def test_verdicts_agree_with_interval_halving(seed):
    rng = np.random.default_rng(seed)
    robot = fp.load_robot("planar_dual_arm")
    scene = random_scene(rng, 8, (1.0, -1.5, -0.1), (5.0, 1.5, 0.1), (0.1, 0.4))
    goal = robot.configuration((6.0, 0.0, 0.0), joints={"left_1": -1.2, "left_2": 0.6})
    problem = fp.Problem(
        robot, scene, robot.configuration(), goal, lattice=fp.Lattice(10, fp.Axis(4, 0.3))
    )
    try:
        roadmap = Roadmap(problem)
    except fp.PlanningError:
        return
    prover, at = roadmap.prover, roadmap.lattice.offsets
    layers = rng.integers(1, 9, 30)
    tails, heads = (rng.integers(0, len(at), 30) for _ in range(2))
    ends = np.stack([roadmap.clearances[layers, tails], roadmap.clearances[layers + 1, heads]], 1)
    sampled = prover.sampled_edges(layers, at[tails], at[heads], ends)
    for k, each in enumerate(sampled):
        layer, tail, head = int(layers[k]), at[tails[k]], at[heads[k]]
        proof = prover.certify(layer, tail, head, tuple(ends[k].tolist()))
        edge = prover.obstacle_edge(layer, tail, head)
        dense = min(edge.clearance(float(t)) for t in np.linspace(0.0, 1.0, 65))
        undecided = not each.free and each.least_clearance > prover.tolerance
        assert undecided or each.free == proof.free or dense <= 2.0 * prover.tolerance
        if each.free:
            assert dense > 0.0
        if dense > prover.tolerance and not undecided:
            assert edge.clearance(each.time) == pytest.approx(each.least_clearance, abs=1e-12)
