"""Lattices among bodies that move, against all paths."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from benchmarks.studies.moving.all_paths import SampledScene, agree, small_problem
from ffsr_plan.core.errors import GoalInCollision, InvalidInput, StartInCollision


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
@pytest.mark.parametrize("seed", range(8))
def test_the_optimum_past_moving_bodies_is_the_best_of_all_paths(seed, mode):
    equal, _ = agree(small_problem(seed, mode))
    assert equal


@pytest.mark.parametrize(
    ("seed", "mode"), [(0, "free-flying"), (2, "attitude-held"), (7, "free-flying")]
)
def test_the_optimum_past_debris_is_the_best_of_all_paths(seed, mode):
    equal, found = agree(small_problem(seed, mode, debris=True))
    assert equal
    assert found


def test_bodies_that_move_need_a_duration_that_their_motions_know():
    problem = small_problem(0)
    changed = {"duration": None, "ramp": 0.0}
    with pytest.raises(InvalidInput, match="duration"):
        replace(problem, **changed)
    body = fp.MovingBody(
        [fp.Ball(0.2)], fp.Tumble((1.0, 1.5, 2.0), (0.1, 0.0, 0.0), known_until=50.0)
    )
    with pytest.raises(InvalidInput, match="at most 50 s"):
        replace(problem, scene=fp.Scene(bodies=[body]))
    with pytest.raises(InvalidInput, match="ramp"):
        replace(problem, scene=fp.Scene(), **changed | {"ramp": 0.1})


def test_a_clearance_needs_the_time_of_the_bodies():
    problem = small_problem(0)
    with pytest.raises(InvalidInput, match="scene bodies"):
        fp.clearance(problem.robot, problem.scene, problem.start)


def test_a_start_that_a_body_touches_is_named():
    problem = small_problem(0)
    body = fp.MovingBody([fp.Ball(0.2)], fp.Drift((0.1, 0.0, 0.0)), name="debris")
    with pytest.raises(StartInCollision, match="ball 'debris'"):
        fp.plan(replace(problem, scene=fp.Scene(bodies=[body])))
    late = fp.MovingBody([fp.Ball(0.2)], fp.Drift((0.1, 0.0, 0.0)), (-2.0, 0.0, 0.0), name="debris")
    with pytest.raises(GoalInCollision, match="ball 'debris'"):
        fp.plan(replace(problem, scene=fp.Scene(bodies=[late])))


def test_a_flight_that_is_early_or_late_by_less_than_its_slip_is_free():
    robot, velocity = fp.load_robot("planar_dual_arm"), np.array([0.0, 0.05, 0.0])
    at = np.array([2.0, -2.6, 0.0])
    problem = fp.Problem(
        robot,
        fp.Scene(bodies=[fp.MovingBody([fp.Ball(0.3)], fp.Drift(velocity), at)]),
        robot.neutral(),
        robot.configuration((4.0, 0.0, 0.0), joints={"left_1": 0.6}),
        lattice=fp.Lattice(20, lateral=fp.Axis(4, 0.25)),
        duration=60.0,
    )
    plan = fp.plan(problem, fp.LatticeOptimum())
    assert plan.slip == pytest.approx(plan.certificate.least_clearance / 0.05)
    places = np.linspace(0.0, 20.0, 401)
    edge = np.minimum(places.astype(np.int64), 19)
    q, nearest = plan.motion.at(edge, places - edge), []
    for late in (-0.999 * plan.slip, 0.0, 0.999 * plan.slip):
        moved = fp.MovingBody([fp.Ball(0.3)], fp.Drift(velocity), at + late * velocity)
        scene = SampledScene(robot, fp.Scene(bodies=[moved]))
        nearest.append(scene.distances(q, 3.0 * places).min())
    assert min(nearest) > 0.0
    assert min(nearest) < 0.5 * nearest[1]
    assert fp.plan(replace(problem, scene=fp.Scene())).slip == np.inf
