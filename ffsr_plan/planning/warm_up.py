"""`warm_up`: all kernels compiled before they are needed, on scenes that take next to no time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from ffsr_plan.bodies.debris.debris_cloud import DebrisCloud
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.kernels.compiling_time import Stopwatch
from ffsr_plan.fuel.least_fuel_planner import LeastFuel
from ffsr_plan.planning.plan_and_refine import plan
from ffsr_plan.plans.planner_registry import Planner
from ffsr_plan.portfolio.portfolio_planner import Portfolio
from ffsr_plan.problem.lattice_settings import Axis, Lattice, Progress
from ffsr_plan.problem.posture_axes import PostureAxis
from ffsr_plan.problem.problem import Problem
from ffsr_plan.robots.loading import load_robot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import Box
from ffsr_plan.search.ants.ant_system import AntSystem
from ffsr_plan.search.ants.max_min import MaxMinAntSystem
from ffsr_plan.search.optimum_planner import LatticeOptimum
from ffsr_plan.search.postures.posture_annealing import PostureAnnealing
from ffsr_plan.tree_search.tree_planner import TreePlanner

_MANY = 20_001  # spheres whose tree a kernel builds


def warm_up(on_progress: Callable[[float], object] | None = None) -> int:
    """Compile the kernels of planners, verification and flights, and keep the machine code.

    Otherwise each kernel is compiled when it is first called. That takes some minutes in all, once
    after an installation; an image of a container holds the machine code after this call. Where all
    is compiled, it is loaded, which takes some seconds.

    Args:
        on_progress: called with the share that is done, from 0 to 1.

    Returns:
        The number of kernels that were compiled, each counted once for each signature.

    Raises:
        InvalidInput: `on_progress` is not a function.
    """
    if on_progress is not None and not callable(on_progress):
        raise InvalidInput("on_progress", on_progress, "a function, or None")
    watch, cases = Stopwatch(), list(_cases())
    for done, (problem, planner) in enumerate(cases):
        found = plan(problem, planner, on_interrupt="raise")
        found.verify(1)
        found.timed(joint_acceleration=1.0, thruster_acceleration=1.0)
        if on_progress is not None:
            on_progress((done + 1) / len(cases))
    last = cases[-1][0]
    query, placed = (
        ObstacleQuery(last.robot, last.scene),
        shape_placements(last.robot, last.start[None]),
    )
    query.touching(last.start)  # for messages on contacts
    query.links_at(placed, 0, np.zeros(3))  # for edges that closed forms leave open
    return watch.kernels


def _cases() -> Iterator[tuple[Problem, Planner]]:
    """Small problems, and planners that between them call every kernel."""
    few, many = _hurdle(16), _hurdle(_MANY)
    folding = PostureAxis({"left_2": 1.0}, half_count=1, spacing=0.2)
    yield _across("point", few), MaxMinAntSystem(ants=2, cycles=2)
    yield _across("point", many), AntSystem(ants=2, cycles=2)
    yield _across("satellite_ur5", few), LatticeOptimum()
    yield _across("planar_dual_arm", few), LeastFuel()
    with_lattice = _across("planar_dual_arm", few)
    without = replace(with_lattice, lattice=None)
    yield without, TreePlanner(checks=100_000)
    turned = without.robot.configuration((10.0, 0.0, 0.0), attitude=(0.2, 0.0, 0.0))
    yield replace(without, goal=turned, reach_attitude=True), TreePlanner(checks=20_000)
    yield _in_motion(replace(with_lattice, scene=Scene())), LatticeOptimum()
    yield with_lattice, Portfolio(trees=TreePlanner(checks=10_000))
    yield (
        _across("planar_dual_arm", few, folding),
        PostureAnnealing(ants=2, cycles=2, annealing_shifts=20),
    )


def _in_motion(problem: Problem) -> Problem:
    """Beside the way boxes, at rest and tumbling, and drifting spheres; the robot may wait."""
    tumble = Tumble(inertia=(1.0, 2.0, 3.0), rate=(0.01, 0.0, 0.01))
    box = MovingBody([Box((0.1, 0.1, 0.1))], tumble, position=(5.0, 0.0, 2.0))
    cloud = DebrisCloud([[5.0, 0.0, -2.0]] * 2, [0.1] * 2, [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0]])
    lattice = Lattice(10, Axis(half_count=1, spacing=0.5), progress=Progress(steps=5))
    scene = Scene(shapes=[Box((0.1, 0.1, 0.1), (5.0, 2.0, 0.0))], bodies=[box], debris=[cloud])
    return replace(problem, scene=scene, lattice=lattice, duration=100.0)


def _hurdle(count: int) -> Scene:
    """Spheres in the middle of the way, between two layers: edges are refused there."""
    return Scene(
        [[5.5, 0.4 * k / count, 0.0] for k in range(-count // 2, count // 2)], [0.2] * count
    )


def _across(name: str, hurdle: Scene, *postures: PostureAxis) -> Problem:
    """A robot that has to go around a hurdle."""
    robot = load_robot(name)
    return Problem(
        robot,
        hurdle,
        start=robot.neutral(),
        goal=robot.configuration(position=(10.0, 0.0, 0.0)),
        lattice=Lattice(divisions=10, lateral=Axis(half_count=6, spacing=1.0), postures=postures),
        delta=0.1,
    )
