"""Robots loaded from URDF and SRDF, by bundled name, file or text."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

import pinocchio as pin

from ffsr_plan.core import bundled_files
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import one_of, unknown_name
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput, UncheckedLinks
from ffsr_plan.core.text_files import read_text
from ffsr_plan.robots.collision_shapes import CONTAINERS, Containers, collision_geometry
from ffsr_plan.robots.loaded_model_checks import compare
from ffsr_plan.robots.locked_joints import fix_locked_joints
from ffsr_plan.robots.pinocchio_models import build_model, visual_model
from ffsr_plan.robots.plausibility import check_bodies
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.srdf import disabled_pairs
from ffsr_plan.robots.urdf.adjacent_links import may_touch
from ffsr_plan.robots.urdf.canonical import read_urdf, urdf_text
from ffsr_plan.robots.urdf.inertias import balanced_links
from ffsr_plan.robots.urdf.joints import check_ranges, rate_limits
from ffsr_plan.robots.urdf.links import shapeless_links, unchecked_links


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
    collision: str = "collision",
    inertia: str = "exact",
    locked: Mapping[str, float] | None = None,
) -> SpaceRobot:
    """Load a robot whose root link floats freely.

    Boxes, spheres and capsules are taken as they are. A cylinder or a mesh is replaced by a solid
    that contains it, which `SpaceRobot.replacements` lists.

    Args:
        source: name of a bundled robot (see `robot_names`), or path to a `.urdf` file.
        package_dirs: folders in which `package://` and relative mesh addresses are looked up,
            before the folder of the `.urdf` file. A package is also looked for upwards from that
            folder, and in `ROS_PACKAGE_PATH` and `AMENT_PREFIX_PATH`.
        srdf: path to an SRDF whose `<disable_collisions>` exempt pairs of links from the check for
            self-collision (adjacent links are exempt in any case) and whose `<group_state>`s are
            the robot's named postures. A bundled robot comes with its own. The values of virtual
            joints, and of joints that do not move, are ignored.
        meshes: what replaces a mesh: `hull`, its convex hull, or `capsule`, a capsule around it.
        cylinders: what replaces a cylinder: `hull`, a prism of 24 sides around it (larger by at
            most 0.9 % of the radius), or `capsule`, the capsule around it with the least excess
            (41 % of the radius, more for short cylinders).
        collision: what becomes of a link with `<visual>` shapes and no `<collision>`: `collision`
            refuses it, `visual` takes the visual shapes, `ignore` leaves the link without a shape,
            so that nothing checks it (see `SpaceRobot.unchecked_links`).
        inertia: what becomes of an inertia tensor that no body has: `exact` refuses it, `balance`
            takes the nearest one that a body has (see `SpaceRobot.balanced`). Tensors that are
            rounded to a few digits are taken as they are in any case.
        locked: joints that are fixed, at a value [rad, or m where prismatic]; they are no joints of
            the robot. Of joints that mimic one another, such as two fingers, name one: the others
            are fixed with it.

    Returns:
        The robot.

    Raises:
        InvalidInput: no such robot, or a file that cannot be used; names the link or joint.

    Warns:
        UncheckedLinks: links with a mass and no shape at all.
    """
    path, srdf = _files(source, srdf)
    folders = [*_folders(package_dirs), str(path.parent)]
    robot = robot_from_urdf(
        read_text("robot", path, "utf-8-sig"), path.stem, folders,
        srdf=_srdf_text(srdf),
        containers=Containers(meshes, cylinders),
        collision=collision,
        inertia=inertia,
        locked=locked,
    )  # fmt: skip
    warn_of_shapeless_links(robot)
    return robot


def _files(source: str | Path, srdf: str | Path | None) -> tuple[Path, str | Path | None]:
    """Paths of the URDF and of the SRDF, which a bundled robot has itself; see `load_robot`."""
    given = checked_path("robot", source)
    path = bundled_files.find("urdf", str(source), ".urdf")
    if path is not None and srdf is None:
        srdf = bundled_files.find("urdf", str(source), ".srdf")
    if path is None:
        path = given
        if path.suffix != ".urdf":
            raise unknown_name("robot", str(source), [*robot_names(), "or a path to a .urdf file"])
        if not path.is_file():
            raise InvalidInput("robot", str(source), "a bundled robot or an existing .urdf file")
    return path, srdf


def _srdf_text(srdf: str | Path | None) -> str:
    """Text of the SRDF; empty without one."""
    text = "" if srdf is None else read_text("srdf", checked_path("srdf", srdf), "utf-8-sig")
    if srdf is not None and not text.strip():
        raise InvalidInput("srdf", str(srdf), "a file that is not empty")
    return text


def _folders(package_dirs: object) -> list[str]:
    """Folders of `load_robot`, as texts."""
    if isinstance(package_dirs, (str, Path)) or not isinstance(package_dirs, Sequence):
        raise InvalidInput("package_dirs", package_dirs, "a list of paths")
    return [str(checked_path("package_dirs", each)) for each in package_dirs]


def robot_from_urdf(
    text: str,
    name: str,
    package_dirs: Sequence[str] = (),
    *,
    srdf: str = "",
    containers: Containers | None = None,
    meshes: Mapping[str, Array] | None = None,
    collision: str = "collision",
    inertia: str = "exact",
    locked: Mapping[str, float] | None = None,
) -> SpaceRobot:
    """Make a robot from URDF and SRDF texts; see `load_robot`.

    Args:
        text: the URDF.
        name: name of the robot, which also starts every error message.
        package_dirs: folders in which mesh addresses are looked up.
        srdf: the SRDF; empty for none.
        containers: which kinds of solids replace meshes and cylinders; hulls by default.
        meshes: (n, 3) hull corners by address (see `SpaceRobot.meshes`), which need no file.
        collision: see `load_robot`.
        inertia: see `load_robot`.
        locked: see `load_robot`.

    Returns:
        The robot.

    Raises:
        InvalidInput: a URDF, SRDF or mesh that cannot be used.
    """
    containers = Containers() if containers is None else containers
    for what, kind in containers._asdict().items():
        one_of(what, kind, CONTAINERS)
    folders, corners = list(package_dirs), dict(meshes or {})
    root = read_urdf(text, name, collision=collision, inertia=inertia)
    fix_locked_joints(root, locked, name)
    check_ranges(root, name)
    model = build_model(root, name)
    shapes, replacements = collision_geometry(model, root, name, folders, containers, corners)
    check_bodies(root, name, model, shapes)
    compare(root, model, shapes, replacements)
    disabled = disabled_pairs(srdf, f"{name}, SRDF", link_names(root))
    _add_self_collision_pairs(model, shapes, root, disabled)
    return SpaceRobot(
        name,
        urdf_text(root),
        model,
        shapes,
        visual_model(model, root, folders),
        package_dirs=tuple(folders),
        replacements=replacements,
        containers=containers,
        meshes=corners,
        srdf=srdf,
        disabled_pairs=disabled,
        unchecked_links=unchecked_links(root),
        balanced=balanced_links(root),
        rate_limits=rate_limits(root),
    )


def warn_of_shapeless_links(robot: SpaceRobot) -> None:
    """Warn of all links that have a mass and no shape at all.

    Args:
        robot: any robot.
    """
    names = shapeless_links(ElementTree.fromstring(robot.urdf))
    if names:
        listed = ", ".join(f"'{name}'" for name in names)
        message = (
            f"{robot.name}: no shape, so nothing checks that obstacles stay clear of "
            f"{'links' if len(names) > 1 else 'link'} {listed}"
        )
        warnings.warn(message, UncheckedLinks, stacklevel=3)


def link_names(robot: ElementTree.Element) -> list[str]:
    """Names of the links of a `<robot>` element."""
    return [str(link.get("name")) for link in robot.findall("link")]


def _add_self_collision_pairs(
    model: pin.Model,
    collision: pin.GeometryModel,
    root: ElementTree.Element,
    disabled: Sequence[tuple[str, str]],
) -> None:
    """Add all pairs of shapes except those of adjacent links and those that the SRDF exempts."""
    adjacent = may_touch(root)
    links = [str(model.frames[shape.parentFrame].name) for shape in collision.geometryObjects]
    for a, first in enumerate(links):
        for b, second in enumerate(links[:a]):
            pair = (min(first, second), max(first, second))
            if pair not in disabled and not adjacent(first, second):
                collision.addCollisionPair(pin.CollisionPair(b, a))
