"""Pinocchio's kinematic and visual models of a URDF."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meshes.mesh_addresses import find
from ffsr_plan.robots.urdf_validation import Counts


def build_model(text: str, where: str) -> pin.Model:
    """Build the kinematic model of a URDF, its root link on a free-flyer joint.

    Shapes are removed from the text first, because Pinocchio does not know all of them.

    Args:
        text: the URDF, checked.
        where: file or robot name that starts every message.

    Raises:
        InvalidInput: a URDF that Pinocchio refuses, with Pinocchio's message.
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
    """Build the model of the visual shapes that Pinocchio can read.

    Capsules and missing meshes are left out, because Pinocchio would drop other shapes with them.

    Args:
        model: the kinematic model of the same URDF.
        text: the URDF, checked.
        folders: folders in which mesh addresses are looked up.

    Returns:
        The visual shapes; none if Pinocchio refuses them.
    """
    root = ElementTree.fromstring(text)
    for link in root.findall("link"):
        for collision in link.findall("collision"):
            link.remove(collision)
        for visual in link.findall("visual"):
            mesh = visual.find("geometry/mesh")
            path = None if mesh is None else find(mesh.get("filename", ""), folders)
            missing = mesh is not None and path is None
            if missing or visual.find("geometry/capsule") is not None:
                link.remove(visual)
            elif mesh is not None:
                mesh.set("filename", str(path.absolute()))  # type: ignore[union-attr]
    stripped, kind = ElementTree.tostring(root, encoding="unicode"), pin.GeometryType.VISUAL
    try:
        return pin.buildGeomFromUrdfString(model, stripped, kind, package_dirs=list(folders))
    except ValueError:
        return pin.GeometryModel()


def check_loaded(name: str, model: pin.Model, collision: pin.GeometryModel, counts: Counts) -> None:
    """Check that Pinocchio has loaded all links and shapes, and that moving bodies have mass.

    Pinocchio drops some links and shapes without an error.

    Args:
        name: file or robot name that starts every message.
        model: the kinematic model.
        collision: the collision shapes.
        counts: numbers of links and shapes in the URDF.

    Raises:
        InvalidInput: a link or shape is missing, or a moving body has no mass.
    """
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
            allowed = "a mass of the moving link or of a link fixed to it"
            raise InvalidInput(f"{name}, link '{frame.name}'", "0 kg", allowed)
