"""`RigidTree`: a robot stated as a short list of bodies, as publications state theirs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.robots.robot import SpaceRobot

_NO_TURN = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_FARTHEST = 7.0  # [rad] to both sides, beyond all that is recomputed here


class Body(NamedTuple):
    """A body and the joint by which it hangs on its parent; the joint lies at the body's origin.

    Attributes:
        name: of the body; its joint has the same name with `_joint` behind it.
        mass: [kg]; 0 for a frame only.
        inertia: (3,) principal moments or (3, 3) about the centre of mass, body axes [kg m^2].
        center: (3,) centre of mass in the body frame [m].
        parent: name of the body that it hangs on; empty for the base.
        place: (3,) origin in the parent's frame [m].
        rotation: (3, 3) from its axes to the parent's, at joint value 0.
        moves: whether the joint is revolute, about the body's z axis, instead of fixed.
        capsule: radius and length of a capsule from the origin along x, its collision shape [m].
    """

    name: str
    mass: float
    inertia: ArrayLike = (0.0, 0.0, 0.0)
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    parent: str = ""
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: ArrayLike = _NO_TURN
    moves: bool = True
    capsule: tuple[float, float] | None = None

    @property
    def tensor(self) -> Array:
        """(3, 3) inertia about the centre of mass, body axes [kg m^2]."""
        inertia = np.asarray(self.inertia, dtype=np.float64)
        return np.diag(inertia) if inertia.ndim == 1 else inertia


@dataclass(frozen=True)
class RigidTree:
    """A robot as a list of bodies, each after its parent.

    Attributes:
        name: of the robot.
        bodies: the base first.
    """

    name: str
    bodies: tuple[Body, ...]

    @property
    def mass(self) -> float:
        """Mass of all bodies [kg]."""
        return sum(body.mass for body in self.bodies)

    def on_base(self, mass: float, inertia: ArrayLike) -> RigidTree:
        """The same arms on a base of other mass [kg] and inertia, (3,) or (3, 3) [kg m^2]."""
        base = self.bodies[0]._replace(mass=float(mass), inertia=inertia)
        return RigidTree(self.name, (base, *self.bodies[1:]))

    def robot(self, inertia: str = "exact") -> SpaceRobot:
        """The robot, by way of its URDF; `inertia` as in `load_robot`."""
        return robot_from_urdf(self.urdf(), self.name, inertia=inertia)

    def urdf(self) -> str:
        """The tree as a URDF."""
        parts = [_link(body) for body in self.bodies]
        parts += [_joint(body) for body in self.bodies[1:]]
        return f"<robot name='{self.name}'>{''.join(parts)}</robot>"


def rotation(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Array:
    """(3, 3) rotation by x about x, then by y about the new y, then by z about the new z [rad]."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_euler("XYZ", (x, y, z)).as_matrix())


def _link(body: Body) -> str:
    mass = inertia = ""
    if body.mass > 0.0:
        tensor = body.tensor
        pairs = zip(("xx", "xy", "xz", "yy", "yz", "zz"), tensor[np.triu_indices(3)], strict=True)
        moments = " ".join(f"i{axes}='{float(value)!r}'" for axes, value in pairs)
        inertia = f"<inertia {moments}/>"
        mass = f"<inertial>{_origin(body.center)}<mass value='{body.mass!r}'/>{inertia}</inertial>"
    shape = ""
    if body.capsule is not None:
        radius, length = body.capsule
        middle = _origin((0.5 * length, 0.0, 0.0), (0.0, 0.5 * np.pi, 0.0))
        solid = f"<capsule radius='{radius!r}' length='{length!r}'/>"
        shape = f"<collision>{middle}<geometry>{solid}</geometry></collision>"
    return f"<link name='{body.name}'>{mass}{shape}</link>"


def _joint(body: Body) -> str:
    import pinocchio as pin

    rpy = pin.rpy.matrixToRpy(np.asarray(body.rotation))
    kind, limit = "fixed", ""
    if body.moves:
        kind = "revolute"
        limit = (
            f"<axis xyz='0 0 1'/><limit lower='{-_FARTHEST}' upper='{_FARTHEST}' effort='1' "
            "velocity='1'/>"
        )
    ends = f"<parent link='{body.parent}'/><child link='{body.name}'/>"
    origin = _origin(body.place, rpy)
    return f"<joint name='{body.name}_joint' type='{kind}'>{origin}{ends}{limit}</joint>"


def _origin(xyz: Sequence[float], rpy: Sequence[float] | Array = (0.0, 0.0, 0.0)) -> str:
    place, angles = (" ".join(repr(float(value)) for value in row) for row in (xyz, rpy))
    return f"<origin xyz='{place}' rpy='{angles}'/>"
