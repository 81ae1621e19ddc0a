"""A time limit on a clock that ticks at every look: what is proven is kept, all else is cut."""

import contextlib
import pickle
from dataclasses import replace
from itertools import count

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision import distances
from ffsr_plan.lattice import shortest_path
from ffsr_plan.lattice.optimum import OptimumSearch, straight_bound
from ffsr_plan.planning import plan_and_refine
from ffsr_plan.proof.prover import Prover
from ffsr_plan.refinement.refined_path import refined_path
from ffsr_plan.search import lattice_planner, workers
from ffsr_plan.search.ants import max_min
from ffsr_plan.search.postures import (
    annealing_kernels,
    ant_tour_kernels,
    early_proofs,
    posture_annealing,
)
from ffsr_plan.search.records import SearchMonitor, SearchRequest
from ffsr_plan.time_limit.deadline import Deadline

MAX_MIN, ANT_SYSTEM = fp.MaxMinAntSystem(cycles=12), fp.AntSystem(cycles=4, ants=5)
SHORT = fp.PostureAnnealing(ants=4, cycles=6, annealing_shifts=150)
PLANNERS = [MAX_MIN, ANT_SYSTEM, fp.LatticeOptimum()]


@pytest.fixture(scope="module")
def problem():
    return replace(fp.load_scenario("fig2a"), lattice=fp.Lattice(12, fp.Axis(8, 0.3)))


@pytest.fixture(scope="module")
def gate():
    """A gate without a goal attitude, so that few steps find a path."""
    return replace(fp.load_scenario("gate"), reach_attitude=False)


@pytest.fixture
def limited(monkeypatch):
    """Plan with a limit in looks at the clock."""

    def plan(problem, looks, *arguments, **settings):
        plan.ticks = ticks = count()
        deadline = Deadline(float(looks), clock=lambda: float(next(ticks)))
        monkeypatch.setattr(plan_and_refine, "_deadline", lambda _: deadline)
        return fp.plan(problem, *arguments, **settings)

    return plan


def outcome(limited, problem, looks, planner, **settings):
    """The plan, or None if there was no time for one."""
    try:
        return limited(problem, looks, planner, 0, **settings)
    except (fp.OutOfTime, fp.UnprovenPath):
        return None


def moments(limited, problem, planner, number, **settings):
    """Limits from one look to more than all that a plan takes."""
    limited(problem, 10**9, planner, 0, **settings)
    looks = next(limited.ticks)
    return [int(each) for each in np.linspace(1, looks, number)] + [10**9]


@pytest.mark.parametrize("planner", PLANNERS, ids=lambda each: each.name)
def test_at_any_moment_there_is_a_proven_plan_or_an_error_that_says_what_ended(
    limited, problem, planner
):
    whole, plans = fp.plan(problem, planner, 0), []
    for looks in moments(limited, problem, planner, 60):
        plan = outcome(limited, problem, looks, planner)
        plans.append(plan)
        if plan is None:
            continue
        assert plan.verify(5).ok
        assert plan.interrupted or plan == whole
        assert plan.optimum <= whole.optimum * (1.0 + 1e-12)
        assert plan.optimum == whole.optimum or not plan.optimum_is_exact
        assert plan.motion_objective >= 0.999999 * whole.motion_objective
    assert plans[0] is None
    assert plans[-1] == whole
    first = next(k for k, plan in enumerate(plans) if plan is not None)
    assert None not in plans[first:]  # more time never loses a plan
    if not planner.exact:
        assert any(plan.interrupted for plan in plans[first:])
        assert any(not plan.optimum_is_exact for plan in plans[first:])


def test_a_plan_with_a_bound_for_its_optimum_says_so_and_is_kept_so(limited, problem, tmp_path):
    whole = fp.plan(problem, MAX_MIN, 0)
    cut = (
        outcome(limited, problem, looks, MAX_MIN)
        for looks in moments(limited, problem, MAX_MIN, 60)
    )
    plan = next(plan for plan in cut if plan is not None and not plan.optimum_is_exact)
    assert 0.0 < plan.optimum <= whole.optimum
    assert plan.interrupted
    assert "above a bound" in repr(plan)
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == plan
    data = plan.to_dict()
    assert data["optimum_is_exact"] is False


