"""What lies between two samples is found: forged plans past obstacles in the way."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import frozen
from tests.helpers.careless_plans import MODES, careless_plan, placed
from tests.helpers.solid_distances import least_sphere_distance, sphere_distance


def forged(plan, center, radius):
    """The plan with an obstacle that was put in later, and node clearances that fit it."""
    nodes = np.arange(plan.problem.lattice.divisions + 1) / plan.problem.lattice.divisions
    each = [
        sphere_distance(shape, at, center[None], np.array([radius]))[:, 0]
        for shape, at in placed(plan, nodes)
    ]
    problem = replace(plan.problem, scene=fp.Scene([center], [radius]))
    return replace(
        plan,
        problem=problem,
        clearances=frozen(np.min(each, axis=0)),
        certificate=plan.certificate._replace(least_clearance=0.0),
    )


def test_a_sphere_between_samples_of_a_long_edge_is_found(point):
    goal = point.configuration((90_000.0, 0, 0))
    problem = fp.Problem(point, fp.Scene(), point.configuration(), goal, lattice=fp.Lattice(2))
    plan = fp.plan(problem, fp.LatticeOptimum(), refine=False)
    for samples in (1, 50, 2000):
        for x in (30_000.0 + 90_000 / 2 / 2000 / 2, 12_345.678, 89_990.1):
            report = forged(plan, np.array([x, 0.0, 0.0]), 0.05).verify(samples)
            assert "inside an obstacle" in report.problems[0]
            assert report.least_clearance < 0.0
            beside = forged(plan, np.array([x, 0.2, 0.0]), 0.05).verify(samples)
            assert beside.ok, beside.problems
            assert 0.0 < beside.clearance_bound <= beside.least_clearance


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("step", [0.05, 0.5, 2.0])
def test_a_crumb_anywhere_in_the_way_of_a_robot_is_found(mode, step):
    found = 0
    for seed in range(12):
        plan, rng = careless_plan(seed, mode, step)
        s = rng.uniform(0.05, 0.95)
        shapes = placed(plan, np.array([s]))
        shape, at = shapes[int(rng.integers(len(shapes)))]
        corner = shape.points[int(rng.integers(len(shape.points)))]
        center = at[0, :3, :3] @ corner + at[0, :3, 3]
        plan = forged(plan, center, 1e-4)
        if plan.clearances.min() <= 0.0:
            continue
        found += 1
        for samples in (1, 7):
            report = plan.verify(samples)
            assert not report.ok
            assert "obstacle" in " ".join(report.problems)
    assert found >= 3


@pytest.mark.parametrize("mode", MODES)
def test_a_near_miss_verifies_and_its_bound_holds(mode):
    for seed in range(8):
        plan, rng = careless_plan(seed, mode)
        shapes = placed(plan, np.linspace(0.0, 1.0, 4001))
        center = shapes[-1][1][1300, :3, 3] + rng.normal(size=3)
        away = min(
            least_sphere_distance(shape, at, center[None], np.zeros(1)) for shape, at in shapes
        )
        if away < 0.01:
            continue
        report = forged(plan, center, away - 1e-3).verify(2)
        hits = [p for p in report.problems if "obstacle" in p or "clearance" in p]
        assert not hits
        assert 0.0 < report.clearance_bound <= 1e-3 + 1e-9
        assert report.least_clearance == pytest.approx(1e-3, abs=1e-3)


def test_links_that_pass_each_other_between_samples_are_found():
    seen = 0
    for seed in range(60):
        plan, _ = careless_plan(seed, "free-flying", step=2.0)
        report = plan.verify(300)
        if report.least_self_separation <= -1e-3:
            seen += 1
            assert not plan.verify(1).ok
    assert seen >= 5


def test_a_motion_that_leaves_straight_lines_is_noticed(fig2a_plan):
    class Bent(type(fig2a_plan)):
        def at(self, s):
            q = np.array(super().at(s))
            q[..., 0] += 1e-5 * np.sin(np.pi * np.asarray(s) * self.motion.edges) ** 2
            return q

    fields = {name: getattr(fig2a_plan, name) for name in fig2a_plan.__dataclass_fields__}
    report = Bent(**fields).verify(8)
    assert "leave the straight line" in " ".join(report.problems)


def test_a_base_that_turns_faster_than_its_arms_allow_is_noticed(fig2a_plan):
    class Spun(type(fig2a_plan)):
        def at(self, s):
            q = np.array(super().at(s))
            spin = 0.3 * np.sin(2 * np.pi * np.asarray(s) * self.motion.edges)
            turn = np.zeros((*np.shape(s), 3))
            turn[..., 2] = spin
            q[..., 3:7] = rotations.multiply(q[..., 3:7], rotations.exp(turn))
            return q

    fields = {name: getattr(fig2a_plan, name) for name in fig2a_plan.__dataclass_fields__}
    report = Spun(**fields).verify(8)
    assert "more between two samples than it can" in " ".join(report.problems)
