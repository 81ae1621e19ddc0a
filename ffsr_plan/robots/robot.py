"""`SpaceRobot`: a URDF as a Pinocchio model on a free-flyer joint, with its collision geometry."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from ffsr_plan.core import bundled_files
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import FARTHEST, finite_array, number, one_of, unit_quaternion
from ffsr_plan.core.errors import InvalidInput, unknown_name
from ffsr_plan.core.rotations import IDENTITY, from_angles, to_angles
from ffsr_plan.robots.adjacent_links import may_touch
from ffsr_plan.robots.collision_shapes import (
    CONTAINERS,
    Containers,
    Replacement,
    collision_geometry,
)
from ffsr_plan.robots.kinematics import Tree
from ffsr_plan.robots.pinocchio_models import build_model, check_loaded, visual_model
from ffsr_plan.robots.shape_arrays import Primitives, primitives
from ffsr_plan.robots.srdf import disabled_pairs, named_postures
from ffsr_plan.robots.urdf_validation import check_urdf, parse


class Components(NamedTuple):
    """A configuration taken apart."""

    position: Array
    """(3,) [m], base origin in the world."""
    attitude: Array
    """(3,) [rad], ZYX angles alpha, beta, gamma of Eq. 2."""
    joints: dict[str, float]
    """Joint values by name [rad, or m where prismatic]."""


@dataclass(frozen=True, eq=False)
class SpaceRobot:
    """A free-flying robot. Made by `load_robot`; treat everything in it as read-only.

    A configuration `q` is Pinocchio's vector (nq,): base position (3) [m] and quaternion
    (x, y, z, w) of the base in the world, then the joints. `joint values` (nd,) are plain numbers,
    one a joint in Pinocchio's order [rad or m], for continuous joints as well, which Pinocchio
    keeps as cosine and sine.
    """

    name: str
    urdf: str
    """The URDF text that the robot was made from."""
    model: pin.Model
    collision_model: pin.GeometryModel
    """Collision shapes, with the self-collision pairs: all but those of adjacent links and those
    that the SRDF exempts."""
    visual_model: pin.GeometryModel
    package_dirs: tuple[str, ...] = ()
    replacements: tuple[Replacement, ...] = ()
    """Collision shapes that another solid stands for."""
    containers: Containers = field(default_factory=Containers)
    """What meshes and cylinders were put in."""
    meshes: Mapping[str, Array] = field(default_factory=dict)
    """(n, 3) corners of the convex hulls of the collision meshes, by their address in the URDF,
    before its scale [m]: with these the robot can be made again without the files."""
    srdf: str = ""
    """The SRDF text, empty where there is none."""
    disabled_pairs: tuple[tuple[str, str], ...] = ()
    """Links that the SRDF allows to touch, sorted."""
    joint_names: tuple[str, ...] = field(init=False)
    lower: Array = field(init=False)
    """(nd,) lower joint limits, -inf for continuous joints."""
    upper: Array = field(init=False)
    prismatic: NDArray[np.bool_] = field(init=False)
    """(nd,) booleans: which joint values are metres."""
    _slots: tuple[tuple[int, int], ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        joints = [self.model.joints[j] for j in range(2, self.model.njoints)]
        slots = tuple((j.idx_q, j.nq) for j in joints)
        bounded = [nq == 1 for _, nq in slots]
        lower = [
            self.model.lowerPositionLimit[i] if b else -np.inf
            for (i, _), b in zip(slots, bounded, strict=True)
        ]
        upper = [
            self.model.upperPositionLimit[i] if b else np.inf
            for (i, _), b in zip(slots, bounded, strict=True)
        ]
        fill = object.__setattr__
        fill(self, "joint_names", tuple(self.model.names[j] for j in range(2, self.model.njoints)))
        fill(self, "lower", frozen(np.array(lower, dtype=np.float64)))
        fill(self, "upper", frozen(np.array(upper, dtype=np.float64)))
        sliding = np.array([j.shortname().startswith("JointModelP") for j in joints], dtype=bool)
        sliding.setflags(write=False)
        fill(self, "prismatic", sliding)
        fill(self, "_slots", slots)

    @property
    def nd(self) -> int:
        """Number of joints of the arms, nv - 6."""
        return len(self.joint_names)

    @cached_property
    def tree(self) -> Tree:
        """The kinematic tree, for many configurations at once."""
        return Tree(self.model)

    @cached_property
    def primitives(self) -> Primitives:
        """The collision shapes as arrays."""
        return primitives(self.collision_model)

    @cached_property
    def postures(self) -> Mapping[str, Mapping[str, float]]:
        """Named postures, from the SRDF's group states: joint values [rad or m] by joint.

        A posture speaks of the joints that it lists; the others stay where they are.
        """
        bounds = zip(self.lower.tolist(), self.upper.tolist(), strict=True)
        limits = dict(zip(self.joint_names, bounds, strict=True))
        return named_postures(self.srdf, f"{self.name}, SRDF", limits)

    def neutral(self) -> Array:
        """(nq,) base at the world's origin, joint values zero."""
        return self.assemble(np.zeros(3), IDENTITY, np.zeros(self.nd))

    def configuration(
        self,
        position: ArrayLike = (0.0, 0.0, 0.0),
        attitude: ArrayLike = (0.0, 0.0, 0.0),
        joints: Mapping[str, float] | None = None,
    ) -> Array:
        """(nq,) configuration from the paper's coordinates.

        Args:
            position: (3,) base origin in the world [m].
            attitude: (3,) ZYX angles alpha, beta, gamma [rad] of Eq. 2.
            joints: values by joint name [rad or m]; the others are at zero.

        Raises:
            InvalidInput: unknown joint, not finite, wrong shape, or outside the joint's limits.
        """
        values = np.zeros(self.nd)
        if joints is not None and not isinstance(joints, Mapping):
            raise InvalidInput("joints", joints, "a mapping from joint names to values")
        for name, value in (joints or {}).items():
            if name not in self.joint_names:
                raise unknown_name("joints", name, self.joint_names)
            values[self.joint_names.index(name)] = number(f"joints.{name}", value)
        self.check_limits("joints", values)
        quat = from_angles(finite_array("attitude", attitude, (3,)))
        return self.assemble(finite_array("position", position, (3,), FARTHEST), quat, values)

    def components(self, q: ArrayLike) -> Components:
        """The inverse of `configuration`: position, ZYX angles and joint values by name."""
        q = self.check_configuration("q", q)
        values = self.joint_values(q)
        named = {name: float(v) for name, v in zip(self.joint_names, values, strict=True)}
        return Components(q[:3], frozen(to_angles(q[3:7])), named)

    def paper_vector(self, q: ArrayLike) -> Array:
        """(nd + 6,) the paper's q: x, y, z, alpha, beta, gamma, theta_1 .. theta_nd."""
        parts = self.components(q)
        return np.concatenate([parts.position, parts.attitude, list(parts.joints.values())])

    def from_paper_vector(self, vector: ArrayLike) -> Array:
        """(nq,) configuration of the paper's (nd + 6,) vector."""
        v = finite_array("vector", vector, (self.nd + 6,))
        return self.configuration(
            v[:3], v[3:6], dict(zip(self.joint_names, v[6:].tolist(), strict=True))
        )

    def assemble(self, position: Array, quat_xyzw: Array, joint_values: Array) -> Array:
        """Configurations (..., nq) from arrays (..., 3), (..., 4) and (..., nd); unchecked."""
        lead = np.broadcast_shapes(
            position.shape[:-1], quat_xyzw.shape[:-1], joint_values.shape[:-1]
        )
        q = np.empty((*lead, self.model.nq))
        q[..., :3] = position
        q[..., 3:7] = quat_xyzw
        for k, (i, nq) in enumerate(self._slots):
            if nq == 1:
                q[..., i] = joint_values[..., k]
            else:
                q[..., i] = np.cos(joint_values[..., k])
                q[..., i + 1] = np.sin(joint_values[..., k])
        return q

    def joint_values(self, q: Array) -> Array:
        """Joint values (..., nd) of configurations (..., nq); continuous joints in (-pi, pi]."""
        values = np.empty((*q.shape[:-1], self.nd))
        for k, (i, nq) in enumerate(self._slots):
            values[..., k] = q[..., i] if nq == 1 else np.arctan2(q[..., i + 1], q[..., i])
        return values

    def joint_change(self, begin: Array, end: Array) -> Array:
        """(nd,) from one configuration (nq,) to another, continuous joints the shorter way round.

        Half a turn goes in the positive sense.
        """
        change = self.joint_values(end) - self.joint_values(begin)
        wrapped = np.pi - np.mod(np.pi - change, 2.0 * np.pi)
        return np.where(np.isinf(self.upper), wrapped, change)

    def check_configuration(self, what: str, q: ArrayLike) -> Array:
        """A clean, read-only copy of `q` (nq,).

        Raises:
            InvalidInput: wrong length, not finite, quaternion (or a continuous joint's cosine and
                sine) not of norm one, joint outside its limits.
        """
        checked = np.array(finite_array(what, q, (self.model.nq,)))
        finite_array(f"{what} (base position)", checked[:3], (3,), FARTHEST)
        checked[3:7] = unit_quaternion(f"{what} (base quaternion)", checked[3:7])
        for name, (i, nq) in zip(self.joint_names, self._slots, strict=True):
            if nq == 2 and abs(float(np.hypot(*checked[i : i + 2])) - 1.0) > 1e-6:
                raise InvalidInput(
                    f"{what} (joint {name})", checked[i : i + 2].tolist(), "cosine and sine"
                )
        values = self.joint_values(checked)
        self.check_limits(what, values)
        return frozen(checked)

    def check_limits(self, what: str, joint_values: Array) -> None:
        """Raise `InvalidInput` for the first joint value outside its limits."""
        for k, name in enumerate(self.joint_names):
            if not self.lower[k] <= joint_values[k] <= self.upper[k]:
                raise InvalidInput(
                    f"{what} (joint {name})",
                    float(joint_values[k]),
                    f"{self.lower[k]:g} to {self.upper[k]:g}",
                )

    def save(self, path: str | Path) -> None:
        """Write `urdf` to a `.urdf` file and the SRDF, if there is one, to a `.srdf` beside it.

        Files of the same names are replaced. Meshes that the URDF names are not copied.

        Raises:
            InvalidInput: not a `.urdf` path, or one that cannot be written.
        """
        target = Path(path)
        if target.suffix != ".urdf":
            raise InvalidInput("path", str(path), "a path that ends in .urdf")
        try:
            target.write_text(self.urdf, encoding="utf-8")
            if self.srdf:
                target.with_suffix(".srdf").write_text(self.srdf, encoding="utf-8")
        except OSError as error:
            raise InvalidInput("path", str(path), f"a file to be written ({error})") from None

    def link_of(self, geometry: pin.GeometryObject) -> str:
        """Name of the URDF link that a collision or visual shape belongs to."""
        return str(self.model.frames[geometry.parentFrame].name)


