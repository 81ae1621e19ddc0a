"""The study of waiting lattices: what it measures, and the code that looks at its flights."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ffsr_plan as fp
from benchmarks.studies.moving.flight_check import FAR, Obstacles, check_flight, share_run
from benchmarks.studies.moving.separation_kernels import gap_of_boxes
from benchmarks.studies.moving.waiting import ends_are_free, report, runs
from benchmarks.studies.moving.waiting_scenes import FAMILIES, drawn, drawn_in_space

STEP = 0.05  # [s]
PANEL, FENCES = FAMILIES.index("swinging panel"), FAMILIES.index("drifting fences")


@cache
def planned(bodies=True):
    """A flight through drifting fences, or one that ignores them, and its obstacles."""
    problem = drawn(0, FENCES)
    seen = problem if bodies else replace(problem, scene=fp.Scene())
    plan = fp.plan(seen, fp.LatticeOptimum(), refine=False)
    return plan, Obstacles(problem.scene, problem.duration, STEP)


def package_clearances(plan, scene, times):
    """(n,) clearances of a flight by the package."""
    layers = share_run(times, plan.problem.duration, plan.problem.ramp) * plan.motion.edges
    edges = np.minimum(layers.astype(np.int64), plan.motion.edges - 1)
    q = plan.motion.at(edges, layers - edges)
    clearances = [
        fp.clearance(plan.problem.robot, scene.at(time), row)
        for time, row in zip(times, q, strict=True)
    ]
    return np.array(clearances)


@pytest.mark.parametrize("bodies", [True, False])
def test_the_check_agrees_with_the_package(bodies):
    plan, obstacles = planned(bodies)
    found = check_flight(plan, obstacles)
    assert (found.separation <= 0.0) == (not bodies)
    here = np.array([found.time])
    (clearance,) = package_clearances(plan, drawn(0, FENCES).scene, here)
    assert (clearance <= 0.0) == (not bodies)
    every = package_clearances(plan, drawn(0, FENCES).scene, np.arange(0.0, 200.0, 2.0))
    assert found.separation <= every.min() + 1e-9
    assert not bodies or found.separation == pytest.approx(clearance, abs=0.02)


def test_a_widest_gap_of_boxes_is_their_distance_along_a_face_and_their_depth():
    half, other = np.array([0.5, 0.4, 0.3]), np.array([0.2, 0.3, 0.1])
    for x in (1.0, 0.6):
        apart = np.array([x, 0.1, 0.0])
        assert gap_of_boxes(np.eye(3), apart, half, other) == pytest.approx(x - 0.7)


def test_crossed_edges_are_apart_although_no_face_separates_them():
    # two bars with square sections on edge, crossed at right angles
    first = Rotation.from_euler("x", 45.0, degrees=True).as_matrix()  # along x
    second = Rotation.from_euler("y", 45.0, degrees=True).as_matrix()  # along y
    turn, reach = first.T @ second, 2.0 * np.sqrt(2.0) * 0.1
    halves = np.array([1.0, 0.1, 0.1]), np.array([0.1, 1.0, 0.1])
    for height in (reach + 0.02, reach - 0.02):
        gap = gap_of_boxes(turn, first.T @ np.array([0.0, 0.0, height]), *halves)
        assert gap == pytest.approx(height - reach)


def test_a_scene_that_no_fixed_pace_solves_is_solved_by_waiting_and_reported():
    draws = (("swinging panel", seed, drawn(seed, PANEL)) for seed in range(1))
    found = list(runs(draws, 1, step=STEP))
    (run,) = found
    assert not run.solved
    assert run.flown["waiting"].found
    assert 0.0 < run.flown["waiting"].least <= FAR
    page = report(found, [], [], "")
    assert "**1 of 1** scenes" in page
    assert "**0 of 1** flights" in page
    hit = run._replace(flown=run.flown | {"waiting": run.flown["waiting"]._replace(least=-0.1)})
    assert "**1 of 1** flights" in report([hit], [], [], "")


def test_scenes_whose_ends_are_blocked_are_drawn_again():
    assert not ends_are_free(drawn(3, PANEL))
    draws = (("swinging panel", seed, drawn(seed, PANEL)) for seed in (3,))
    assert list(runs(draws, 1)) == []


def test_scenes_in_space_hold_a_body_of_each_motion():
    kinds = [type(body.motion).__name__ for body in drawn_in_space(0).scene.bodies]
    assert kinds == ["Drift", "Spin", "Tumble", "Track"]


def test_states_of_a_sampled_path_are_placed_as_those_of_the_lattice():
    pytest.importorskip("ompl")
    from benchmarks.studies.moving.ompl_in_time import Placements

    plan, obstacles = planned()
    placements = Placements(drawn(0, FENCES), STEP)
    times = np.linspace(0.0, 200.0, plan.motion.edges + 1)
    states = np.column_stack([np.array(plan.motion.positions)[:, :2], times])
    assert all(placements.is_free(state) for state in states)
    expected = check_flight(plan, obstacles).separation
    assert placements.least(states) == pytest.approx(expected, abs=1e-9)
    through = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 200.0]])
    careless = check_flight(planned(False)[0], obstacles).separation
    assert careless <= 0.0
    assert placements.least(through) <= 0.0
