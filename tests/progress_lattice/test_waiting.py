"""Lattices with progress: waiting, going back, and what such plans are used for."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.progress_lattice.progress_steps import ProgressSteps
from ffsr_plan.progress_lattice.ways import StraightWay


@pytest.fixture(scope="module")
def door_plan():
    return fp.plan(fp.load_scenario("door"))


def cup():
    """A goal in a cup that opens away from the start; and the robot's start."""
    wall = [(8.0, y, 0.0) for y in np.linspace(-1.9, 1.9, 14)]
    wall += [(x, side * 1.9, 0.0) for x in np.arange(8.2, 11.0, 0.3) for side in (-1, 1)]
    robot, joints = fp.load_robot("planar_dual_arm"), {"left_2": -0.3, "right_2": 0.3}
    return fp.Problem(
        robot,
        fp.Scene(wall, [0.25] * len(wall)),
        robot.configuration((0.0, 0.0, 0.0), joints=joints),
        robot.configuration((10.0, 0.0, 0.0), joints=joints),
        "attitude-held",
        fp.Lattice(45, fp.Axis(16, 0.25), progress=fp.Progress(20, aside=4, beyond=8)),
    )


def test_where_the_way_is_closed_at_its_time_the_robot_waits(door_plan):
    door = door_plan.problem
    with pytest.raises(fp.NoPath, match="progress"):
        fp.plan(replace(door, lattice=replace(door.lattice, progress=None)), fp.LatticeOptimum())
    progress = door_plan.nodes[:, -1]
    assert np.count_nonzero(np.diff(progress) == 0) > 40
    waits = np.flatnonzero(np.all(np.diff(door_plan.nodes, axis=0) == 0, axis=1))
    q = door_plan.configurations
    assert np.array_equal(q[waits], q[waits + 1])
    assert door_plan.verify().ok


def test_a_goal_in_a_cup_is_reached_by_going_back():
    plan = fp.plan(cup())
    assert plan.length < 16.5
    assert np.any(np.diff(plan.nodes[:, -1]) < 0)
    assert plan.nodes[:, -1].max() > 20
    assert plan.verify().ok
    with pytest.raises(fp.NoPath, match="beyond 0: more"):
        fp.plan(replace(cup(), lattice=replace(cup().lattice, progress=fp.Progress(20, aside=4))))


def test_going_back_undoes_the_turn_of_the_base():
    door = fp.load_scenario("door")
    lattice = replace(door.lattice, progress=fp.Progress(6, 3))
    steps = ProgressSteps(StraightWay(replace(door, lattice=lattice)))
    attitudes = steps.motion.attitudes
    share = steps.motion.positions[:, 0] / 10.0
    for place, corner in enumerate(steps.corners):
        again = np.flatnonzero(np.abs(share - share[corner]) < 1e-12)
        assert len(again) > 3
        assert rotations.angle_between(attitudes[corner], attitudes[again]).max() < 1e-9
        assert share[corner] == pytest.approx(place / 6)


@pytest.mark.parametrize("most", [1, 2, 3])
def test_every_step_is_an_edge_of_the_motion_that_makes_them(most):
    door = fp.load_scenario("door")
    progress = fp.Progress(5, most, before=2, beyond=1)
    lattice = replace(door.lattice, progress=progress)
    steps = ProgressSteps(StraightWay(replace(door, lattice=lattice)))
    positions = steps.motion.positions[:, 0] / 2.0
    for place, row in enumerate(steps.edges):
        for step, edge in zip(range(-most, most + 1), row, strict=True):
            inside = 0 <= place + step < len(steps.values)
            assert (edge >= 0) == inside
            if inside:
                ends = positions[edge] + 2.0, positions[edge + 1] + 2.0
                assert ends == pytest.approx((place, place + step))


def test_a_plan_that_waits_is_read_back_from_its_file(door_plan, tmp_path):
    door_plan.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded == door_plan
    data = door_plan.to_dict()
    data["nodes"][5][1] = 99
    with pytest.raises(fp.InvalidInput, match=r"nodes, progress"):
        fp.Plan.from_dict(data)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda nodes: nodes.__setitem__((5, 1), 30), "not those of the nodes"),
        (lambda nodes: nodes.__setitem__((0, 1), 1), "begin at the start"),
        (lambda nodes: nodes.__setitem__((60, 0), 5), "farther from one another"),
    ],
)
def test_nodes_that_contradict_the_motion_are_reported(door_plan, change, words):
    nodes = np.array(door_plan.nodes)
    change(nodes)
    report = replace(door_plan, nodes=nodes).verify()
    assert not report.ok
    assert words in "; ".join(report.problems)


@pytest.mark.parametrize(
    "planner", [fp.MaxMinAntSystem(), fp.AntSystem(), fp.LeastFuel(), fp.Portfolio()]
)
def test_planners_without_time_refuse_progress(planner):
    with pytest.raises(fp.InvalidInput, match="progress"):
        fp.plan(fp.load_scenario("door"), planner)


def test_progress_that_does_not_fit_is_refused():
    door = fp.load_scenario("door")
    with pytest.raises(fp.InvalidInput, match="lattice progress"):
        replace(door, mode="free-floating", lattice=fp.Lattice(9, progress=fp.Progress()))
    axis = fp.PostureAxis({"left_1": 1.0}, 1, 0.1)
    with pytest.raises(fp.InvalidInput, match="lattice postures"):
        replace(door, lattice=fp.Lattice(9, postures=[axis], progress=fp.Progress()))
    with pytest.raises(fp.InvalidInput, match="refine"):
        fp.plan(door, refine=True)
    with pytest.raises(fp.NoPath, match="at least 40 divisions"):
        fp.plan(replace(door, lattice=replace(door.lattice, divisions=30)))
