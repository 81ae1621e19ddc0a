"""Fixtures of the benchmarks."""

import pytest

import ffsr_plan as fp


@pytest.fixture(scope="session")
def problem():
    """The reference lattice: 41 layers of 41 nodes, 7 box links, 6 spheres."""
    scenario = fp.load_scenario("fig2a")
    return fp.Problem(
        scenario.robot,
        scenario.scene,
        scenario.start,
        scenario.goal,
        delta=scenario.delta,
        length_unit=scenario.length_unit,
        lattice=fp.Lattice(40, fp.Axis(20, 0.15)),
    )
