"""`SpaceRobot`: a URDF as a Pinocchio model on a free-flyer joint, with its collision geometry."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from ffsr_plan.core.arrays import Array, ReadOnlyDict, Records, content, frozen
from ffsr_plan.core.checks import (
    FARTHEST,
    finite_array,
    normalised,
    number,
    unit_quaternion,
    unknown_name,
)
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import counted, html_table
from ffsr_plan.core.rotations import IDENTITY, from_angles, to_angles
from ffsr_plan.core.text_files import write_files
from ffsr_plan.robots.collision_shapes import Containers, Replacement
from ffsr_plan.robots.kinematics import Components, Tree
from ffsr_plan.robots.shape_arrays import Primitives, primitives
from ffsr_plan.robots.srdf import NO_POSTURE, named_postures
from ffsr_plan.robots.urdf.inertias import Balanced
from ffsr_plan.robots.urdf.joints import NO_JOINT, RateLimits

_HALF_TURN_BAND = 1e-9  # [rad] by which rounding may miss half a turn of a continuous joint


@dataclass(frozen=True, eq=False)
class SpaceRobot:
    """A free-flying robot. Made by `load_robot` or `compose`; everything in it is read-only.

    Two robots are equal if they were made from the same texts, meshes and options.

    A configuration `q` is Pinocchio's vector (nq,): base position (3) [m] and quaternion
    (x, y, z, w) of the base in the world, then the joints. `joint values` (nd,) are plain numbers,
    one per joint in Pinocchio's order [rad, or m where prismatic]. This holds for continuous joints
    as well, which Pinocchio stores as cosine and sine.

    Attributes:
        name: name of the robot.
        urdf: what was read of the URDF, as a URDF of its own: known elements only, every number
            with all its digits, orientations as roll, pitch and yaw.
        model: Pinocchio model, the root link on a free-flyer joint.
        collision_model: collision shapes and the pairs checked for self-collision: all pairs except
            those of adjacent links and those that the SRDF exempts.
        visual_model: visual shapes that Pinocchio can read.
        package_dirs: folders in which mesh addresses are looked up.
        replacements: collision shapes that are replaced by another solid.
        containers: which kinds of solids replace meshes and cylinders.
        meshes: (n, 3) corners of the convex hulls of the collision meshes by their address in the
            URDF, before its scale [m]. With these the robot can be made without the mesh files.
        srdf: the SRDF text; empty if there is none.
        disabled_pairs: pairs of links that the SRDF allows to touch, sorted.
        unchecked_links: links with a mass or a visual shape but no collision shape: nothing keeps
            them clear of obstacles, and `Plan.verify` does not check them either.
        balanced: links whose inertia tensor was balanced; see `load_robot`.
        rate_limits: limits of acceleration and jerk by joint, from URDF 1.2.
        joint_names: (nd) names of the joints.
        lower: (nd,) lower joint limits [rad or m], -inf for continuous joints.
        upper: (nd,) upper joint limits [rad or m], inf for continuous joints.
        prismatic: (nd,) booleans, true where the joint value is in metres.
        acceleration: (nd,) limits of the joints' acceleration [rad/s^2 or m/s^2], from URDF 1.2,
            the lesser of its `acceleration` and `deceleration`; inf where the URDF has none.
        jerk: (nd,) limits of the joints' jerk [rad/s^3 or m/s^3], from URDF 1.2; inf where the URDF
            has none.
        postures: joint values [rad or m] by joint, by name of the posture, from the group states of
            the SRDF. A posture may list some of the joints only.
    """

    name: str
    urdf: str
    model: pin.Model
    collision_model: pin.GeometryModel
    visual_model: pin.GeometryModel
    package_dirs: tuple[str, ...] = ()
    replacements: tuple[Replacement, ...] = ()
    containers: Containers = field(default_factory=Containers)
    meshes: Mapping[str, Array] = field(default_factory=dict)
    srdf: str = ""
    disabled_pairs: tuple[tuple[str, str], ...] = ()
    unchecked_links: tuple[str, ...] = ()
    balanced: tuple[Balanced, ...] = ()
    rate_limits: Mapping[str, RateLimits] = field(default_factory=dict, repr=False)
    joint_names: tuple[str, ...] = field(init=False)
    lower: Array = field(init=False)
    upper: Array = field(init=False)
    prismatic: NDArray[np.bool_] = field(init=False)
    acceleration: Array = field(init=False)
    jerk: Array = field(init=False)
    postures: Mapping[str, Mapping[str, float]] = field(init=False)
    _slots: tuple[tuple[int, int], ...] = field(init=False, repr=False)  # index and length in q

    def __post_init__(self) -> None:
        joints = [self.model.joints[j] for j in range(2, self.model.njoints)]
        slots = tuple((j.idx_q, j.nq) for j in joints)
        lowest, highest = self.model.lowerPositionLimit, self.model.upperPositionLimit
        lower = [float(lowest[i]) if nq == 1 else -np.inf for i, nq in slots]
        upper = [float(highest[i]) if nq == 1 else np.inf for i, nq in slots]
        names = tuple(self.model.names[j] for j in range(2, self.model.njoints))
        prismatic = [j.shortname().startswith("JointModelP") for j in joints]
        limits = dict(zip(names, zip(lower, upper, strict=True), strict=True))
        rates = [self.rate_limits.get(name, RateLimits(np.inf, np.inf)) for name in names]
        fixed = [f.name for f in self.model.frames if f.type == pin.FrameType.FIXED_JOINT]
        derived = {
            "joint_names": names,
            "lower": frozen(np.array(lower, dtype=np.float64)),
            "upper": frozen(np.array(upper, dtype=np.float64)),
            "prismatic": frozen(np.array(prismatic, dtype=np.bool_)),
            "acceleration": frozen(np.array([r.acceleration for r in rates], dtype=np.float64)),
            "jerk": frozen(np.array([r.jerk for r in rates], dtype=np.float64)),
            "postures": ReadOnlyDict(
                {
                    name: ReadOnlyDict(values)
                    for name, values in named_postures(
                        self.srdf, f"{self.name}, SRDF", limits, fixed
                    ).items()
                }
            ),
            "_slots": slots,
        }
        for attribute, value in derived.items():
            object.__setattr__(self, attribute, value)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, SpaceRobot):
            return NotImplemented
        return self is other or self._content() == other._content()

    def __hash__(self) -> int:
        return hash((self.name, self.urdf, self.srdf))

    def _content(self) -> object:
        """All that the robot was made from."""
        made_from = (self.name, self.urdf, self.srdf, self.package_dirs, self.containers)
        return content((*made_from, self.meshes))

    def __repr__(self) -> str:
        return (
            f"SpaceRobot('{self.name}': {counted(self.nd, 'joint')}, {self.mass:.4g} kg, "
            f"{counted(len(self.link_names), 'link')})"
        )

    def _repr_html_(self) -> str:
        rows = {
            "joints": ", ".join(self.joint_names) or "none",
            "mass": f"{self.mass:.4g} kg",
            "links": str(len(self.link_names)),
            "postures": ", ".join(self.postures) or "none",
        }
        if self.unchecked_links:
            rows["not checked"] = ", ".join(self.unchecked_links)
        return html_table(f"SpaceRobot {self.name}", rows)

    @property
    def nd(self) -> int:
        """Number of joints of the arms, nv - 6."""
        return len(self.joint_names)

    @cached_property
    def tree(self) -> Tree:
        """The kinematic tree, which computes poses of many configurations at once."""
        return Tree(self.model)

    @cached_property
    def bodies(self) -> Records:
        """The links and their masses as arrays for compiled kernels."""
        return self.tree.bodies(self.model)

    @cached_property
    def primitives(self) -> Primitives:
        """The collision shapes as arrays."""
        return primitives(self.collision_model)

    @property
    def mass(self) -> float:
        """Mass of all bodies [kg]."""
        return float(sum(inertia.mass for inertia in self.model.inertias))

    @property
    def link_names(self) -> tuple[str, ...]:
        """Names of all links of the URDF."""
        frames = self.model.frames
        return tuple(frame.name for frame in frames if frame.type == pin.FrameType.BODY)

    def neutral(self) -> Array:
        """(nq,) configuration with the base at the world's origin and all joint values zero.

        A joint whose limits exclude zero is at the limit nearest to it.
        """
        return self.assemble(np.zeros(3), IDENTITY, self._nearest_to_zero())

    def configuration(
        self,
        position: ArrayLike = (0.0, 0.0, 0.0),
        attitude: ArrayLike = (0.0, 0.0, 0.0),
        joints: str | Mapping[str, float] | None = None,
    ) -> Array:
        """Configuration from base position, base attitude and joint values.

        Args:
            position: (3,) base origin in the world [m].
            attitude: (3,) ZYX angles alpha, beta, gamma of Eq. 2 [rad].
            joints: joint values by name [rad or m], or the name of a posture of the SRDF; joints
                that are not listed are at zero. To change a posture, merge mappings:
                `joints={**robot.postures["stowed"], "elbow": 0.2}`.

        Returns:
            (nq,) configuration.

        Raises:
            InvalidInput: unknown joint or posture, not finite, wrong shape, or outside the joint's
                limits.
        """
        if isinstance(joints, str):
            if joints not in self.postures:
                raise unknown_name("joints", joints, self.postures, NO_POSTURE)
            joints = self.postures[joints]
        if joints is not None and not isinstance(joints, Mapping):
            allowed = "a mapping from joint names to values, or the name of a posture"
            raise InvalidInput("joints", joints, allowed)
        values = self._nearest_to_zero()
        for name, value in (joints or {}).items():
            if name not in self.joint_names:
                raise unknown_name("joints", name, self.joint_names, NO_JOINT)
            values[self.joint_names.index(name)] = number(f"joints.{name}", value)
        self.check_limits("joints", values)
        quat = from_angles(finite_array("attitude", attitude, (3,)))
        return self.assemble(finite_array("position", position, (3,), FARTHEST), quat, values)

    def _nearest_to_zero(self) -> Array:
        """(nd,) joint values nearest to zero within the limits [rad or m]."""
        return np.clip(np.zeros(self.nd), self.lower, self.upper)

    def components(self, q: ArrayLike) -> Components:
        """Base position, base attitude and joint values of configurations.

        This is the inverse of `configuration`.

        Args:
            q: (nq,) one configuration, or (N, nq).

        Returns:
            The components of one configuration, or arrays of N rows.

        Raises:
            InvalidInput: not a configuration of this robot; of N, the first that is not.
        """
        if np.ndim(q) == 2:
            rows = [*q]  # type: ignore[misc]
            checked = np.array(
                [self.check_configuration(f"q[{k}]", row) for k, row in enumerate(rows)]
            ).reshape(-1, self.model.nq)
        else:
            checked = self.check_configuration("q", q)
        values = self.joint_values(checked)
        joints = {
            name: float(values[k]) if values.ndim == 1 else frozen(values[:, k].copy())
            for k, name in enumerate(self.joint_names)
        }
        return Components(checked[..., :3], frozen(to_angles(checked[..., 3:7])), joints)

    def paper_vector(self, q: ArrayLike) -> Array:
        """The paper's q, (nd + 6,): x, y, z [m], alpha, beta, gamma [rad], theta_1 .. theta_nd.

        Args:
            q: (nq,) configuration.
        """
        parts = self.components(q)
        return np.concatenate([parts.position, parts.attitude, list(parts.joints.values())])

    def from_paper_vector(self, vector: ArrayLike) -> Array:
        """(nq,) configuration from the paper's vector (nd + 6,); see `paper_vector`."""
        v = finite_array("vector", vector, (self.nd + 6,))
        return self.configuration(
            v[:3], v[3:6], dict(zip(self.joint_names, v[6:].tolist(), strict=True))
        )

    def assemble(self, position: Array, quat_xyzw: Array, joint_values: Array) -> Array:
        """Configurations from arrays, without any check.

        Args:
            position: (..., 3) base origin in the world [m].
            quat_xyzw: (..., 4) base attitude.
            joint_values: (..., nd) [rad or m].

        Returns:
            (..., nq) configurations.
        """
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
        values = np.empty((*q.shape[:-1], len(self._slots)))
        for k, (i, nq) in enumerate(self._slots):
            values[..., k] = q[..., i] if nq == 1 else np.arctan2(q[..., i + 1], q[..., i])
        return values

    def joint_change(self, begin: Array, end: Array) -> Array:
        """Change of the joint values from one configuration to another.

        A continuous joint takes the shorter direction; half a turn is positive, also if rounding
        makes it 1e-9 rad more or less.

        Args:
            begin: (nq,) first configuration.
            end: (nq,) second configuration.

        Returns:
            (nd,) change of the joint values [rad or m].
        """
        change = self.joint_values(end) - self.joint_values(begin)
        wrapped = np.pi - np.mod(np.pi - change, 2.0 * np.pi)
        wrapped = np.where(wrapped < -np.pi + _HALF_TURN_BAND, wrapped + 2.0 * np.pi, wrapped)
        return np.where(np.isinf(self.upper), wrapped, change)

    def check_configuration(self, what: str, q: ArrayLike) -> Array:
        """Check a configuration.

        Args:
            what: name of the argument in error messages.
            q: (nq,) configuration.

        Returns:
            (nq,) read-only copy; quaternion, and cosine and sine, normalised. What has been
            checked once is returned bit for bit.

        Raises:
            InvalidInput: wrong length, not finite, a quaternion (or cosine and sine of a continuous
                joint) not of norm one, or a joint outside its limits.
        """
        checked = np.array(finite_array(what, q, (self.model.nq,)))
        finite_array(f"{what} (base position)", checked[:3], (3,), FARTHEST)
        checked[3:7] = unit_quaternion(f"{what} (base quaternion)", checked[3:7])
        for name, (i, nq) in zip(self.joint_names, self._slots, strict=True):
            pair = checked[i : i + nq]
            if nq == 2:
                if abs(float(np.hypot(*pair)) - 1.0) > 1e-6:
                    raise InvalidInput(f"{what} (joint {name})", pair.tolist(), "cosine and sine")
                checked[i : i + nq] = normalised(pair)
        self.check_limits(what, self.joint_values(checked))
        return frozen(checked)

    def check_limits(self, what: str, joint_values: Array) -> None:
        """Raise `InvalidInput` that names all joint values outside their limits."""
        outside = ~((self.lower <= joint_values) & (joint_values <= self.upper))
        wrong = np.flatnonzero(outside).tolist()
        if not wrong:
            return
        names = [self.joint_names[k] for k in wrong]
        ranges = [f"{self.lower[k]:g} to {self.upper[k]:g}" for k in wrong]
        values = [float(joint_values[k]) for k in wrong]
        turned = np.max(np.abs(joint_values[outside & ~self.prismatic]), initial=0.0)
        unit = " rad (angles are in radians, not in degrees)" if turned > 2.0 * np.pi else ""
        if len(wrong) == 1:
            raise InvalidInput(f"{what} (joint {names[0]})", values[0], ranges[0] + unit)
        limits = ", ".join(f"{name} {each}" for name, each in zip(names, ranges, strict=True))
        raise InvalidInput(f"{what} (joints {', '.join(names)})", values, limits + unit)

    def save(self, path: str | Path) -> None:
        """Write the URDF, and the SRDF if there is one to a `.srdf` file beside it.

        Files of the same names are replaced. Meshes that the URDF names are not copied.

        Args:
            path: path that ends in `.urdf`.

        Raises:
            InvalidInput: not a `.urdf` path, or one that cannot be written.
        """
        target = checked_path("path", path, ".urdf")
        files: dict[Path, str | bytes] = {target: self.urdf}
        if self.srdf:
            files[target.with_suffix(".srdf")] = self.srdf
        write_files("path", files)

    def link_of(self, geometry: pin.GeometryObject) -> str:
        """Name of the URDF link that a collision or visual shape belongs to."""
        return str(self.model.frames[geometry.parentFrame].name)
