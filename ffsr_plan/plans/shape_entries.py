"""Shapes and zones in plan files: lists of tables, each with its kind beside the fields."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Rule
from ffsr_plan.core.settings import UnknownKey, from_mapping
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.keep_in_zones import ZONES, Zone
from ffsr_plan.scene.shapes.obstacle_shapes import ObstacleShape

ZONE_KINDS: dict[str, type[Any]] = {kind.word: kind for kind in ZONES}  # type: ignore[attr-defined]
"""The classes of zones by their words."""


def shape_entries(scene: Scene) -> dict[str, Any]:
    """Shapes, zones and their growth in plain Python values; what a scene lacks is left out.

    Args:
        scene: the obstacles.
    """
    entries: dict[str, Any] = {}
    if scene.shapes:
        entries["shapes"] = [plain_entry(shape) for shape in scene.shapes]
    if scene.keep_in:
        entries["keep_in"] = [plain_entry(zone) for zone in scene.keep_in]
    if (entries or scene.moves) and scene.growth > 0.0:
        entries["growth"] = scene.growth
    return entries


def plain_entry(body: ObstacleShape | Zone) -> dict[str, Any]:
    """A shape or zone in plain Python values, with its kind.

    Args:
        body: the shape or zone.
    """
    values = {each.name: getattr(body, each.name) for each in fields(body)}  # type: ignore[arg-type]
    plain = {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in values.items()}
    return {"kind": body.word, **plain}


@dataclass(frozen=True)
class Bodies(Rule):
    """A list of tables, which become objects of settings classes.

    Attributes:
        kinds: the classes by what a table names as its kind.
    """

    kinds: Mapping[str, type[Any]]

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> tuple[Any, ...]:
        """See `Rule.check`."""
        if isinstance(value, str) or not isinstance(value, Sequence):
            raise InvalidInput(what, value, "a list of tables")
        return tuple(self._made(what, k, each) for k, each in enumerate(value))

    def _made(self, what: str, number: int, value: object) -> object:
        try:
            return made_of_kind(f"{what}.{number}", value, self.kinds)
        except UnknownKey as error:
            raise error.within(str(number)) from None


def made_of_kind(what: str, value: object, kinds: Mapping[str, type[Any]]) -> object:
    """The object of a settings class that a table with its kind describes.

    Args:
        what: names the table in errors.
        value: the table.
        kinds: the classes by what a table names as its kind.

    Raises:
        InvalidInput: no such table.
    """
    if not isinstance(value, Mapping):
        raise InvalidInput(what, value, "a table with a kind")
    table = dict(value)
    kind = one_of(f"{what}.kind", table.pop("kind", None), list(kinds))
    try:
        return from_mapping(kinds[kind], table)
    except UnknownKey:
        raise
    except InvalidInput as error:
        raise InvalidInput(f"{what}{error.what}", error.value, error.allowed) from None
