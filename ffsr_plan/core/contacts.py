"""Contacts of links with obstacles and with one another, and how messages name them."""

from __future__ import annotations

from typing import NamedTuple

from ffsr_plan.core.formatting import counted

TOUCHING = 1e-9
"""Depth [m] below which two bodies touch: it is the rounding of a distance of zero."""
_MOST_NAMED = 12  # obstacles or contacts in one message


class ShapeName(str):
    """The name of an obstacle that is no sphere, complete by itself: box 'panel'."""

    __slots__ = ()


class RoundName(ShapeName):
    """The name of an obstacle of which it is known that something is inside, but not how deep."""

    __slots__ = ()


class MemberName(ShapeName):
    """The name of a sphere of a debris cloud: sphere 3 of debris cloud 'shell'."""

    __slots__ = ()

    @property
    def number(self) -> int:
        """Its number within the cloud."""
        return int(self.split()[1])

    @property
    def cloud(self) -> CloudName:
        """The name of the cloud."""
        return CloudName(self.partition(" of ")[2])


class ZoneName(ShapeName):
    """The name of a zone that the robot has to stay in, and whose outside is an obstacle."""

    __slots__ = ()


class CloudName(str):
    """The name of a cloud of spheres, which are counted within it and not within the scene."""

    __slots__ = ()


class Contact(NamedTuple):
    """Two bodies that touch, or come too close.

    Attributes:
        link: name of the link.
        obstacle: number of the obstacle in the scene, or name of the other link; None in an empty
            scene.
        depth: penetration depth [m], zero in contact, negative apart; zero too inside a cylinder
            or ellipsoid, where it is not known.
        source: what a sphere comes from, such as the name of a mesh, empty where that is unknown;
            a `ShapeName` of other obstacles.
    """

    link: str
    obstacle: int | str | None
    depth: float
    source: str = ""

    @property
    def is_of_unknown_depth(self) -> bool:
        """Whether the link is inside an obstacle and nothing is known of how deep."""
        return isinstance(self.source, RoundName) and self.depth >= 0.0


def approach(distance: float) -> str:
    """How near something comes to what the text goes on to name.

    Args:
        distance: [m], negative in penetration.
    """
    if distance > TOUCHING:
        return f"comes within {distance:.4g} m of"
    return "touches" if distance > -TOUCHING else f"is {-distance:.4g} m inside"


def encounter(distance: float, obstacle: int | str | None, source: str = "") -> str:
    """How near something comes to an obstacle.

    Args:
        distance: [m], negative in penetration.
        obstacle: see `obstacle_name`.
        source: see `obstacle_name`.
    """
    if isinstance(source, ZoneName) and distance <= -TOUCHING:
        return f"is {-distance:.4g} m outside of {source}"
    if isinstance(source, RoundName) and distance <= 0.0:
        return f"is inside {source}"
    return f"{approach(distance)} {obstacle_name(obstacle, source)}"


def obstacle_name(obstacle: int | str | None, source: str = "") -> str:
    """An obstacle as messages name it.

    Args:
        obstacle: number of an obstacle, name of a link, or None.
        source: of the obstacle, as in `Contact`.
    """
    if isinstance(obstacle, str):
        return f"link '{obstacle}'"
    if isinstance(source, ShapeName):
        return f"the boundary of {source}" if isinstance(source, ZoneName) else str(source)
    if obstacle is None:
        return "no obstacle"
    return f"{source} (sphere {obstacle})" if source else f"obstacle {obstacle}"


def contact_list(contacts: tuple[Contact, ...]) -> str:
    """The deepest contact of each link with each link, mesh or single sphere.

    Args:
        contacts: the deepest first.
    """
    groups: dict[tuple[str, str], list[Contact]] = {}
    for contact in contacts:
        name = contact.source or obstacle_name(contact.obstacle)
        groups.setdefault((contact.link, name), []).append(contact)
    texts = []
    for (link, _), group in groups.items():
        more = f" and {counted(len(group) - 1, 'sphere')} more of it" if len(group) > 1 else ""
        first = group[0]
        texts.append(f"link '{link}' {encounter(-first.depth, first.obstacle, first.source)}{more}")
    if len(texts) > _MOST_NAMED:
        texts[_MOST_NAMED:] = [f"{len(texts) - _MOST_NAMED} more"]
    return "; ".join(texts)


def closing_obstacles(contacts: tuple[Contact, ...], spheres: list[int]) -> str:
    """Obstacles by what they come from, and the links that meet them.

    Args:
        contacts: give the sources and the links.
        spheres: numbers of obstacles in the scene; the text is empty if there are none.
    """
    by_source: dict[str, list[int]] = {}
    sources = {contact.obstacle: contact.source for contact in contacts}
    for sphere in spheres:
        source = sources.get(sphere, "")
        if isinstance(source, MemberName):
            by_source.setdefault(source.cloud, []).append(source.number)
        else:
            by_source.setdefault(source, []).append(sphere)
    parts = [_of_source(source, members) for source, members in by_source.items()]
    links = sorted({f"'{c.link}'" for c in contacts if isinstance(c.obstacle, int)})
    verb = "link {} meets" if len(links) == 1 else "links {} meet"
    meet = f", which {verb.format(', '.join(links))}" if links else ""
    return " and ".join(parts) + (meet if parts else "")


def _of_source(source: str, members: list[int]) -> str:
    """Obstacles that come from the same, by their numbers."""
    if isinstance(source, ShapeName):
        return str(source)
    word = "sphere" if source else "obstacle"
    listed = ", ".join(map(str, members[:_MOST_NAMED]))
    more = len(members) - _MOST_NAMED
    text = f"{word}{'s' if len(members) > 1 else ''} {listed}"
    text += f" and {more} more" if more > 0 else ""
    if isinstance(source, CloudName):
        return f"{text} of {source}"
    return f"{source} ({text})" if source else text