def test_a_plan_file_with_posture_axes_has_no_exact_optimum(gate):
    data = fp.plan(gate, SHORT, 0).to_dict()
    assert data["optimum_is_exact"] is False
    with pytest.raises(fp.InvalidInput, match="optimum_is_exact: got True; allowed: false"):
        fp.Plan.from_dict(data | {"optimum_is_exact": True})


def test_among_postures_too_there_is_a_proven_plan_or_an_error(limited, gate):
    found = []
    for looks in moments(limited, gate, SHORT, 12):
        plan = outcome(limited, gate, looks, SHORT)
        if plan is not None:
            assert plan.verify(5).ok
            found.append(plan)
    assert found[-1] == fp.plan(gate, SHORT, 0)
    assert any(plan.interrupted for plan in found)


def test_a_path_proven_during_the_search_is_returned_if_the_last_proof_has_no_time(
    limited, gate, monkeypatch
):
    prove, proven = posture_annealing.prove_path, []

    def out_of_time(*_):
        raise fp.OutOfTime(1.0, "the last proof")

    def early(lattice, *path):
        proven.append(prove(lattice, *path))
        return proven[-1]

    monkeypatch.setattr(posture_annealing, "prove_path", out_of_time)
    monkeypatch.setattr(early_proofs, "prove_path", early)
    monkeypatch.setattr(early_proofs, "_SEARCH_PER_PROOF", (0.0, 1e9))
    plan = limited(gate, 10**8, replace(SHORT, annealing_shifts=400), 0)
    held = [each for each in proven if each.holds]
    assert len(held) == 1
    assert np.array_equal(plan.motion.positions, held[0].motion.positions)
    assert plan.interrupted
    assert plan.verify(5).ok
    assert plan.certificate.least_clearance > 0.0


def test_without_a_limit_nothing_is_proven_ahead_of_the_end(gate, monkeypatch):
    def never(*_):
        raise AssertionError

    monkeypatch.setattr(early_proofs, "prove_path", never)
    assert not fp.plan(gate, SHORT, 0).interrupted


def test_a_certificate_without_time_claims_nothing(limited, problem, monkeypatch):
    monkeypatch.setattr(Deadline, "close", lambda deadline: setattr(deadline, "_end", 0.0))
    plan = limited(problem, 10**7, MAX_MIN, 0)
    assert plan.certificate.least_clearance == 0.0
    assert plan.verify(5).ok


@pytest.mark.parametrize("planner", [MAX_MIN, ANT_SYSTEM], ids=lambda each: each.name)
def test_of_several_colonies_those_that_had_time_count(limited, problem, planner):
    whole = fp.plan(problem, planner, 0, colonies=3)
    plans = [
        outcome(limited, problem, looks, planner, colonies=3)
        for looks in moments(limited, problem, planner, 12, colonies=3)
    ]
    assert any(plan is not None and plan.interrupted for plan in plans)
    for plan in plans:
        assert plan is None or plan.interrupted or plan == whole


def test_with_little_time_no_process_is_started(problem, monkeypatch):
    def never(*_):
        raise AssertionError

    monkeypatch.setattr(lattice_planner, "run_apart", never)
    plan = fp.plan(problem, MAX_MIN, 0, colonies=2, workers=2, time_limit=2.9)
    assert plan.interrupted or plan == fp.plan(problem, MAX_MIN, 0, colonies=2)
    assert not workers.in_process(SearchRequest(workers=2))
    assert not workers.in_process(SearchRequest(workers=2, deadline=Deadline(60.0)))
    assert workers.in_process(SearchRequest(workers=1, deadline=Deadline(60.0)))


def test_an_error_out_of_time_has_limit_and_stage():
    error = fp.OutOfTime(0.02, "the set-up of the lattice")
    text = (
        "before the time_limit of 0.02 s ended the set-up of the lattice; what may help: a longer"
    )
    assert text in str(error)
    assert isinstance(error, fp.PlanningError)
    again = pickle.loads(pickle.dumps(error))
    assert (again.time_limit, again.stage) == (0.02, "the set-up of the lattice")
    assert "before Ctrl-C ended" in str(fp.OutOfTime(float("inf"), "the search"))


