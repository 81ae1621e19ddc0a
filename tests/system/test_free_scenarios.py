"""Scenarios without a lattice are planned and verify."""

import pytest

import ffsr_plan as fp


@pytest.mark.parametrize("name", ["cup", "tuck", "reach"])
def test_scenarios_without_a_lattice_need_a_detour_and_have_a_proven_plan(name):
    problem = fp.load_scenario(name)
    assert problem.lattice is None
    plan = fp.plan(problem, until="first")
    assert plan.length > 1.2 * problem.straight_length
    assert plan.verify().ok
    if problem.reach_attitude:
        assert plan.arrival_attitude_error < 1e-8