def robot_names() -> list[str]:
    """Names of the bundled robots."""
    return bundled_files.names("urdf", ".urdf")


def load_robot(
    source: str | Path,
    package_dirs: Sequence[str | Path] = (),
    *,
    srdf: str | Path | None = None,
    meshes: str = "hull",
    cylinders: str = "hull",
) -> SpaceRobot:
    """Load a robot whose root link floats freely.

    Boxes, spheres and capsules are taken as they are. A cylinder or a mesh is replaced by a solid
    around it, and `SpaceRobot.replacements` says so.

    Args:
        source: name of a bundled robot (see `robot_names`), or path to a `.urdf` file.
        package_dirs: folders in which `package://` and relative mesh addresses are looked up,
            before the folder of the `.urdf` file.
        srdf: path to an SRDF whose `<disable_collisions>` exempt pairs of links from the check for
            self-collision (adjacent links are exempt in any case) and whose `<group_state>`s are
            the robot's named postures. A bundled robot brings its own.
        meshes: what stands for a mesh: `hull`, its convex hull, or `capsule`, one that contains it.
        cylinders: what stands for a cylinder: `hull`, a prism of 24 sides around it (at most
            0.9 % of the radius larger), or `capsule`, one that contains it (the one with the least
            excess; 41 % of the radius, more for short ones).

    Raises:
        InvalidInput: no such robot or file, or a URDF, SRDF or mesh that cannot be used, with the
            link or joint.
    """
    if not isinstance(source, (str, Path)):
        raise InvalidInput("robot", source, "a name or a path")
    path = bundled_files.find("urdf", str(source), ".urdf")
    if path is not None and srdf is None:
        srdf = bundled_files.find("urdf", str(source), ".srdf")
    if path is None:
        path = Path(source)
        if path.suffix != ".urdf":
            raise unknown_name("robot", str(source), [*robot_names(), "or a path to a .urdf file"])
        if not path.is_file():
            raise InvalidInput("robot", str(source), "a bundled robot or an existing .urdf file")
    if srdf is not None and not isinstance(srdf, (str, Path)):
        raise InvalidInput("srdf", srdf, "a path")
    folders = [*(str(Path(p)) for p in package_dirs), str(path.parent)]
    pairs = "" if srdf is None else _read("srdf", Path(srdf))
    if srdf is not None and not pairs.strip():
        raise InvalidInput("srdf", str(srdf), "a file that is not empty")
    return robot_from_urdf(
        _read("robot", path), path.stem, folders,
        srdf=pairs,
        containers=Containers(meshes, cylinders),
    )  # fmt: skip


