"""Whether masses and inertias can be those of the bodies: moving bodies have mass, units fit."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from ffsr_plan.core.errors import InvalidInput


def check_bodies(
    robot: ElementTree.Element, where: str, model: pin.Model, collision: pin.GeometryModel
) -> None:
    """Check that moving bodies have mass and the base a full inertia.

    Args:
        robot: the canonical `<robot>` element.
        where: file or robot name that starts every message.
        model: the kinematic model.
        collision: the collision shapes.

    Raises:
        InvalidInput: a moving body has no mass.
    """
    base = model.inertias[1]
    if base.mass <= 0.0 or np.linalg.eigvalsh(base.inertia)[0] <= 0.0:
        raise InvalidInput(
            f"{where}, root link", f"mass {base.mass:g} kg", "a mass and a full inertia"
        )
    for frame in model.frames:  # a joint's inertia is that of all links fixed to one another
        if frame.type == pin.FrameType.BODY and model.inertias[frame.parentJoint].mass <= 0.0:
            allowed = "a mass of the moving link or of a link fixed to it"
            raise InvalidInput(f"{where}, link '{frame.name}'", "0 kg", allowed)
