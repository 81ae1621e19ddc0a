"""What is left for Pinocchio to read of a URDF: links and joints, and what its pictures show."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meshes.mesh_files import find
from ffsr_plan.robots.urdf_validation import Counts


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


def check_loaded(name: str, model: pin.Model, collision: pin.GeometryModel, counts: Counts) -> None:
    """Pinocchio drops some links and shapes without an error; count what arrived."""
    links = sum(frame.type == pin.FrameType.BODY for frame in model.frames)
    if (links, collision.ngeoms) != counts:
        raise InvalidInput(
            name,
            f"{links} links and {collision.ngeoms} collision shapes after loading",
            f"all {counts.links} links and {counts.collisions} shapes of the file, in one tree",
        )
    base = model.inertias[1]
    if base.mass <= 0.0 or np.linalg.eigvalsh(base.inertia)[0] <= 0.0:
        raise InvalidInput(
            f"{name}, root link", f"mass {base.mass:g} kg", "a mass and a full inertia"
        )
    for frame in model.frames:  # a joint's inertia is that of all links fixed to one another
        if frame.type == pin.FrameType.BODY and model.inertias[frame.parentJoint].mass <= 0.0:
            allowed = "a mass for what moves, the link's own or of a link fixed to it"
            raise InvalidInput(f"{name}, link '{frame.name}'", "0 kg", allowed)
