"""The path of a lattice that needs the least change of velocity, against all proven paths."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.errors import OutOfTime
from ffsr_plan.fuel.lattice_search import least_change_path, programme_of
from ffsr_plan.lattice.edge_states import FREE, REFUSED
from ffsr_plan.time_limit.deadline import Deadline
from tests.helpers.brute_force import first_layer_out_of_reach
from tests.helpers.least_change_by_hand import least_change
from tests.helpers.urdf_builders import random_scene


def problem(seed):
    rng = np.random.default_rng(seed)
    robot_name, normal = ("point", "planar_dual_arm")[seed % 2], seed % 3 == 0
    robot = fp.load_robot(robot_name)
    obstacles, radii = (14, (0.4, 0.9)) if seed % 5 == 0 else (5, (0.2, 0.8))
    scene = random_scene(rng, obstacles, (1.0, -1.5, -0.2), (5.0, 1.5, 0.2), radii)
    arms = {} if robot_name == "point" else {"left_1": -1.2, "right_1": 1.3, "left_2": 0.6}
    return fp.Problem(
        robot,
        scene,
        robot.configuration(),
        robot.configuration((6.0, 0.0, 0.0), joints=arms),
        lattice=fp.Lattice(4, fp.Axis(2, 0.6), fp.Axis(1, 0.5) if normal else None),
    )


def roadmap_or_none(seed):
    try:
        return fp.Roadmap(problem(seed))
    except fp.PlanningError:
        return None


def all_edges_decided(roadmap):
    """The roadmap after a proof of every edge."""
    for i in range(roadmap.lattice.divisions):
        tails = np.flatnonzero(roadmap.admissible[i]).tolist()
        heads = np.flatnonzero(roadmap.admissible[i + 1]).tolist()
        for tail in tails:
            for head in heads:
                roadmap.free(i, tail, head)
    return roadmap


@pytest.mark.parametrize("seed", range(120))
def test_the_best_path_is_that_of_all_paths_over_proven_edges(seed):
    roadmap = roadmap_or_none(seed)
    if roadmap is None:
        return
    every = all_edges_decided(roadmap.without_edge_states())
    settings = roadmap.problem.lattice
    spacing = np.array([getattr(settings, name).spacing for name in settings.axes])
    path, least = least_change(
        roadmap.lattice.indices, spacing, 6.0, every.admissible, every.status
    )
    if path is None:
        with pytest.raises(fp.NoPath) as caught:
            least_change_path(roadmap)
        assert caught.value.layer == first_layer_out_of_reach(every)
        return
    found = least_change_path(roadmap)
    assert found.change == pytest.approx(least, rel=1e-12)
    assert found.bound == pytest.approx(least, rel=1e-12)
    assert found.bound <= found.change
    assert roadmap.without_edge_states().prove_path(found.nodes)
    assert np.count_nonzero(roadmap.status == FREE) <= np.count_nonzero(every.status != REFUSED)


def test_fewer_edges_are_proven_than_there_are():
    roadmap = fp.Roadmap(fp.load_scenario("fig2a"))
    least_change_path(roadmap)
    decided = np.count_nonzero(roadmap.status)
    assert 40 <= decided < 0.05 * roadmap.status.size


class Cut(Deadline):
    """A deadline at the k-th look since `armed`."""

    def __init__(self, looks):
        super().__init__()
        self.looks, self.armed = looks, False

    def check(self):
        if self.armed:
            self.looks -= 1
            if self.looks < 0:
                raise OutOfTime(self.stage, "no path")


def test_at_the_deadline_the_best_proven_path_comes_with_a_bound_below_it():
    outcomes = set()
    for looks in (0, 20, 60, 100, 150, 200, 250, 300, 400, 600, 2000):
        deadline = Cut(looks)
        roadmap = fp.Roadmap(fp.load_scenario("fig2a"), deadline)
        roadmap.evaluate_all()
        exact = least_change_path(fp.Roadmap(fp.load_scenario("fig2a")))
        deadline.armed = True
        try:
            found = least_change_path(roadmap)
        except OutOfTime:
            outcomes.add("none")
            continue
        assert found.bound <= exact.change * (1.0 + 1e-12) <= found.change * (1.0 + 1e-12)
        assert found.change == programme_of(roadmap.lattice).change(found.nodes)
        outcomes.add("exact" if found.bound == found.change else "gap")
    assert {"none", "exact"} <= outcomes
