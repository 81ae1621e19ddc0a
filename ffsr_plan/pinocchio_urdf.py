"""What is left for Pinocchio to read of a URDF: links and joints, and what its pictures show."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

import pinocchio as pin

from ffsr_plan.errors import InvalidInput
from ffsr_plan.mesh_files import find


def build_model(text: str, where: str) -> pin.Model:
    """The model of a checked URDF, its root on a free-flyer joint.

    Made from the text without its shapes: not every one is known to Pinocchio.

    Raises:
        InvalidInput: no tree of links, with Pinocchio's own words.
    """
    root = ElementTree.fromstring(text)
    for link in root.findall("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    try:
        return pin.buildModelFromXML(
            ElementTree.tostring(root, encoding="unicode"), pin.JointModelFreeFlyer()
        )
    except ValueError as error:
        reason = str(error).strip().splitlines()[-1]
        raise InvalidInput(where, reason, "a URDF that Pinocchio can load") from None


def visual_model(model: pin.Model, text: str, folders: Sequence[str]) -> pin.GeometryModel:
    """The visual shapes that Pinocchio can read; pictures do without the others.

    Capsules and missing meshes are left out, because they would take other shapes with them.
    """
    root = ElementTree.fromstring(text)
    for link in root.findall("link"):
        for collision in link.findall("collision"):
            link.remove(collision)
        for visual in link.findall("visual"):
            mesh = visual.find("geometry/mesh")
            lost = mesh is not None and find(mesh.get("filename", ""), folders) is None
            if lost or visual.find("geometry/capsule") is not None:
                link.remove(visual)
    try:
        return pin.buildGeomFromUrdfString(
            model, ElementTree.tostring(root, encoding="unicode"), pin.GeometryType.VISUAL,
            package_dirs=list(folders),
        )  # fmt: skip
    except ValueError:
        return pin.GeometryModel()
