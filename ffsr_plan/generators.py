"""Seeded scenes: the same arguments give the same spheres, everywhere."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.errors import InvalidInput
from ffsr_plan.inputs import FARTHEST, finite_array, number, whole_number
from ffsr_plan.scene import Scene

_ATTEMPTS = 200


def cloud(
    seed: int,
    count: int,
    low: ArrayLike,
    high: ArrayLike,
    radii: ArrayLike,
    spared: Sequence[tuple[ArrayLike, float]] = (),
) -> Scene:
    """A cloud of debris: centres uniform in a box, radii uniform on a logarithmic scale.

    Args:
        seed: a whole number >= 0.
        count: number of spheres; none make an empty scene.
        low: (3,) least coordinates of the centres [m].
        high: (3,) greatest coordinates of the centres [m].
        radii: (2,) least and greatest radius [m].
        spared: balls (centre [m], radius [m]) that no sphere reaches into, such as the places where
            the robot starts and ends; a sphere that would is drawn again.

    Raises:
        InvalidInput: an argument that is not allowed, or no room beside what is spared.
    """
    rng = np.random.default_rng(whole_number("cloud seed", seed, at_least=0))
    count = whole_number("cloud count", count, at_least=0, at_most=1_000_000)
    first = finite_array("cloud low", low, (3,), FARTHEST)
    last = finite_array("cloud high", high, (3,), FARTHEST)
    if not np.all(first < last):
        raise InvalidInput("cloud high", last.tolist(), f"more than low, {first.tolist()}")
    small, large = finite_array("cloud radii", radii, (2,)).tolist()
    if not 0.0 < small <= large:
        raise InvalidInput("cloud radii", [small, large], "0 < least <= greatest")
    balls = [
        (finite_array("cloud spared", center, (3,)), number("cloud spared", radius, at_least=0.0))
        for center, radius in spared
    ]
    centers, sizes = np.zeros((0, 3)), np.zeros(0)
    for _ in range(_ATTEMPTS):
        more = count - len(sizes)
        drawn = rng.uniform(first, last, (more, 3))
        radius = np.exp(rng.uniform(np.log(small), np.log(large), more))
        apart = np.ones(more, dtype=bool)
        for center, room in balls:
            apart &= np.linalg.norm(drawn - center, axis=1) > room + radius
        centers, sizes = np.vstack([centers, drawn[apart]]), np.append(sizes, radius[apart])
        if len(sizes) == count:
            return Scene(centers, sizes)
    kept = "; ".join(f"{room:g} m about ({x:g}, {y:g}, {z:g})" for (x, y, z), room in balls)
    raise InvalidInput("cloud spared", kept, "balls that leave room for the cloud")


def gate(along: float, aside: float, opening: float, radius: float) -> Scene:
    """Two spheres in the world's xy-plane that leave a gap for who travels along x.

    Args:
        along: x of both centres [m].
        aside: y of the middle of the gap [m].
        opening: width of the gap [m], greater than 0.
        radius: of the spheres [m], greater than 0.
    """
    x, y = number("gate along", along), number("gate aside", aside)
    half = 0.5 * number("gate opening", opening, above=0.0)
    size = number("gate radius", radius, above=0.0)
    return Scene([[x, y + half + size, 0.0], [x, y - half - size, 0.0]], [size, size])
