"""Arms to mount on a bus: their URDFs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from ffsr_plan.core.checks import unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text
from ffsr_plan.robots.locked_joints import fix_locked_joints
from ffsr_plan.robots.srdf import disabled_pairs
from ffsr_plan.robots.urdf.canonical import read_urdf
from ffsr_plan.robots.urdf.joints import check_ranges

_UR = "ur_description/srdf/ur5.srdf"
ARMS = {
    "kinova": ("kinova_description/robots/kinova.urdf", ""),
    "panda": ("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf"),
    "so100": ("so_arm_description/urdf/so100.urdf", ""),
    "so101": ("so_arm_description/urdf/so101.urdf", ""),
    "ur10": ("ur_description/urdf/ur10_robot.urdf", _UR),  # same links as the UR5
    "ur3": ("ur_description/urdf/ur3_robot.urdf", _UR),
    "ur5": ("ur_description/urdf/ur5_robot.urdf", _UR),
    "xarm7": ("xarm_description/urdf/xarm7.urdf", "xarm_description/srdf/xarm7.srdf"),
    "z1": ("z1_description/urdf/z1.urdf", ""),
}
"""Arms of example-robot-data by name: URDF and SRDF below its `robots` folder."""


class Arm(NamedTuple):
    """An arm's URDF, checked, its locked joints fixed.

    Attributes:
        robot: the `<robot>` element.
        root: name of the link that is mounted on the bus.
        folders: folders in which its meshes are looked up.
        where: name of the arm in messages.
        may_touch: pairs of links that its SRDF exempts from self-collision.
    """

    robot: ElementTree.Element
    root: str
    folders: tuple[str, ...]
    where: str
    may_touch: tuple[tuple[str, str], ...]


def arm_names() -> list[str]:
    """Names of the arms that `compose` accepts, all from example-robot-data."""
    return sorted(ARMS)


def load_arm(
    source: str | Path,
    locked: Mapping[str, float],
    srdf: str | Path | None = None,
    package_dirs: Sequence[str | Path] = (),
    *,
    collision: str | None = None,
    inertia: str = "exact",
) -> Arm:
    """Read an arm by name or from a `.urdf` file.

    Args:
        source: one of `arm_names()`, or a path.
        locked: joints to fix, by the arm's own names, at a value [rad, or m where prismatic].
            Of joints that mimic one another, one is named and the others follow.
        srdf: path to an SRDF; an arm given by its name has its own, if there is one.
        collision: see `load_robot`; by default `visual` for an arm given by its name, since some
            of these have links with visual shapes only, and `collision` for a file.
        inertia: see `load_robot`.
        package_dirs: folders in which its meshes are looked up first.

    Returns:
        The arm.

    Raises:
        InvalidInput: no such arm or file, a URDF or SRDF that cannot be used, an unknown joint, a
            value outside the joint's limits, or a joint that mimics one that is not locked.
    """
    path, own, folders = find_arm(source)
    text = read_text("arm", path, "utf-8-sig")
    where = f"arm {source}"
    if collision is None:
        collision = "collision" if path == Path(source) else "visual"
    robot = read_urdf(text, where, collision=collision, inertia=inertia)
    fix_locked_joints(robot, locked, where)
    check_ranges(robot, where)
    children = {str(child.get("link")) for child in robot.iterfind("joint/child")}
    names = [str(link.get("name")) for link in robot.findall("link")]
    root = next(name for name in names if name not in children)
    srdf_path = own if srdf is None else Path(srdf)
    srdf_text = "" if srdf_path is None else read_text("srdf", srdf_path, "utf-8-sig")
    pairs = disabled_pairs(srdf_text, f"{where}, SRDF", names)
    return Arm(robot, root, (*map(str, package_dirs), *folders), where, pairs)


def find_arm(source: str | Path) -> tuple[Path, Path | None, tuple[str, ...]]:
    """Files of an arm.

    Args:
        source: name of an arm of example-robot-data, or path to a `.urdf` file.

    Returns:
        Paths of the URDF and, if there is one, of the SRDF, and the folders of the meshes.

    Raises:
        InvalidInput: no such arm or file.
    """
    path = Path(source)
    if path.suffix == ".urdf":
        if not path.is_file():
            raise InvalidInput("arm", str(source), "an existing .urdf file, or the name of an arm")
        return path, None, (str(path.parent.absolute()),)
    if source not in ARMS:
        raise unknown_name("arm", str(source), [*arm_names(), "or a path to a .urdf file"])
    try:
        data = distribution("example-robot-data").locate_file("cmeel.prefix/share")
    except PackageNotFoundError:
        allowed = "arms of example-robot-data, which is not installed here"
        raise InvalidInput("arm", str(source), allowed) from None
    share = Path(str(data))
    urdf, srdf = (share / "example-robot-data" / "robots" / name for name in ARMS[str(source)])
    return urdf, srdf if srdf.is_file() else None, (str(share),)
