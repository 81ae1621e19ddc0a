"""Least clearances on the edges of paths: free edges are proven, and close ones are decided."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.proof.prover import Prover
from ffsr_plan.refinement.edge_clearances import EdgeClearances


def passing(point, spare, delta=0.1):
    """A point that passes a sphere half-way between two layers, 4 m apart; `spare` is between."""
    own = -float(fp.clearance(point, fp.Scene([[0, 0, 0]], [1e-9]), point.configuration()))
    scene = fp.Scene([[2.0, 0.5 + own + spare, 0.0]], [0.5])
    ends = point.configuration(), point.configuration((8.0, 0.0, 0.0))
    problem = fp.Problem(point, scene, *ends, delta=delta, lattice=fp.Lattice(2, fp.Axis(1, 0.5)))
    lattice = LayeredLattice(problem)
    prover = Prover(lattice.nominal, scene, problem.tolerance)
    still = np.zeros((3, 3))
    clearances = prover.clearances(np.arange(3), still)
    return EdgeClearances(problem, prover), still, clearances


@pytest.mark.parametrize("delta", [0.0, 0.1])
@given(spare=st.floats(-0.4, 0.4))
@settings(max_examples=40)
def test_edges_clear_of_the_tolerance_are_free_and_colliding_ones_are_not(point, spare, delta):
    edges, offsets, clearances = passing(point, spare, delta)
    near, far = edges.of_path(offsets, clearances)
    assert far.free
    assert near.free == (spare > 1e-4) or abs(spare) <= 1e-4
    if delta > 0.0:
        assert near.least_clearance == pytest.approx(spare, abs=1e-7)
        assert near.time == 0.5


def test_an_edge_closer_than_the_finest_step_is_free_with_its_true_clearance(point):
    """4 m / 16 is a step of 25 cm, and 2 mm are left."""
    edges, offsets, clearances = passing(point, 0.002)
    value = edges.motion_objective(offsets, clearances)
    assert value == pytest.approx(8.0 + 0.1 / 0.002 + 0.1 / clearances[1:].min(), rel=1e-4)
    blocked, offsets, clearances = passing(point, -0.002)
    assert blocked.motion_objective(offsets, clearances) == np.inf