def test_work_in_parts_gives_the_same_plan(problem, gate, monkeypatch):
    short = replace(problem, delta=0.0)
    cases = [(problem, MAX_MIN), (short, fp.LatticeOptimum()), (gate, SHORT)]
    whole = [fp.plan(*case, 0) for case in cases]
    monkeypatch.setattr(distances, "_AT_ONCE", 3)
    monkeypatch.setattr(max_min, "_EDGES_AT_ONCE", 1)
    monkeypatch.setattr(shortest_path, "_EDGES_AT_ONCE", 1)
    monkeypatch.setattr(ant_tour_kernels, "_NODES_AT_ONCE", 5)
    monkeypatch.setattr(annealing_kernels, "_SECONDS_OF_A_PART", 0.0)
    monkeypatch.setattr(max_min, "_SECONDS_PER_CHECK", 0.0)
    assert [fp.plan(*case, 0) for case in cases] == whole


def test_the_nearest_pair_goes_on_from_part_to_part(problem, monkeypatch):
    rows = [[x, y, 0.0] for x in np.arange(1.0, 10.0) for y in (-1.4, 1.4)]  # many equally near
    scene = fp.Scene(rows, [0.2] * len(rows))
    configurations = np.tile(problem.start, (50, 1))
    configurations[:, 0] = np.linspace(0.0, 10.0, 50)
    whole = [distances.ObstacleQuery(problem.robot, scene).distances(configurations)]
    monkeypatch.setattr(distances, "_AT_ONCE", 1)
    monkeypatch.setattr(distances, "_SECONDS_AT_ONCE", 0.0)
    query = distances.ObstacleQuery(problem.robot, scene)
    starts, search = [], distances.nearest_pairs_from

    def noted(*arguments):
        starts.append(arguments[5:])
        return search(*arguments)

    monkeypatch.setattr(distances, "nearest_pairs_from", noted)
    whole.append(query.distances(configurations))
    assert np.array_equal(*whole)
    assert starts[0] == (0, 0)
    assert len(set(starts)) > 5


def test_an_optimum_cut_short_has_a_bound_that_holds(problem):
    exact = fp.plan(problem, fp.LatticeOptimum(), refine=False).optimum
    bounds = []
    for looks in range(1, 400, 6):
        ticks, roadmap = count(), fp.Roadmap(problem)
        roadmap.deadline = Deadline(float(looks), clock=lambda ticks=ticks: float(next(ticks)))
        search = OptimumSearch(roadmap)
        with contextlib.suppress(fp.OutOfTime):
            search.path()
        bounds.append(search.bound)
    assert straight_bound(problem) in bounds
    assert straight_bound(problem) < max(bounds) <= exact * (1.0 + 1e-12)


def test_a_refinement_that_was_cut_short_says_so(problem):
    plan = fp.plan(problem, MAX_MIN, 0, refine=False)
    lattice, prover = plan.lattice, Prover(plan.motion, problem.scene, problem.tolerance)
    still = np.zeros((plan.motion.edges + 1, 3))
    passed = Deadline(stop_requested=lambda: True)
    assert refined_path(lattice, prover, still, plan.clearances, None, passed) == (None, True)


def test_a_path_that_is_proven_before_its_cycle_is_done_counts(problem, monkeypatch):
    roadmap, proven = fp.Roadmap(problem), []
    prove = roadmap.prove_path
    monkeypatch.setattr(
        roadmap, "prove_path", lambda path: prove(path) and not proven.append(path.copy())
    )
    monitor = SearchMonitor(deadline=Deadline(stop_requested=lambda: bool(proven)))
    result = MAX_MIN.search(roadmap, np.random.default_rng(0), monitor)
    assert result.interrupted
    assert np.array_equal(result.path, proven[0])
    assert len(result.history.best) == 1


def test_colonies_that_did_not_run_mark_the_plan(problem):
    roadmap = fp.Roadmap(problem)
    result = MAX_MIN.search(roadmap, np.random.default_rng(0))
    outcome = lattice_planner._Outcome(result, 0, 0, 0)
    assert not lattice_planner._best(roadmap, [outcome], 1).interrupted
    assert lattice_planner._best(roadmap, [outcome], 2).interrupted
