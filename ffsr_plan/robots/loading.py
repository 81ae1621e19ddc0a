"""Robots loaded from URDF and SRDF, by bundled name, file or text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

import pinocchio as pin

from ffsr_plan.core import bundled_files
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import one_of
from ffsr_plan.core.errors import InvalidInput, unknown_name
from ffsr_plan.core.text_files import read_text
from ffsr_plan.robots.adjacent_links import may_touch
from ffsr_plan.robots.collision_shapes import CONTAINERS, Containers, collision_geometry
from ffsr_plan.robots.locked_joints import fix_locked_joints
from ffsr_plan.robots.pinocchio_models import build_model, check_loaded, visual_model
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.srdf import disabled_pairs
from ffsr_plan.robots.urdf_validation import check_urdf, parse


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
        locked: joints that are fixed, at a value [rad, or m where prismatic]; they are no joints of
            the robot. Of joints that mimic one another, such as two fingers, name one: the others
            are fixed with it.

    Returns:
        The robot.

    Raises:
        InvalidInput: no such robot or file, or a URDF, SRDF or mesh that cannot be used; names the
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
    folders = [*_folders(package_dirs), str(path.parent)]
    srdf_text = "" if srdf is None else read_text("srdf", Path(srdf))
    if srdf is not None and not srdf_text.strip():
        raise InvalidInput("srdf", str(srdf), "a file that is not empty")
    containers = Containers(meshes, cylinders)
    text = read_text("robot", path)
    root = parse(text, path.stem)
    if fix_locked_joints(root, locked, path.stem):
        text = ElementTree.tostring(root, encoding="unicode") + "\n"
    return robot_from_urdf(text, path.stem, folders, srdf=srdf_text, containers=containers)


def _folders(package_dirs: object) -> list[str]:
    """Folders of `load_robot`, as texts."""
    listed = package_dirs if isinstance(package_dirs, Sequence) else None
    if listed is None or isinstance(listed, str):
        raise InvalidInput("package_dirs", package_dirs, "a list of folders")
    for each in listed:
        if not isinstance(each, (str, Path)):
            raise InvalidInput("package_dirs", each, "a path")
    return [str(Path(each)) for each in listed]


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

    Args:
        text: the URDF.
        name: name of the robot, which also starts every error message.
        package_dirs: folders in which mesh addresses are looked up.
        srdf: the SRDF; empty for none.
        containers: which kinds of solids replace meshes and cylinders; hulls by default.
        meshes: (n, 3) hull corners by address (see `SpaceRobot.meshes`), which need no file.

    Returns:
        The robot.

    Raises:
        InvalidInput: a URDF, SRDF or mesh that cannot be used.
    """
    counts = check_urdf(text, name)
    containers = Containers() if containers is None else containers
    for what, kind in containers._asdict().items():
        one_of(what, kind, CONTAINERS)
    folders = list(package_dirs)
    corners = dict(meshes or {})
    root = parse(text, name)
    model = build_model(text, name)
    collision, replacements = collision_geometry(model, root, name, folders, containers, corners)
    check_loaded(name, model, collision, counts)
    links = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
    disabled = disabled_pairs(srdf, f"{name}, SRDF", links)
    _add_self_collision_pairs(model, collision, root, disabled)
    return SpaceRobot(
        name,
        text,
        model,
        collision,
        visual_model(model, text, folders),
        package_dirs=tuple(folders),
        replacements=replacements,
        containers=containers,
        meshes=corners,
        srdf=srdf,
        disabled_pairs=disabled,
    )


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
