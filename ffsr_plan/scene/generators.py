"""Seeded generators of scenes.

The same arguments, the seed included, give the same spheres on every machine.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import FARTHEST, finite_array, number, whole_number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.rotations import from_angles, level_direction, rotate
from ffsr_plan.scene.scene import Scene

Spared = Sequence[tuple[ArrayLike, float]]
_MOST_SPHERES = 1_000_000
_ATTEMPTS = 200


def cloud(
    seed: int,
    count: int,
    low: ArrayLike,
    high: ArrayLike,
    radii: ArrayLike,
    spared: Spared = (),
) -> Scene:
    """A cloud of debris: centres uniform in a box, radii uniform on a logarithmic scale.

    Args:
        seed: an integer >= 0.
        count: number of spheres; 0 for an empty scene.
        low: (3,) least coordinates of the centres [m].
        high: (3,) greatest coordinates of the centres [m].
        radii: (2,) least and greatest radius [m].
        spared: balls (centre [m], radius [m]) that stay free, for example around the start and the
            goal; a sphere that intersects one is drawn again.

    Raises:
        InvalidInput: an argument that is not allowed, or spared balls that leave no space.
    """
    first = finite_array("cloud low", low, (3,), FARTHEST)
    last = finite_array("cloud high", high, (3,), FARTHEST)
    if not np.all(first < last):
        raise InvalidInput("cloud high", last.tolist(), f"more than low, {first.tolist()}")

    def draw(rng: np.random.Generator, more: int) -> Array:
        return rng.uniform(first, last, (more, 3))

    return _drawn("cloud", seed, count, draw, radii, spared)


def belt(
    seed: int,
    count: int,
    radius: float,
    thickness: float,
    radii: ArrayLike,
    center: ArrayLike = (0.0, 0.0, 0.0),
    attitude: ArrayLike = (0.0, 0.0, 0.0),
    arc: ArrayLike = (0.0, 2.0 * np.pi),
    spared: Spared = (),
) -> Scene:
    """A belt of debris: centres uniform in a ring or an arc of it, radii on a logarithmic scale.

    Args:
        seed: an integer >= 0.
        count: number of spheres.
        radius: major radius of the ring, about its z axis [m], > 0.
        thickness: minor radius of the ring [m], > 0 and at most `radius`.
        radii: (2,) least and greatest radius of the spheres [m].
        center: (3,) centre of the ring, world [m].
        attitude: (3,) ZYX angles of the ring's axes [rad].
        arc: (2,) first and last angle of the arc from the ring's x axis [rad].
        spared: as for `cloud`.

    Raises:
        InvalidInput: an argument that is not allowed, or spared balls that leave no space.
    """
    large = number("belt radius", radius, above=0.0, at_most=FARTHEST)
    small = number("belt thickness", thickness, above=0.0, at_most=large)
    middle = finite_array("belt center", center, (3,), FARTHEST)
    axes = from_angles(finite_array("belt attitude", attitude, (3,)))
    begin, end = finite_array("belt arc", arc, (2,)).tolist()
    if not begin < end <= begin + 2.0 * np.pi + 1e-12:
        raise InvalidInput("belt arc", [begin, end], "begin < end <= begin + 2 pi")

    def draw(rng: np.random.Generator, more: int) -> Array:
        angle = rng.uniform(begin, end, more)
        out, up = np.zeros((2, more))
        left = np.arange(more)
        while len(left):  # rejection: density in the section grows with the circumference
            x, y, share = rng.uniform(-1.0, 1.0, (3, len(left)))
            kept = (x * x + y * y <= 1.0) & (
                0.5 * (share + 1.0) * (large + small) <= large + small * x
            )
            out[left[kept]], up[left[kept]] = small * x[kept], small * y[kept]
            left = left[~kept]
        ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(more)], axis=1)
        lifted = up[:, None] * np.array([0.0, 0.0, 1.0])
        return middle + rotate(axes, (large + out)[:, None] * ring + lifted)

    return _drawn("belt", seed, count, draw, radii, spared)


def scatter(
    seed: int, counts: Sequence[int], low: ArrayLike, high: ArrayLike, radii: ArrayLike
) -> Scene:
    """A few spheres in the world's xy-plane: number, positions and radii uniform.

    Args:
        seed: an integer >= 0.
        counts: (2,) least and greatest number of spheres.
        low: (2,) least x and y of the centres [m].
        high: (2,) greatest x and y of the centres [m].
        radii: (2,) least and greatest radius [m].

    Raises:
        InvalidInput: an argument that is not allowed.
    """
    rng = np.random.default_rng(whole_number("scatter seed", seed, at_least=0))
    if not isinstance(counts, Sequence) or len(counts) != 2:
        raise InvalidInput("scatter counts", counts, "the least and the greatest number")
    fewest = whole_number("scatter counts", counts[0], at_least=0)
    most = whole_number("scatter counts", counts[1], at_least=fewest, at_most=_MOST_SPHERES)
    first = finite_array("scatter low", low, (2,), FARTHEST)
    last = finite_array("scatter high", high, (2,), FARTHEST)
    if not np.all(first < last):
        raise InvalidInput("scatter high", last.tolist(), f"more than low, {first.tolist()}")
    small, large = _radii("scatter", radii)
    count = int(rng.integers(fewest, most + 1))
    x, y = (rng.uniform(first[k], last[k], count) for k in range(2))
    centers = np.stack([x, y, np.zeros(count)], axis=1)
    return Scene(centers, rng.uniform(small, large, count)).named("scatter")


def truss(
    begin: ArrayLike, end: ArrayLike, width: float, bays: int, radius: float, roll: float = 0.0
) -> Scene:
    """A boom of four longerons, with a square of battens between bays and a diagonal on each side.

    The distance between neighbouring spheres on a strut is at most their radius, so that they
    contain a cylinder about the strut of radius 0.86 `radius`.

    Args:
        begin: (3,) centre of the first square, world [m].
        end: (3,) centre of the last square, world [m].
        width: side of the squares [m], > 0.
        bays: number of bays, >= 1.
        radius: radius of the spheres [m], > 0 and at most `width` / 2.
        roll: rotation about the boom [rad]; at 0, two sides of the squares are horizontal, or along
            the world's x if the boom is vertical.

    Raises:
        InvalidInput: an argument that is not allowed.
    """
    first = finite_array("truss begin", begin, (3,), FARTHEST)
    last = finite_array("truss end", end, (3,), FARTHEST)
    length = float(np.linalg.norm(last - first))
    if length < 1e-6:
        raise InvalidInput("truss end", last.tolist(), "a place apart from its beginning")
    edge = number("truss width", width, above=0.0, at_most=FARTHEST)
    count = whole_number("truss bays", bays, at_least=1, at_most=10_000)
    size = number("truss radius", radius, above=0.0, at_most=0.5 * edge)
    along = (last - first) / length
    level = level_direction(along)
    upward = np.cross(along, level)
    angle = number("truss roll", roll)
    sides = np.cos(angle) * level + np.sin(angle) * upward
    others = np.cos(angle) * upward - np.sin(angle) * level
    square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    corners = 0.5 * edge * np.array([a * sides + b * others for a, b in square])
    joints = first + np.linspace(0.0, 1.0, count + 1)[:, None, None] * (last - first) + corners
    struts = [(joints[k, i], joints[k, i - 1]) for k in range(count + 1) for i in range(4)]
    for k, i in itertools.product(range(count), range(4)):
        struts.append((joints[k, i], joints[k + 1, i]))
        struts.append((joints[k, i], joints[k + 1, i - 1]))
    total = sum(np.linalg.norm(tip - tail) for tail, tip in struts)
    if total / size > _MOST_SPHERES:
        least = total / _MOST_SPHERES
        allowed = f"{least:.3g} m or more, for at most {_MOST_SPHERES} spheres along {total:.4g} m"
        raise InvalidInput("truss radius", radius, allowed)
    centers = [joints.reshape(-1, 3)]
    for tail, tip in struts:
        steps = int(np.ceil(np.linalg.norm(tip - tail) / size))
        centers.append(tail + np.arange(1, steps)[:, None] / steps * (tip - tail))
    whole = np.vstack(centers)
    return Scene(whole, np.full(len(whole), size)).named("truss")


def gate(along: float, aside: float, opening: float, radius: float) -> Scene:
    """Two spheres in the world's xy-plane with a gap for motion along x.

    Args:
        along: x of both centres [m].
        aside: y of the centre of the gap [m].
        opening: width of the gap [m], > 0.
        radius: radius of the spheres [m], > 0.

    Raises:
        InvalidInput: an argument that is not allowed.
    """
    x, y = number("gate along", along), number("gate aside", aside)
    half = 0.5 * number("gate opening", opening, above=0.0)
    size = number("gate radius", radius, above=0.0)
    centers = [[x, y + half + size, 0.0], [x, y - half - size, 0.0]]
    return Scene(centers, [size, size]).named("gate")


def _drawn(
    what: str,
    seed: int,
    count: int,
    draw: Callable[[np.random.Generator, int], Array],
    radii: ArrayLike,
    spared: Spared,
) -> Scene:
    """A scene of `count` spheres; a sphere that intersects a spared ball is drawn again."""
    rng = np.random.default_rng(whole_number(f"{what} seed", seed, at_least=0))
    count = whole_number(f"{what} count", count, at_least=0, at_most=_MOST_SPHERES)
    small, large = _radii(what, radii)
    balls = _balls(f"{what} spared", spared)
    centers, sizes = np.zeros((0, 3)), np.zeros(0)
    for _ in range(_ATTEMPTS):
        more = count - len(sizes)
        drawn = draw(rng, more)
        radius = np.exp(rng.uniform(np.log(small), np.log(large), more))
        outside = np.ones(more, dtype=bool)
        for center, ball_radius in balls:
            outside &= np.linalg.norm(drawn - center, axis=1) > ball_radius + radius
        centers, sizes = np.vstack([centers, drawn[outside]]), np.append(sizes, radius[outside])
        if len(sizes) == count:
            return Scene(centers, sizes).named(what)
    text = "; ".join(f"{r:g} m about ({x:g}, {y:g}, {z:g})" for (x, y, z), r in balls)
    raise InvalidInput(f"{what} spared", text, f"balls that leave room for the {what}")


def _balls(what: str, spared: Spared) -> list[tuple[Array, float]]:
    """Centres (3,) [m] and radii [m], checked."""
    pairs = isinstance(spared, (list, tuple)) and all(
        isinstance(ball, (list, tuple)) and len(ball) == 2 for ball in spared
    )
    if not pairs:
        raise InvalidInput(what, spared, "pairs of a centre and a radius")
    return [
        (finite_array(what, center, (3,), FARTHEST), number(what, radius, at_least=0.0))
        for center, radius in spared
    ]


def _radii(what: str, radii: ArrayLike) -> tuple[float, float]:
    small, large = finite_array(f"{what} radii", radii, (2,)).tolist()
    if not 0.0 < small <= large:
        raise InvalidInput(f"{what} radii", [small, large], "0 < least <= greatest")
    return small, large
