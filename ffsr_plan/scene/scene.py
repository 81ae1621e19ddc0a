"""Obstacles: spheres, shapes of other kinds, the outside of zones, and bodies that move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.bodies.debris.debris_cloud import DebrisCloud
from ffsr_plan.bodies.debris.scene_debris import spheres_at
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.core.arrays import Array, content
from ffsr_plan.core.checks import number, text
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import html_table
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene import sphere_files
from ffsr_plan.scene.covered_mesh import covered
from ffsr_plan.scene.scene_contents import (
    checked_members,
    checked_sources,
    cloud_title,
    common_growth,
    contents,
    extent_in_words,
    member_title,
    refuse_members,
    row_count,
    source_title,
    with_spheres,
)
from ffsr_plan.scene.shapes.extents import bounds_of
from ffsr_plan.scene.shapes.keep_in_zones import ZONES, Zone
from ffsr_plan.scene.shapes.obstacle_shapes import SHAPES, ObstacleShape
from ffsr_plan.scene.shapes.obstacle_tree import ObstacleTree, obstacle_tree
from ffsr_plan.scene.urdf_shapes import robot_of, shapes_of


@dataclass(frozen=True, eq=False, init=False)
class Scene:
    """Obstacles. `scene + other` holds the obstacles of both, those of `scene` first.

    Obstacles are numbered: the spheres, then the shapes, the zones, the moving bodies and the
    spheres of debris. Two scenes are equal if they hold the same obstacles in the same order.

    Attributes:
        centers: (N, 3) centres in the world [m].
        radii: (N,) radii [m], greater than zero.
        excess: greatest distance by which the spheres protrude from the bodies that they cover [m];
            zero if the spheres are the obstacles themselves.
        sources: what the spheres come from, in their order: pairs of a name, such as that of a
            mesh file, and a number of spheres. Errors name obstacles by them. Empty if unknown.
        shapes: obstacles of other shapes.
        keep_in: convex zones, each of which the whole robot stays in.
        growth: distance by which all but the spheres are grown, and zones shrunk [m].
        bodies: obstacles that move. Bodies do not see one another, nor what is at rest.
        debris: clouds of spheres that drift.
    """

    centers: Array
    radii: Array
    excess: float = 0.0
    sources: tuple[tuple[str, int], ...] = ()
    shapes: tuple[ObstacleShape, ...] = ()
    keep_in: tuple[Zone, ...] = ()
    growth: float = 0.0
    bodies: tuple[MovingBody, ...] = ()
    debris: tuple[DebrisCloud, ...] = ()

    def __init__(
        self,
        centers: ArrayLike = (),
        radii: ArrayLike = (),
        excess: float = 0.0,
        sources: Sequence[tuple[str, int]] = (),
        shapes: Sequence[ObstacleShape] = (),
        keep_in: Sequence[Zone] = (),
        growth: float = 0.0,
        bodies: Sequence[MovingBody] = (),
        debris: Sequence[DebrisCloud] = (),
    ) -> None:
        """Check the obstacles and make them read-only.

        Args:
            centers: (N, 3) centres in the world [m].
            radii: (N,) radii [m].
            excess: see the class.
            sources: see the class; the numbers sum to N.
            shapes: `Box`, `Ball`, `Capsule`, `Cylinder`, `Ellipsoid` or `Hull`.
            keep_in: `Box`, `Ball` or `HalfSpace`.
            growth: see the class.
            bodies: obstacles that move.
            debris: clouds of spheres that drift.

        Raises:
            InvalidInput: arrays that do not fit; a number not finite or a radius <= 0, with the
                index of the sphere; or something that is no shape, zone, body or cloud.
        """
        count, each = row_count(radii), sphere_files.BYTES_PER_SPHERE
        check_memory("scene", {"spheres": count}, each, "fewer spheres")
        c, r = sphere_files.checked_spheres("scene ", centers, radii, "sphere")
        for field, array in (("centers", c), ("radii", r)):
            object.__setattr__(self, field, array)
        object.__setattr__(self, "excess", number("scene excess", excess, at_least=0.0))
        object.__setattr__(self, "sources", checked_sources(sources, len(r)))
        object.__setattr__(self, "shapes", checked_members("shapes", shapes, (*SHAPES.values(),)))
        object.__setattr__(self, "keep_in", checked_members("keep_in", keep_in, ZONES))
        object.__setattr__(self, "growth", number("scene growth", growth, at_least=0.0))
        object.__setattr__(self, "bodies", checked_members("bodies", bodies, (MovingBody,)))
        object.__setattr__(self, "debris", checked_members("debris", debris, (DebrisCloud,)))

    def grown(self, by: float) -> Scene:
        """The same obstacles, grown on all sides; the names of the spheres' sources say so.

        Args:
            by: what is added to all radii [m]; with 0 it is the same scene.
        """
        if by == 0.0:
            return self
        names = self.sources or (("the scene", len(self.radii)),) * (len(self.radii) > 0)
        sources = [(f"{name}, grown by {by:g} m", count) for name, count in names]
        growth = self.growth + by if self._has_growth else 0.0
        return replace(self, radii=self.radii + by, sources=sources, growth=growth)  # type: ignore[arg-type]

    @classmethod
    def from_csv(cls, path: str | Path) -> Scene:
        """Read spheres from a comma-separated table with the columns x, y, z and radius.

        Args:
            path: the file. A header such as `x [mm]` gives a unit (m, cm, mm, km); the default is
                the metre.

        Raises:
            InvalidInput: names file, line, column and value.
        """
        return cls(*sphere_files.read_csv(path)).named(Path(path).name)

    @classmethod
    def from_numpy(cls, path: str | Path) -> Scene:
        """Read spheres from a NumPy file [m].

        Args:
            path: a `.npy` file with an array (N, 4) of x, y, z, radius, or a `.npz` file with the
                arrays `centers` (N, 3) and `radii` (N,).

        Raises:
            InvalidInput: names the file, its content and what is allowed.
        """
        return cls(*sphere_files.read_numpy(path)).named(Path(path).name)

    @classmethod
    def from_mesh(
        cls,
        mesh: str | Path | Any,  # noqa: ANN401 - any object with `triangles`
        excess: float,
        *,
        scale: float = 1.0,
        position: ArrayLike = (0.0, 0.0, 0.0),
        attitude: ArrayLike = (0.0, 0.0, 0.0),
        inside: bool = True,
    ) -> Scene:
        """Spheres that cover the surface of a closed mesh and the volume that it encloses.

        A cavity inside the mesh, bounded by its own closed surface, stays free. `sphere_cover`
        contains the proof. Half the excess needs about four times the spheres.

        Args:
            mesh: path of a .stl, .obj, .dae or .ply file, or an object with `triangles`
                (k, 3, 3), such as a `trimesh.Trimesh`.
            excess: greatest distance by which the spheres may protrude from the enclosed volume,
                world [m], > 0.
            scale: metres per unit of length of the mesh, > 0; the unit that a .dae file names is
                applied before it.
            position: (3,) origin of the mesh in the world [m].
            attitude: (3,) ZYX angles of the mesh's axes [rad].
            inside: whether to cover the enclosed volume too. An open mesh needs False; with False,
                a robot inside a closed mesh counts as free.

        Returns:
            The scene; its `excess` is the argument.

        Raises:
            InvalidInput: a mesh that cannot be read, is not closed, or is too large for the excess.
        """
        spheres, name = covered(mesh, excess, scale, position, attitude, inside)
        return cls(spheres.centers, spheres.radii, float(excess)).named(name)

    @classmethod
    def from_urdf(
        cls,
        source: str | Path | SpaceRobot,
        position: ArrayLike = (0.0, 0.0, 0.0),
        attitude: ArrayLike = (0.0, 0.0, 0.0),
        joints: str | Mapping[str, float] | None = None,
        *,
        name: str = "",
        **options: Any,  # noqa: ANN401 - those of `load_robot`
    ) -> Scene:
        """All collision shapes of a URDF, at rest: another robot, or a satellite to be visited.

        Boxes, spheres, capsules and cylinders are taken as they are, meshes as convex hulls.

        Args:
            source: name of a bundled robot, path of a URDF, or a robot.
            position: (3,) of its root link in the world [m].
            attitude: (3,) ZYX angles of its root link [rad].
            joints: joint values by name [rad or m], or the name of a posture; the others are zero.
            name: that errors name its links with; the robot's name without one.
            options: of `load_robot`, such as `package_dirs`.

        Raises:
            InvalidInput: what `robot_of` or `SpaceRobot.configuration` refuse.
        """
        robot = robot_of(source, options)
        q = robot.configuration(position, attitude, joints)
        return cls(shapes=[*shapes_of(robot, q, text("name", name) or robot.name)])

    def named(self, source: str) -> Scene:
        """The same spheres, by which errors name this source.

        Args:
            source: such as the name of a part.
        """
        sources = [(source, len(self.radii))] if len(self.radii) else []
        return replace(self, sources=sources)  # type: ignore[arg-type]

    def source_of(self, obstacle: int) -> str:
        """What a sphere comes from, or the name of a shape or zone; empty if that is unknown.

        Args:
            obstacle: its number.
        """
        first = len(self) - sum(map(len, self.debris))
        if obstacle >= first:
            return source_title(self._clouds, obstacle - first)
        if obstacle >= len(self.radii):
            return member_title(self._members, obstacle - len(self.radii))
        return source_title(self.sources, obstacle)

    def to_csv(self, path: str | Path) -> None:
        """Write a table that `from_csv` reads again bit for bit; `excess` is not written.

        Args:
            path: the file, replaced if it exists.

        Raises:
            InvalidInput: a path that cannot be written, or obstacles that are no spheres.
        """
        refuse_members("to_csv", self._all_members)
        sphere_files.write_csv(path, self.centers, self.radii)

    @cached_property
    def tree(self) -> ObstacleTree:
        """The obstacles as a tree, built at the first use.

        Raises:
            InvalidInput: bodies move, so that there is no such tree; `at(time)` has one.
        """
        if self.moves:
            allowed = "nothing that moves, where nothing tells the time"
            raise InvalidInput("scene bodies", list(self.moving), allowed)
        return obstacle_tree(self.centers, self.radii, self.shapes, self.keep_in, self.growth)

    @cached_property
    def at_rest(self) -> Scene:
        """The obstacles that do not move."""
        return replace(self, bodies=(), debris=()) if self.moves else self

    @property
    def moves(self) -> bool:
        """Whether there are obstacles that move."""
        return bool(self.moving)

    @property
    def moving(self) -> tuple[MovingBody | DebrisCloud, ...]:
        """The obstacles that move."""
        return self.bodies + self.debris

    @property
    def known_until(self) -> float:
        """Time up to which the motions of all bodies are known [s]."""
        return min((body.motion.known_until for body in self.bodies), default=np.inf)

    @cached_property
    def body_scenes(self) -> tuple[Scene, ...]:
        """The shapes of each body along its own axes, at rest there, grown like all others."""
        return tuple(Scene(**with_spheres(each.shapes, self.growth)) for each in self.bodies)

    def at(self, time: float) -> Scene:
        """All obstacles where they are at one time, at rest there.

        Args:
            time: [s]; spheres of debris follow the spheres, shapes of bodies the shapes.
        """
        if not self.moves:
            return self
        each = (body.shapes_at(time, f"bodies.{k}") for k, body in enumerate(self.bodies))
        placed = [*self.shapes, *chain.from_iterable(each)]
        there = replace(self, shapes=placed, bodies=(), debris=())  # type: ignore[arg-type]
        if self.debris:
            there += Scene(*spheres_at(self.debris, self.growth, time), sources=self._clouds)
        return there

    def later(self, time: float) -> Scene:
        """The same scene from a later instant [s] on, which becomes time zero."""
        bodies = [body.later(time) for body in self.bodies]
        debris = [cloud.later(time) for cloud in self.debris]
        return replace(self, bodies=bodies, debris=debris)  # type: ignore[arg-type]

    @property
    def is_closed_form(self) -> bool:
        """Whether distances to all obstacles are short closed forms."""
        return all(shape.is_box for shape in self.shapes)

    @cached_property
    def closed_form_part(self) -> Scene:
        """The scene without obstacles to which distances are not short closed forms."""
        boxes = tuple(shape for shape in self.shapes if shape.is_box)
        return self if len(boxes) == len(self.shapes) else replace(self, shapes=boxes)

    def __add__(self, other: Scene) -> Scene:
        if not isinstance(other, Scene):
            return NotImplemented
        return Scene(
            np.vstack([self.centers, other.centers]),
            np.concatenate([self.radii, other.radii]),
            max(self.excess, other.excess),
            (*self._all_sources(), *other._all_sources()),
            self.shapes + other.shapes,
            self.keep_in + other.keep_in,
            common_growth([each.growth for each in (self, other) if each._has_growth]),
            self.bodies + other.bodies,
            self.debris + other.debris,
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self._content() == other._content()

    def __hash__(self) -> int:
        return hash(self._content())

    def _content(self) -> object:
        return content(tuple(getattr(self, each.name) for each in fields(self)))

    @property
    def _has_growth(self) -> bool:
        return any(self._all_members.values())

    @property
    def _clouds(self) -> tuple[tuple[str, int], ...]:
        return tuple((cloud_title(each, k), len(each)) for k, each in enumerate(self.debris))

    def _all_sources(self) -> tuple[tuple[str, int], ...]:
        return self.sources or (("", len(self.radii)),) * (len(self.radii) > 0)

    def __repr__(self) -> str:
        extent = extent_in_words(self.bounds())
        return f"Scene({self.contents}{extent and ', '}{extent})"

    def _repr_html_(self) -> str:
        rows = {"obstacles": self.contents} if self._has_growth else {}
        rows |= {
            "spheres": str(len(self.radii)),
            "extent": extent_in_words(self.bounds()) or "empty",
        }
        if self.excess:
            rows["excess"] = f"{self.excess:g} m"
        return html_table("Scene", rows)

    @property
    def contents(self) -> str:
        """How many obstacles of each kind there are."""
        return contents(len(self.radii), self._all_members)

    @property
    def _members(self) -> dict[str, tuple[Any, ...]]:
        """The obstacles that are no spheres, each of which has one number."""
        return {name: getattr(self, name) for name in ("shapes", "keep_in", "bodies")}

    @property
    def _all_members(self) -> dict[str, tuple[Any, ...]]:
        return {**self._members, "debris": self.debris}

    def bounds(self) -> Array:
        """(2, 3) least and greatest coordinates of what is at rest [m]; (0, 3) without any."""
        return bounds_of(self.centers, self.radii, self.shapes, self.growth)

    def __len__(self) -> int:
        """Number of obstacles: spheres, shapes, zones, bodies and spheres of debris."""
        members = sum(map(len, self._members.values()))
        return len(self.radii) + members + sum(map(len, self.debris))
