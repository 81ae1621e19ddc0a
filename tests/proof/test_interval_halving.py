"""Interval halving: no free verdict for an edge that touches, no refusal of a clear edge."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.proof.interval_halving import ROUNDING, certify, clearance_bound
from tests.helpers.closed_forms import clearances
from tests.helpers.urdf_builders import random_configuration, random_robot, random_scene

seeds = st.integers(0, 100_000)


class Line:
    """A point passing a disc at lateral distance `y`, in closed form."""

    rounding = ROUNDING

    def __init__(self, y, radius=1.0, end=4.0):
        self.y, self.radius, self.speed, self.asked = y, radius, end, []

    def clearance(self, time):
        self.asked.append(time)
        return math.hypot((time - 0.5) * self.speed, self.y) - self.radius

    def travel(self, begin, end):
        return np.array([(end - begin) * self.speed])

    def margins(self, begin, end, ways):
        return self.clearance(begin) + self.clearance(end) - ways

    @property
    def ends(self):
        return self.clearance(0.0), self.clearance(1.0)


def along_a_line(y, tolerance=1e-4):
    edge = Line(y)
    return certify(edge, edge.ends, tolerance), edge


def test_tangency_counts_as_blocked():
    assert not along_a_line(1.0)[0].free


@given(st.floats(1e-3, 2.0))
def test_an_edge_clearer_than_the_tolerance_is_proven_free(spare):
    assert along_a_line(1.0 + spare)[0].free


@given(st.floats(0.0, 0.999))
def test_an_edge_that_runs_through_is_refused(y):
    verdict, edge = along_a_line(y)
    assert not verdict.free
    assert edge.clearance(verdict.time) == pytest.approx(verdict.least_clearance)


@given(st.floats(1e-12, 9e-5))
def test_an_edge_is_refused_only_below_the_tolerance(spare):
    verdict, _ = along_a_line(1.0 + spare)
    assert verdict.free or verdict.least_clearance <= 1e-4


@given(st.floats(1e-6, 3.0), st.floats(0.01, 0.5))
def test_the_clearance_bound_is_close_below_the_least_clearance(spare, slack):
    edge = Line(1.0 + spare)
    bound, met = clearance_bound(edge, edge.ends, np.inf, slack)
    assert (1.0 - 1.1 * slack) * spare <= bound <= spare * (1 + 1e-12) <= met * (1 + 1e-9)


def test_an_edge_clearer_than_the_path_needs_few_queries():
    edge = Line(3.0)
    ends, edge.asked = edge.ends, []
    bound, met = clearance_bound(edge, ends, 0.1, 0.05)
    assert 0.095 <= bound <= met == 0.1
    assert len(edge.asked) < 10


class TwoLinks(Line):
    """One link is at rest beside an obstacle, another moves far away from obstacles."""

    def __init__(self, beside=0.01):
        super().__init__(0.0, end=2.0)
        self.beside = beside

    def clearance(self, time):
        self.asked.append(time)
        return self.beside

    def travel(self, begin, end):
        return np.array([0.0, (end - begin) * self.speed])

    def margins(self, begin, end, ways):
        return 2.0 * np.array([self.beside, 5.0]) - ways


def test_a_near_link_at_rest_does_not_affect_a_far_moving_one():
    edge = TwoLinks()
    verdict = certify(edge, (0.01, 0.01), 1e-4)
    assert verdict.free
    assert verdict.queries == 0
    assert edge.asked == []


def test_the_queries_of_a_verdict_are_counted():
    edge = Line(1.05)
    ends, edge.asked = edge.ends, []
    verdict = certify(edge, ends, 1e-4)
    assert verdict.free
    halved = {time for time in edge.asked if 0.0 < time < 1.0}
    assert 0 < verdict.queries == len(halved)


def small_problem(seed, mode="free-flying"):
    rng = np.random.default_rng(seed)
    robot = random_robot(seed)
    start = random_configuration(robot, rng, spread=0.0)
    goal = np.array(random_configuration(robot, rng, spread=0.3))
    goal[0] += 6.0
    scene = random_scene(rng, 8, (0.5, -2, -0.6), (5.5, 2, 0.6))
    lattice = fp.Lattice(divisions=6, lateral=fp.Axis(4, 0.4))
    return fp.Problem(robot, scene, start, goal, mode=mode, lattice=lattice)


def roadmap_or_none(problem):
    try:
        return Roadmap(problem)
    except fp.PlanningError:
        return None


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
@given(seed=seeds)
@settings(max_examples=40)
def test_an_edge_reported_free_is_free_at_2000_samples(mode, seed):
    roadmap = roadmap_or_none(small_problem(seed, mode))
    assume(roadmap is not None)
    rng = np.random.default_rng(seed)
    tried = 0
    for _ in range(300):
        layer, tail, head = int(rng.integers(1, 5)), *map(int, rng.integers(0, 9, 2))
        ends = roadmap.clearances[layer, tail], roadmap.clearances[layer + 1, head]
        if min(ends) <= 0.0 or max(ends) > 0.5:  # the edges of interest pass close by
            continue
        verdict = roadmap.certify(layer, tail, head)
        times = np.linspace(0, 1, 2001)
        tried += 1
        path = np.full(7, roadmap.lattice.origin)
        path[layer], path[layer + 1] = tail, head
        q = roadmap.lattice.motion(path).at(np.full(len(times), layer), times)
        least = clearances(roadmap.problem.robot, roadmap.problem.scene, q).min()
        assert least > 0.0 if verdict.free else least <= 1e-3
        if tried == 3:
            break


def test_a_self_collision_on_the_way_closes_the_lattice(robot):
    """Both arms sweep through each other in front of the base; start and goal are free."""
    names = robot.joint_names
    begin, end = (-1.6, -1.0, -0.4, 0.9, 1.9, 1.0), (-1.6, -1.5, -0.7, 1.0, -0.6, 0.6)
    start = robot.configuration(joints=dict(zip(names, begin, strict=True)))
    goal = robot.configuration((6, 0, 0), joints=dict(zip(names, end, strict=True)))
    crossing = fp.Problem(
        robot, fp.Scene([], []), start, goal,
        lattice=fp.Lattice(divisions=8, lateral=fp.Axis(2, 0.3)),
    )  # fmt: skip
    with pytest.raises(fp.NoPath, match="self-collision of 'left_link") as caught:
        Roadmap(crossing)
    assert all(isinstance(o, str) for o in caught.value.obstacles)
    assert 1 <= caught.value.layer <= 8
