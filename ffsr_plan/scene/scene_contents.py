"""Checks of what a scene is made of, and how messages name its members."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ffsr_plan.core.checks import whole_number
from ffsr_plan.core.contacts import ShapeName, ZoneName
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.scene.keep_in_zones import Zone
from ffsr_plan.scene.obstacle_shapes import ObstacleShape


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


def member_title(member: ObstacleShape | Zone, place: int, shapes: int) -> str:
    """A shape or zone as messages name it.

    Args:
        member: the shape or zone.
        place: its place among the shapes and the zones behind them.
        shapes: number of shapes.
    """
    zone = place >= shapes
    number = place - shapes if zone else place
    field = f"keep_in.{number}" if zone else f"shapes.{number}"
    text = f"{member.word} '{member.name}'" if member.name else f"{member.word} ({field})"
    return ZoneName(text) if zone else ShapeName(text)


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
