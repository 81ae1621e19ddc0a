"""Checks of what a scene is made of, and how messages name its members."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import whole_number
from ffsr_plan.core.contacts import CloudName, MemberName, RoundName, ShapeName, ZoneName
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import counted
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, ObstacleShape

_ROUND = ("cylinder", "ellipsoid")  # obstacles in which depths are not known


def checked_members(what: str, given: object, kinds: tuple[type, ...]) -> tuple[Any, ...]:
    """The objects of a sequence, after a check of their classes.

    Args:
        what: the field of the scene.
        given: the sequence.
        kinds: classes that are allowed.

    Raises:
        InvalidInput: no sequence, or an object of another class.
    """
    names = ", ".join(kind.__name__ for kind in kinds)
    if isinstance(given, (str, bytes)) or not isinstance(given, Sequence):
        raise InvalidInput(f"scene {what}", given, f"a list of {names}")
    for k, each in enumerate(given):
        if not isinstance(each, kinds):
            raise InvalidInput(f"scene {what}.{k}", each, f"an object of {names}")
    return tuple(given)


def refuse_members(what: str, members: Mapping[str, Sequence[Any]]) -> None:
    """Refuse obstacles that are no spheres, where only spheres can be kept.

    Args:
        what: what is asked for.
        members: the objects of each field of the scene.

    Raises:
        InvalidInput: there are such obstacles.
    """
    if any(members.values()):
        allowed = "a scene of spheres alone: a table of spheres has no place for others"
        raise InvalidInput(what, contents(0, members), allowed)


def member_title(members: Mapping[str, Sequence[Any]], place: int) -> str:
    """A shape, zone or body as messages name it; empty where there is none.

    Args:
        members: the objects of each field of the scene.
        place: place of one among all of them.
    """
    listed = [(f"{field}.{k}", each) for field in members for k, each in enumerate(members[field])]
    if not 0 <= place < len(listed):
        return ""
    field, member = listed[place]
    text = f"{member.word} '{member.name}'" if member.name else f"{member.word} ({field})"
    if field.startswith("keep_in"):
        return ZoneName(text)
    parts = getattr(member, "shapes", (member,))
    return (RoundName if any(part.word in _ROUND for part in parts) else ShapeName)(text)


def cloud_title(cloud: Any, number: int) -> CloudName:  # noqa: ANN401 - any member of a scene
    """A debris cloud as messages name it.

    Args:
        cloud: the cloud.
        number: its own among those of the scene.
    """
    return CloudName(f"{cloud.word} '{cloud.name}'" if cloud.name else f"{cloud.word} {number}")


def source_title(sources: Sequence[tuple[str, int]], place: int) -> str:
    """What a sphere comes from, as messages name it; empty where that is unknown.

    Args:
        sources: pairs of a name and a number of spheres.
        place: number of the sphere.
    """
    begin = 0
    for name, count in sources:
        if place < begin + count:
            own = MemberName(f"sphere {place - begin} of {name}")
            return own if isinstance(name, CloudName) else name
        begin += count
    return ""


def with_spheres(shapes: Sequence[ObstacleShape], growth: float) -> dict[str, Any]:
    """Shapes as arguments of a scene in which balls are spheres, to which distances are faster.

    Args:
        shapes: the shapes.
        growth: distance by which they are grown [m].
    """
    balls = [shape for shape in shapes if isinstance(shape, Ball)]
    return {
        "centers": [ball.position for ball in balls],
        "radii": [ball.radius + growth for ball in balls],
        "shapes": [shape for shape in shapes if not isinstance(shape, Ball)],
        "growth": growth,
    }


def extent_in_words(bounds: Array) -> str:
    """The box around obstacles; empty without any.

    Args:
        bounds: (2, 3) least and greatest coordinates [m], or (0, 3).
    """
    sides = zip("xyz", *bounds, strict=True) if len(bounds) else ()
    return ", ".join(f"{axis} {a:.4g} to {b:.4g} m" for axis, a, b in sides)


def common_growth(growths: Sequence[float]) -> float:
    """The growth of the members of several scenes, which is one for all.

    Args:
        growths: of the scenes that have such members [m].

    Raises:
        InvalidInput: they differ.
    """
    if len(set(growths)) > 1:
        allowed = "one growth of all shapes, zones, bodies and debris"
        raise InvalidInput("scene growth", list(growths), allowed)
    return growths[0] if growths else 0.0


def contents(spheres: int, members: Mapping[str, Sequence[Any]]) -> str:
    """How many obstacles of each kind there are, in words.

    Args:
        spheres: number of spheres.
        members: the objects of each field of the scene.
    """
    words = Counter(
        "zone" if field == "keep_in" else each.word for field in members for each in members[field]
    )
    plain = bool(spheres or not any(members[field] for field in ("shapes", "bodies", "debris")))
    parts = [counted(spheres, "sphere")] * plain
    parts += [f"{count} {_plural(word, count)}" for word, count in words.items()]
    if members["debris"]:
        parts[-1] += f" of {counted(sum(map(len, members['debris'])), 'sphere')}"
    return ", ".join(parts)


def _plural(word: str, count: int) -> str:
    if count == 1:
        return word
    if word.endswith("y"):
        return f"{word[:-1]}ies"
    return word + ("es" if word.endswith("x") else "s")


def row_count(values: object) -> int:
    """Number of rows of something that may become an array; 0 if that is not known.

    Args:
        values: what was given.
    """
    rows = isinstance(values, (list, tuple)) or (isinstance(values, np.ndarray) and values.ndim)
    return len(values) if rows else 0  # type: ignore[arg-type]


def checked_sources(
    sources: Sequence[tuple[str, int]], spheres: int
) -> tuple[tuple[str, int], ...]:
    """The sources, neighbours of one name together; nothing if no sphere has a name.

    Args:
        sources: pairs of a name and a number of spheres.
        spheres: number of spheres of the scene.

    Raises:
        InvalidInput: no such pairs, or numbers whose sum is another one.
    """
    merged: list[tuple[str, int]] = []
    try:
        pairs = [(name, count) for name, count in sources]
    except (TypeError, ValueError):
        raise InvalidInput("scene sources", sources, "pairs of a name and a number") from None
    for name, count in pairs:
        if not isinstance(name, str):
            raise InvalidInput("scene sources", name, "a name and a number of spheres")
        whole_number("scene sources", count, at_least=0)
        if merged and merged[-1][0] == name == "":
            merged[-1] = name, merged[-1][1] + count
        elif count:
            merged.append((name, count))
    total = sum(count for _, count in merged)
    if merged and total != spheres:
        raise InvalidInput("scene sources", f"{total} spheres", f"all {spheres} of the scene")
    return tuple(merged) if any(name for name, _ in merged) else ()
