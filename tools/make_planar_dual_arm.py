"""Write `urdf/planar_dual_arm.urdf`, the robot of Table 1 of the paper.

The paper is "Ant Colony Algorithm for FFSR Collision Avoidance Motion Planning". Positions of the
shoulders, width and depth of the links, moments of inertia out of the plane, joint limits and
colours are not in the table; they are chosen here.

Usage: `python -m tools.make_planar_dual_arm urdf`.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import yourdfpy


class Body(NamedTuple):
    """A row of Table 1.

    Attributes:
        length: [m].
        mass: [kg].
        inertia: about the centre of mass and the plane's normal [kg m^2].
    """

    length: float
    mass: float
    inertia: float


BASE = Body(0.5, 5.0, 0.20833)
# The table prints .00067 for the right first link. A uniform rod has m L^2 / 12 = .00667, which the
# table prints for the left first link.
ARM = (Body(0.4, 0.5, 0.00667), Body(0.4, 0.5, 0.00667), Body(0.1266, 0.2, 0.00027))

# Our choices
SHOULDER = (0.12, 0.27)
"""(x, |y|) of both shoulders in the base frame [m]: just outside the base, ahead of its centre."""
WIDTHS = (0.09, 0.08, 0.06)
"""Width and depth of the links [m]."""
LIMITS = (1.8, 2.6, 2.4)
"""Largest magnitude of the joint values [rad]."""

_GOLD = (0.86, 0.64, 0.22, 1.0)
_SILVER = (0.80, 0.83, 0.88, 1.0)
_WHITE = (0.93, 0.94, 0.96, 1.0)
_NAVY = (0.10, 0.16, 0.36, 1.0)
_ORANGE = (0.95, 0.45, 0.12, 1.0)


def build_planar_dual_arm() -> yourdfpy.Robot:
    """Table 1 as a planar robot: two arms of three links, all axes along the plane's normal z.

    With all joints at zero the arms point sideways, the left one to +y, the right one to -y. All
    joints rotate about +z, so that mirror-symmetric postures have joint values of opposite sign.

    Returns:
        The robot as yourdfpy writes it.
    """
    import numpy as np
    from yourdfpy import Joint, Limit, Robot

    links = [_base()]
    joints = []
    for side, sign in (("left", 1.0), ("right", -1.0)):
        parent = "base"
        origin = _placement(SHOULDER[0], sign * SHOULDER[1], yaw=sign * np.pi / 2)
        for k, body in enumerate(ARM, start=1):
            name = f"{side}_link_{k}"
            links.append(_link(name, body, WIDTHS[k - 1], tip=k == len(ARM)))
            limit = Limit(effort=20.0, velocity=0.5, lower=-LIMITS[k - 1], upper=LIMITS[k - 1])
            joints.append(
                Joint(
                    name=f"{side}_{k}",
                    type="revolute",
                    parent=parent,
                    child=name,
                    origin=origin,
                    axis=np.array([0.0, 0.0, 1.0]),
                    limit=limit,
                )
            )
            parent, origin = name, _placement(body.length, 0.0)
    return Robot(name="planar_dual_arm", links=links, joints=joints)


def write_planar_dual_arm(path: Path) -> None:
    """Write the URDF file.

    Args:
        path: the file, replaced if it exists.
    """
    import yourdfpy

    urdf = yourdfpy.URDF(build_planar_dual_arm(), build_scene_graph=False, load_meshes=False)
    urdf.write_xml_file(str(path))


def _placement(x: float, y: float, z: float = 0.0, yaw: float = 0.0) -> object:
    import numpy as np

    c, s = np.cos(yaw).round(15), np.sin(yaw).round(15)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1.0]])


def _visual(shape: object, x: float, z: float, colour: tuple[float, ...], name: str) -> object:
    import numpy as np
    from yourdfpy import Color, Material, Visual

    material = Material(name=name, color=Color(rgba=np.array(colour)))
    return Visual(origin=_placement(x, 0.0, z), geometry=shape, material=material)


def _box(x: float, y: float, z: float) -> object:
    import numpy as np
    from yourdfpy import Box, Geometry

    return Geometry(box=Box(size=np.array([x, y, z])))


def _inertial(body: Body, x: float, about_axis: float) -> object:
    """Inertia of a link; `about_axis` is the moment about its x axis, the other two are equal."""
    import numpy as np
    from yourdfpy import Inertial

    moments = np.diag([about_axis, body.inertia, body.inertia])
    return Inertial(origin=_placement(x, 0.0), mass=body.mass, inertia=moments)


def _base() -> yourdfpy.Link:
    from yourdfpy import Collision, Link

    side = BASE.length
    visuals = [
        _visual(_box(side, side, side - 0.06), 0.0, 0.0, _GOLD, "gold"),
        _visual(_box(side - 0.06, side - 0.06, side), 0.0, 0.0, _NAVY, "navy"),
    ]
    box = Collision(name="base", geometry=_box(side, side, side))
    return Link(
        name="base",
        inertial=_inertial(BASE, 0.0, BASE.inertia),  # a cube: all moments equal
        visuals=visuals,
        collisions=[box],
    )


def _link(name: str, body: Body, width: float, tip: bool) -> yourdfpy.Link:
    """A link along its x axis; its box extends half a width behind the joint, over its housing."""
    from yourdfpy import Collision, Cylinder, Geometry, Link

    back = width / 2
    length, middle = body.length + back, (body.length - back) / 2
    shape = _box(length, width, width)
    housing = Geometry(cylinder=Cylinder(radius=back, length=width))
    bar = _box(body.length, 0.7 * width, 0.7 * width)
    return Link(
        name=name,
        inertial=_inertial(body, body.length / 2, body.mass * width**2 / 6),
        visuals=[
            _visual(housing, 0.0, 0.0, _SILVER, "silver"),
            _visual(
                bar, body.length / 2, 0.0, *((_ORANGE, "orange") if tip else (_WHITE, "white"))
            ),
        ],
        collisions=[Collision(name=name, origin=_placement(middle, 0.0), geometry=shape)],
    )


if __name__ == "__main__":
    write_planar_dual_arm(Path(sys.argv[1]) / "planar_dual_arm.urdf")
