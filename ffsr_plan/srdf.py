"""Pairs of links that an SRDF exempts from self-collision."""

from __future__ import annotations

from collections.abc import Sequence

from ffsr_plan.errors import InvalidInput, unknown_name
from ffsr_plan.urdf_check import parse


def disabled_pairs(text: str, where: str, links: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """The pairs of `<disable_collisions>`, each sorted, in sorted order; the rest is not read.

    Args:
        text: the SRDF; empty for none.
        where: file or robot name that starts every message.
        links: names of the robot's links.

    Raises:
        InvalidInput: not XML, a document type, or a link that the robot does not have.
    """
    if not text:
        return ()
    pairs = set()
    for element in parse(text, where).findall("disable_collisions"):
        pair = [element.get(key) for key in ("link1", "link2")]
        for key, link in zip(("link1", "link2"), pair, strict=True):
            if link not in links:
                raise unknown_name(f"{where}, disable_collisions {key}", link, links)
        if pair[0] == pair[1]:
            raise InvalidInput(f"{where}, disable_collisions", pair, "two different links")
        first, second = sorted(map(str, pair))
        pairs.add((first, second))
    return tuple(sorted(pairs))
