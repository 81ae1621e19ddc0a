"""The comparison of Pinocchio's model with the URDF finds each kind of difference."""

import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.collision_shapes import Containers, collision_geometry
from ffsr_plan.robots.loaded_model_checks import compare
from ffsr_plan.robots.pinocchio_models import build_model
from ffsr_plan.robots.urdf.canonical import read_urdf
from tests.helpers.urdf_builders import box, cylinder, inertial, joint, link, sphere, urdf

ROBOT = urdf(
    link("base", inertial(20.0, (2.0, 2.1, 2.2)), box((0.8, 0.8, 0.8), (0.1, 0, 0))),
    link("panel", inertial(3.0, (0.1, 0.2, 0.25), (0.1, 0.2, 0.3)), sphere(0.2)),
    link("arm", inertial(2.0, (0.1, 0.2, 0.25)), cylinder(0.05, 0.6)),
    joint("fix", "fixed", "base", "panel", (0, 1, 0), (0.1, 0.2, 0.3)),
    joint("j", "revolute", "panel", "arm", (1, 0, 0), (0.4, 0.5, 0.6)),
)


def moved(placement):
    placement.translation = placement.translation + np.array([1e-6, 0, 0])
    return placement


def other_mass(model, shapes):
    body = model.inertias[2]
    model.inertias[2] = pin.Inertia(body.mass * 1.001, body.lever, body.inertia)


def other_center(model, shapes):
    body = model.inertias[1]
    model.inertias[1] = pin.Inertia(body.mass, body.lever + np.array([0, 1e-6, 0]), body.inertia)


def no_tensor(model, shapes):
    body = model.inertias[2]
    model.inertias[2] = pin.Inertia(body.mass, body.lever, 0.0 * body.inertia)


def other_placement(model, shapes):
    model.jointPlacements[2] = moved(model.jointPlacements[2])


def turned_placement(model, shapes):
    model.jointPlacements[2] = model.jointPlacements[2] * pin.SE3(
        pin.utils.rotate("x", 1e-6), np.zeros(3)
    )


def other_link(model, shapes):
    index = next(k for k, f in enumerate(model.frames) if f.name == "panel")
    model.frames[index].placement = moved(model.frames[index].placement)


def other_limit(model, shapes):
    model.upperPositionLimit[7] = 2.9


def other_velocity(model, shapes):
    model.upperVelocityLimit[6] = 2.0


def other_effort(model, shapes):
    model.upperEffortLimit[6] = 2.0


def other_size(model, shapes):
    shapes.geometryObjects[0].geometry.halfSide = np.array([0.4, 0.4, 0.41])


def other_shape_place(model, shapes):
    shapes.geometryObjects[1].placement = moved(shapes.geometryObjects[1].placement)


def other_container(model, shapes):
    shapes.geometryObjects[2].placement = moved(shapes.geometryObjects[2].placement)


def lost_shape(model, shapes):
    shapes.removeGeometryObject("panel_0")


def models():
    root = read_urdf(ROBOT, "made")
    model = build_model(root, "made")
    return root, model, *collision_geometry(model, root, "made", (), Containers(), {})


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (other_mass, "bodies at joint 'j', mass: the model holds 2.002, the URDF says 2.0"),
        (other_center, "bodies at joint 'root_joint', centre of mass"),
        (no_tensor, "bodies at joint 'j', tensor"),
        (other_placement, "joint 'j', position"),
        (turned_placement, "joint 'j', rotation"),
        (other_link, "link 'panel', position"),
        (other_limit, "joint 'j', limits"),
        (other_velocity, "joint 'j', velocity limit"),
        (other_effort, "joint 'j', effort limit"),
        (other_size, "collision shape 'base_0', size"),
        (other_shape_place, "collision shape 'panel_0', position"),
        (other_container, "collision shape 'arm_0', corners"),
        (lost_shape, r"collision shapes \['panel_0'\]"),
    ],
)
def test_a_difference_between_model_and_urdf_is_named(spoil, message):
    root, model, shapes, replacements = models()
    compare(root, model, shapes, replacements)
    spoil(model, shapes)
    with pytest.raises(fp.InternalError, match=message):
        compare(root, model, shapes, replacements)


def test_another_axis_is_found():
    root, _, shapes, replacements = models()
    other = read_urdf(ROBOT.replace("axis xyz='0.0 0.0 1.0'", "axis xyz='0 0 -1'"), "made")
    with pytest.raises(fp.InternalError, match="joint 'j', axis"):
        compare(root, build_model(other, "made"), shapes, replacements)
