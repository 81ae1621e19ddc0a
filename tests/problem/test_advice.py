"""Advice: no axis that cannot exist, no seed where nothing is random, and the numbers that are."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp

WALL = fp.Scene([[2.0, y, 0.0] for y in np.arange(-3.0, 3.1, 0.3)], [0.25] * 21).named("wall.stl")


def refused(problem, *arguments, **settings):
    with pytest.raises(fp.PlanningError) as raised:
        fp.plan(problem, *arguments, **settings)
    return raised.value


def test_a_closed_lattice_names_its_axes_and_those_it_lacks(robot):
    start, goal = robot.configuration(), robot.configuration((5.0, 0.0, 0.0))
    problem = fp.Problem(robot, WALL, start, goal, lattice=fp.Lattice(10, fp.Axis(3, 0.2)))
    error = refused(problem)
    assert isinstance(error, fp.NoPath)
    text = "; ".join(error.advice)
    assert "lattice.lateral, which has half_count 3 and spacing 0.2 m" in text
    assert "a normal axis" in text
    assert "more than 10 divisions" in text
    assert "lattice.postures" in text
    assert "seed" not in str(error)
    assert {c.obstacle for c in error.contacts} == set(error.obstacles)
    assert {c.source for c in error.contacts} == {"wall.stl"}
    assert {c.link for c in error.contacts} <= set(robot.link_names)
    assert "wall.stl (spheres " in str(error)


def test_an_end_within_the_tolerance_of_an_obstacle_is_the_cause_and_nothing_else(point):
    """Its clearance grows on the way, but nothing can be proven at its beginning."""
    radius = point.collision_model.geometryObjects[0].geometry.radius
    scene = fp.Scene([[0.0, -1.0, 0.0]], [1.0 - radius - 1e-9])
    start, goal = point.configuration(), point.configuration((4.0, 0.0, 0.0))
    lattice = fp.Lattice(10, fp.Axis(2, 0.3))
    for ends, name in (((start, goal), "start"), ((goal, start), "goal")):
        error = refused(fp.Problem(point, scene, *ends, lattice=lattice))
        (advice,) = error.advice
        assert advice.startswith(f"a {name} with more clearance than the tolerance of 0.0001 m")
        assert "it has 1e-09 m" in advice


def test_a_robot_without_joints_is_not_told_of_postures(point):
    goal = point.configuration((4.0, 0.0, 0.0))
    problem = fp.Problem(point, WALL, point.configuration(), goal, lattice=fp.Lattice(8))
    assert "posture" not in str(refused(problem))


@pytest.mark.parametrize("mode", ["free-floating", "free-flying"])
def test_offsets_are_not_advised_where_the_base_does_not_travel(robot, mode):
    start = robot.configuration(joints={"left_1": -1.2})
    goal = robot.configuration(joints={"left_1": 1.2})
    tip = np.array([0.9, 0.9, 0.0])
    scene = fp.Scene([tip], [0.2]).named("tank.obj")
    problem = fp.Problem(robot, scene, start, goal, mode=mode, lattice=fp.Lattice(12))
    error = refused(problem)
    assert isinstance(error, fp.NoPath)
    text = str(error)
    assert "tank.obj (sphere 0)" in text
    for absent in ("lateral", "normal", "spacing", "finer", "more than 12", "seed"):
        assert absent not in text
    assert "this lattice holds one path" in text


def test_self_collision_on_the_way_is_not_helped_by_offsets(robot):
    begin, end = (-1.6, -1.0, -0.4, 0.9, 1.9, 1.0), (-1.6, -1.5, -0.7, 1.0, -0.6, 0.6)
    start, goal = (
        robot.configuration((x, 0, 0), joints=dict(zip(robot.joint_names, values, strict=True)))
        for x, values in ((0, begin), (6, end))
    )
    error = refused(fp.Problem(robot, fp.Scene(), start, goal, lattice=fp.Lattice(8)))
    assert "no offset of the base changes" in str(error)
    assert "finer" not in str(error)


def test_an_unproven_path_names_its_axes_and_another_seed():
    problem = fp.load_scenario("gate")
    blocked = replace(problem, scene=problem.scene + WALL, reach_attitude=False)
    weak = fp.PostureAnnealing(ants=2, cycles=2, annealing_shifts=2)
    error = refused(blocked, weak)
    assert isinstance(error, fp.UnprovenPath)
    text = str(error)
    for part in ("another seed", "lattice.postures.0", "lattice.lateral, which has", "annealing"):
        assert part in text
    assert "time_limit" not in text
    assert error.source in ("wall.stl", "obstacles.0", "obstacles.1", "gates.0")
    cut = refused(blocked, replace(weak, annealing_shifts=10**5), time_limit=0.2)
    assert "a longer time_limit" in str(cut)
