"""Plan files changed at random, with a digest made anew: refused, not verified, or true."""

import json

import coal
import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from ffsr_plan.plans.plan_file import digest
from tests.helpers.mutated_tables import mutated

MUTATIONS = 200  # of each of three plans
STATED_ONLY = {
    "seed", "history", "trails", "planner", "interrupted", "seconds", "optimum", "tolerance",
    "optimum_is_exact",
    "edges_free", "edges_refused", "node_queries", "edge_queries", "excess",
}  # fmt: skip
"""What `Report.not_checked` lists."""


def plans():
    robot = fp.load_robot("planar_dual_arm")
    start = robot.configuration(joints={"left_1": -0.6})
    goal = robot.configuration((2.0, 0, 0), joints={"left_1": 0.3})
    scene = fp.Scene([[0.5, 1.6, 0], [3.0, 2.5, 0], [1.2, -1.7, 0.1]], [0.1, 0.2, 0.2])
    lattice = fp.Lattice(6, fp.Axis(3, 0.2))
    problem = fp.Problem(robot, scene, start, goal, lattice=lattice, delta=0.02)
    yield fp.plan(problem, fp.AntSystem(cycles=3), refine=False)
    yield fp.plan(problem, fp.MaxMinAntSystem(cycles=3))
    turn = fp.PostureAxis({"left_2": 1.0}, 2, 0.2)
    problem = fp.Problem(robot, scene, start, goal, lattice=fp.Lattice(6, postures=[turn]))
    yield fp.plan(problem)


def truth_of(plan):
    """Whether a motion begins and ends where it should, and touches nothing, by Coal at samples."""
    problem, robot = plan.problem, plan.problem.robot
    model, data = robot.model, robot.model.createData()
    shapes = pin.GeometryModel(robot.collision_model)
    for center, radius in zip(problem.scene.centers, problem.scene.radii, strict=True):
        k = shapes.addGeometryObject(
            pin.GeometryObject(
                f"o{shapes.ngeoms}", 0, pin.SE3(np.eye(3), center), coal.Sphere(radius)
            )
        )
        for link in range(len(robot.collision_model.geometryObjects)):
            shapes.addCollisionPair(pin.CollisionPair(link, k))
    geometry = shapes.createData()
    free = not any(
        pin.computeCollisions(model, data, shapes, geometry, q, True)
        for q in plan.at(np.linspace(0.0, 1.0, 601))
    )
    first, last = plan.at([0.0, 1.0])
    return (
        free
        and np.allclose(first, problem.start, atol=1e-8)
        and np.allclose(last[:3], problem.goal[:3], atol=1e-8)
        and np.allclose(last[7:], problem.goal[7:], atol=1e-8)
    )


def attempted(path):
    """A plan, or the message of its refusal."""
    try:
        return fp.Plan.load(path), ""
    except fp.InvalidInput as error:
        return None, str(error)


@pytest.fixture(scope="module")
def originals():
    return list(plans())


def test_the_originals_verify(originals):
    for plan in originals:
        assert plan.verify().ok
        assert truth_of(plan)


@pytest.mark.parametrize("which", [0, 1, 2])
def test_a_changed_plan_is_refused_not_verified_or_true(originals, tmp_path, which):
    original = originals[which]
    data, path = original.to_dict(), tmp_path / "plan.json"
    rng, outcomes = (
        np.random.default_rng(which),
        {"refused": 0, "not ok": 0, "stated only": 0, "true": 0},
    )
    for _ in range(MUTATIONS):
        changed, place, how = mutated(data, rng)
        if changed == data:
            continue
        path.write_text(json.dumps({"sha256": digest(changed), **changed}))
        where = f"{'.'.join(map(str, place))}: {how}"
        loaded, message = attempted(path)
        if loaded is None:
            assert message.startswith(f"plan file '{path}'"), where
            assert "\n" not in message, where
            outcomes["refused"] += 1
            continue
        report = loaded.verify()
        if not report.ok:
            outcomes["not ok"] += 1
        elif STATED_ONLY & set(map(str, place)):
            outcomes["stated only"] += 1
        else:
            assert truth_of(loaded), where
            assert loaded.length == pytest.approx(original.length, rel=1e-6), where
            assert loaded.objective == pytest.approx(original.objective, rel=1e-6), where
            outcomes["true"] += 1
    assert outcomes["refused"] > 0.4 * MUTATIONS
    assert outcomes["not ok"] > 0.03 * MUTATIONS, outcomes
