"""Pinocchio's kinematic and visual models of a canonical URDF."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from xml.etree import ElementTree

import pinocchio as pin

from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meshes.mesh_addresses import find

_BYTES_PER_CUBE = 128  # four tensors in Pinocchio's data of a model, four data during a plan


def build_model(robot: ElementTree.Element, where: str) -> pin.Model:
    """Build the kinematic model of a robot, its root link on a free-flyer joint.

    Args:
        robot: the canonical `<robot>` element.
        where: file or robot name that starts every message.

    Raises:
        InvalidInput: a URDF that Pinocchio refuses, with Pinocchio's message, or more joints than
            memory allows.
    """
    text = _with_shapes(robot, lambda _: False)  # Pinocchio does not know all shapes
    try:
        model = pin.buildModelFromXML(text, pin.JointModelFreeFlyer())
    except ValueError as error:
        reason = str(error).strip().splitlines()[-1]
        raise InvalidInput(where, reason, "a URDF that Pinocchio can load") from None
    size = {"cube of degrees of freedom": model.nv**3}
    advice = f"fewer than {model.nv - 6} moving joints; `locked` fixes some of them"
    check_memory(where, size, _BYTES_PER_CUBE, advice)
    return model


def visual_model(
    model: pin.Model, robot: ElementTree.Element, folders: Sequence[str]
) -> pin.GeometryModel:
    """Build the model of the visual shapes that Pinocchio can read.

    Capsules and missing meshes are left out, because Pinocchio would drop other shapes with them.

    Args:
        model: the kinematic model of the same URDF.
        robot: the canonical `<robot>` element.
        folders: folders in which mesh addresses are looked up.

    Returns:
        The visual shapes; none if Pinocchio refuses them.
    """
    robot = copy.deepcopy(robot)
    missing = []
    for mesh in robot.iterfind("link/visual/geometry/mesh"):
        path = find(mesh.get("filename", ""), folders)
        if path is None:
            missing.append(mesh)
        else:  # Pinocchio does not look where `find` does
            mesh.set("filename", str(path.absolute()))

    def readable(shape: ElementTree.Element) -> bool:
        unknown = shape.find("geometry/capsule") is not None
        return shape.tag == "visual" and not unknown and shape.find("geometry/mesh") not in missing

    text, kind = _with_shapes(robot, readable), pin.GeometryType.VISUAL
    try:
        return pin.buildGeomFromUrdfString(model, text, kind, package_dirs=list(folders))
    except ValueError:
        return pin.GeometryModel()


def _with_shapes(robot: ElementTree.Element, wanted: Callable[[ElementTree.Element], bool]) -> str:
    """Text of a robot, of its shapes only those that are wanted."""
    stripped = ElementTree.Element(robot.tag, robot.attrib)
    for part in robot:
        if part.tag != "link":
            stripped.append(part)
            continue
        link = ElementTree.SubElement(stripped, "link", part.attrib)
        shapes = ("visual", "collision")
        link.extend(own for own in part if own.tag not in shapes or wanted(own))
    return ElementTree.tostring(stripped, encoding="unicode")
