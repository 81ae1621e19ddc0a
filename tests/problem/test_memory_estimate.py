"""The estimates of memory are of the right order: against the measured peak of whole searches."""

import tracemalloc
from unittest import mock

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import cost_estimate
from ffsr_plan.problem import memory_estimate
from ffsr_plan.search.postures import posture_lattice


def problem(
    robot, divisions, axes=(), postures=(), joints=("left_2",), mode="free-flying", delta=0.0
):
    across = {
        name: fp.Axis(count, 0.6 / count)
        for name, count in zip(("lateral", "normal"), axes, strict=False)
    }
    return fp.Problem(
        robot,
        fp.Scene([[5.0, 3.0, 0.0], [5.0, -3.0, 1.0]], [0.3, 0.3]),
        robot.neutral(),
        robot.configuration((10.0, 0.0, 0.0), joints=dict.fromkeys(joints, 0.3)),
        mode=mode,
        delta=delta,
        lattice=fp.Lattice(divisions, **across, postures=postures),
    )


def estimate_and_peak(job):
    """The largest estimate that a job made, and the most memory that it took [bytes]."""
    estimates = []

    def note(what, counts, bytes_each, advice, fixed=0.0):
        estimates.append(float(np.prod([float(n) for n in counts.values()])) * bytes_each + fixed)

    with (
        mock.patch.object(memory_estimate, "check_memory", note),
        mock.patch.object(posture_lattice, "check_memory", note),
    ):
        job()  # compiles and imports
        tracemalloc.start()
        job()
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    return max(estimates), peak


SEARCHES = [
    (fp.LatticeOptimum(), 500, ()),
    (fp.LatticeOptimum(), 2, (300,)),
    (fp.MaxMinAntSystem(cycles=2), 20, (60,)),
    (fp.MaxMinAntSystem(cycles=2), 30, (4, 4)),
    (fp.AntSystem(cycles=2, ants=5), 20, (60,)),
    (fp.AntSystem(cycles=1, ants=5000), 60, (2,)),
]


@pytest.mark.parametrize(("planner", "divisions", "axes"), SEARCHES, ids=range(len(SEARCHES)))
def test_a_lattice_takes_about_the_memory_estimated(robot, planner, divisions, axes):
    given = problem(robot, divisions, axes)
    estimate, peak = estimate_and_peak(lambda: fp.plan(given, planner, refine=False))
    assert peak / 2.0 < estimate < 3.0 * peak


@pytest.mark.parametrize(
    ("divisions", "axes", "delta"), [(100, (2, 2), 0.0), (40, (40,), 0.1), (1000, (8,), 0.1)]
)
def test_a_refinement_takes_about_the_memory_estimated(robot, divisions, axes, delta):
    given = problem(robot, divisions, axes, delta=delta)
    estimate, peak = estimate_and_peak(lambda: fp.plan(given, "lattice-optimum"))
    assert peak / 2.0 < estimate < 3.0 * peak


ONE, TWO = fp.PostureAxis({"left_1": 1.0}, 12, 0.1), fp.PostureAxis({"right_1": 1.0}, 4, 0.1)
THREE = [fp.PostureAxis({name: 1.0}, 2, 0.1) for name in ("left_1", "right_1", "left_2")]
LATTICES = [
    (20, (), [ONE], "free-flying"),
    (10, (), [ONE, TWO], "free-floating"),
    (20, (), [ONE, TWO], "attitude-held"),
    (10, (60,), [ONE], "free-flying"),
    (12, (), THREE, "free-flying"),
]


@pytest.mark.parametrize(
    ("divisions", "axes", "postures", "mode"), LATTICES, ids=range(len(LATTICES))
)
def test_postures_take_about_the_memory_estimated(robot, divisions, axes, postures, mode):
    given = problem(robot, divisions, axes, postures, mode=mode)
    planner = fp.PostureAnnealing(ants=2, cycles=1, annealing_shifts=0, temperatures=())
    estimate, peak = estimate_and_peak(lambda: fp.plan(given, planner))
    assert peak / 2.0 < estimate < 3.0 * peak


HUGE = [
    ({"divisions": 10**6}, r"layers 1000001 x nodes 1 x .* GB; allowed: at most 2 GB"),
    ({"divisions": 40, "axes": (1000,)}, r"layers 41 x nodes 2001 x nodes of the next layer 2001"),
    ({"divisions": 2, "axes": (10**8, 10**8)}, r"EB; allowed"),
    ({"divisions": 10**9, "axes": (5, 5)}, r"^lattice: got layers 1000000001 x"),
    ({"divisions": 4, "postures": [TWO] * 20}, r"lattice postures: got layers 5 x postures 1\.2"),
    ({"divisions": 4, "postures": [TWO] * 40}, r"lattice postures"),
]


@pytest.mark.parametrize(("lattice", "message"), HUGE, ids=range(len(HUGE)))
def test_what_does_not_fit_is_refused_before_it_is_made(robot, lattice, message):
    tracemalloc.start()
    with pytest.raises(fp.InvalidInput, match=message):
        fp.plan(problem(robot, **lattice))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 3e7


def test_many_colonies_are_refused_by_their_results(robot):
    given = problem(robot, 20, (5,))
    with pytest.raises(fp.InvalidInput, match=r"^colonies: got colonies 1000000000: .* TB"):
        fp.plan(given, colonies=10**9)
    with pytest.raises(fp.InvalidInput, match=r"workers.*at most 256"):
        fp.plan(given, workers=10**6)
    huge = problem(robot, 10**9, (5, 5))
    with pytest.raises(fp.InvalidInput, match=r"^lattice: got layers"):
        fp.plan(huge, colonies=2)


def test_work_that_nothing_can_cut_short_is_refused(robot, monkeypatch):
    given = problem(robot, 20, (5,))
    monkeypatch.setattr(cost_estimate, "MOST_SECONDS", 1e-6)
    with pytest.raises(fp.InvalidInput, match=r"layers 21 x pairs of links 15: .* hours"):
        fp.plan(given)
    turning = problem(robot, 4, postures=[ONE])
    with pytest.raises(fp.InvalidInput, match=r"x points \d+: .* hours"):
        fp.plan(turning)