def robot_from_urdf(
    text: str,
    name: str,
    package_dirs: Sequence[str] = (),
    *,
    srdf: str = "",
    containers: Containers | None = None,
    meshes: Mapping[str, Array] | None = None,
) -> SpaceRobot:
    """Make a robot from URDF and SRDF texts; see `load_robot`.

    `meshes` holds hull corners by address (see `SpaceRobot.meshes`); these need no file.
    """
    counts = check_urdf(text, name)
    containers = Containers() if containers is None else containers
    for what, kind in containers._asdict().items():
        one_of(what, kind, CONTAINERS)
    folders = list(package_dirs)
    corners = dict(meshes or {})
    model = build_model(text, name)
    collision, replacements = collision_geometry(
        model, parse(text, name), name, folders, containers, corners
    )
    check_loaded(name, model, collision, counts)
    links = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
    disabled = disabled_pairs(srdf, f"{name}, SRDF", links)
    tied = may_touch(parse(text, name))
    shapes = [(str(model.frames[g.parentFrame].name)) for g in collision.geometryObjects]
    for a, first in enumerate(shapes):
        for b, second in enumerate(shapes[:a]):
            ends = tuple(sorted((first, second)))
            if ends not in disabled and not tied(first, second):
                collision.addCollisionPair(pin.CollisionPair(b, a))
    robot = SpaceRobot(
        name, text, model, collision, visual_model(model, text, folders), tuple(folders),
        replacements, containers, corners, srdf, disabled,
    )  # fmt: skip
    robot.postures  # noqa: B018 - so that a wrong one is found now
    return robot


def _read(what: str, path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InvalidInput(what, str(path), f"a readable UTF-8 file ({error})") from None
