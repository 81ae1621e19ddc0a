"""All links that touch one another at a configuration, and an SRDF that exempts them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple, overload
from xml.etree import ElementTree

from numpy.typing import ArrayLike

from ffsr_plan.collision.distances import SelfQuery
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.contacts import TOUCHING
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import counted
from ffsr_plan.core.text_files import write_text
from ffsr_plan.robots.robot import SpaceRobot


class SelfCollision(NamedTuple):
    """Two links that touch.

    Attributes:
        first: name of a link.
        second: name of the other link.
        depth: penetration depth [m], zero in contact; the greatest of all shapes of the two links.
    """

    first: str
    second: str
    depth: float


class SelfCollisions(Sequence[SelfCollision]):
    """Pairs of links that touch, the deepest first.

    Attributes:
        pairs: the pairs.
        srdf: text of an SRDF with all that the robot's own SRDF contains, and with a
            `<disable_collisions>` for each pair. A robot that is loaded with it does not check
            these pairs any more, at any configuration: exempt those that may touch by design.
    """

    def __init__(self, robot: SpaceRobot, pairs: Iterable[SelfCollision]) -> None:
        """Keep the pairs and make the SRDF.

        Args:
            robot: the robot.
            pairs: its pairs.
        """
        self.pairs = tuple(pairs)
        self.srdf = _exempting(robot, [(pair.first, pair.second) for pair in self.pairs])

    def write_srdf(self, path: str | Path) -> None:
        """Write `srdf` to a file, for `load_robot(..., srdf=path)`.

        Args:
            path: path that ends in `.srdf`, replaced if it exists.

        Raises:
            InvalidInput: not a `.srdf` path, or one that cannot be written.
        """
        write_text("path", checked_path("path", path, ".srdf"), self.srdf)

    @overload
    def __getitem__(self, index: int) -> SelfCollision: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[SelfCollision]: ...
    def __getitem__(self, index: int | slice) -> SelfCollision | Sequence[SelfCollision]:
        return self.pairs[index]

    def __len__(self) -> int:
        return len(self.pairs)

    def __repr__(self) -> str:
        listed = "; ".join(
            f"{a} and {b} " + (f"by {depth:.4g} m" if depth > TOUCHING else "touch")
            for a, b, depth in self.pairs[:5]
        )
        more = f"; and {len(self) - 5} more" if len(self) > 5 else ""
        return f"SelfCollisions({counted(len(self), 'pair')}{': ' if listed else ''}{listed}{more})"


def self_collisions(robot: SpaceRobot, q: ArrayLike) -> SelfCollisions:
    """All pairs of links that touch one another at a configuration.

    Pairs that are not checked for self-collision are not listed: adjacent links, and pairs that the
    robot's SRDF exempts.

    Args:
        robot: the robot.
        q: (nq,) configuration.

    Returns:
        The pairs, the deepest first; `write_srdf` writes an SRDF that exempts them.

    Raises:
        InvalidInput: not a robot, or not a configuration of that robot.
    """
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    query = SelfQuery(robot)
    configuration = robot.check_configuration("q", q)
    if query.empty:
        return SelfCollisions(robot, ())
    shapes = robot.collision_model.geometryObjects
    deepest: dict[tuple[str, str], float] = {}
    for (a, b), distance in zip(
        query.pairs.tolist(), query.distances(configuration).tolist(), strict=True
    ):
        if distance <= 0.0:
            pair = robot.link_of(shapes[a]), robot.link_of(shapes[b])
            deepest[pair] = max(deepest.get(pair, 0.0), -distance)
    listed = [SelfCollision(*pair, depth) for pair, depth in deepest.items()]
    return SelfCollisions(robot, sorted(listed, key=lambda each: (-each.depth, each[:2])))


def _exempting(robot: SpaceRobot, pairs: Sequence[tuple[str, str]]) -> str:
    """The robot's SRDF with further exempt pairs."""
    root = (
        ElementTree.fromstring(robot.srdf)
        if robot.srdf
        else ElementTree.Element("robot", name=robot.name)
    )
    for first, second in pairs:
        ElementTree.SubElement(root, "disable_collisions", link1=first, link2=second, reason="User")
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"
