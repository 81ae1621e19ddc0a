"""Family `moving`: 10 m past doors, fences, panels, booms, satellites and debris that move."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from ffsr_plan.core.arrays import Array
from ffsr_plan.problem_set.families.drafts import (
    PLANAR,
    SATELLITE,
    Draft,
    Family,
    Tables,
    box,
    numbers,
)
from ffsr_plan.problem_set.families.paper import GOAL, START

DURATION = 200.0  # [s]
WAITING = {
    "divisions": 80,
    "lateral": {"half_count": 12, "spacing": 0.25},
    "progress": {"steps": 20, "most": 1, "aside": 2, "before": 4, "beyond": 4},
}
WAITING_IN_SPACE = {
    "divisions": 80,
    "lateral": {"half_count": 4, "spacing": 0.5},
    "normal": {"half_count": 4, "spacing": 0.5},
    "progress": {"steps": 20, "most": 1, "aside": 1, "before": 2, "beyond": 2},
}
_DEPTH, _WALL = 1.0, 0.3  # [m] across the plane, and thickness of walls
_ROWS = 101  # of a track
Drawn = tuple[str, Tables]


def draw(rng: np.random.Generator, number: int) -> Draft:
    """A problem: one of six kinds of bodies, in turn.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    kinds: tuple[Callable[[np.random.Generator], Drawn], ...] = (
        _door,
        _fences,
        _panel,
        _boom,
        _satellites,
        _debris,
    )
    what, obstacles = kinds[number % 6](rng)
    tables = {
        "robot": {"urdf": PLANAR, "mode": "free-flying"},
        "start": {"joints": START},
        "goal": {"position": [10.0, 0.0, 0.0], "joints": GOAL},
        **obstacles,
        "pace": {"duration": DURATION},
        "lattice": WAITING,
        "objective": {"delta": 0.02, "clearance_cap": 1.0},
    }
    if number % 6 == 4:
        tables |= {
            "robot": {"urdf": SATELLITE, "mode": "free-flying"},
            "start": {"posture": "stowed"},
            "goal": {"position": [10.0, 0.0, 0.0], "posture": "ready"},
            "lattice": WAITING_IN_SPACE,
        }
    return Draft(what, tables, 0.02, blocked=False)


def _wall(x: float, opening: float) -> list[Tables]:
    """A wall across the way with an opening in its middle [m]."""
    length, middle = 7.0 - 0.5 * opening, 0.5 * (7.0 + 0.5 * opening)
    size = (_WALL, length, _DEPTH)
    return [
        box(size, (x, side * middle, 0.0), name) for side, name in ((1.0, "left"), (-1.0, "right"))
    ]


def _body(name: str, shapes: list[Tables], motion: Tables, place: object = None) -> Tables:
    table: Tables = {"name": name, "shapes": shapes, **motion}
    if place is not None:
        table["position"] = numbers(place)
    return table


def _door(rng: np.random.Generator) -> Drawn:
    x, half = rng.uniform(4.0, 6.0), rng.uniform(1.9, 2.3)
    rate = math.radians(rng.uniform(1.5, 4.0)) * float(rng.choice([-1.0, 1.0]))
    leaf = box((2.0 * half, 0.24, _DEPTH), (0.0, 0.0, 0.0), "leaf")
    door = _body("door", [leaf], {"spin": {"rate": numbers([0.0, 0.0, rate])}}, (x, 0.0, 0.0))
    door["attitude"] = numbers([rng.uniform(0.0, np.pi), 0.0, 0.0])
    return "a revolving door", {"obstacles": _wall(x, 2.0 * half + 0.3), "bodies": [door]}


def _fences(rng: np.random.Generator) -> Drawn:
    x, bodies = rng.uniform(4.0, 6.0), []
    for k, place in enumerate((x - 1.6, x + 1.6)):
        window, period = rng.uniform(2.6, 3.2), rng.uniform(11.0, 14.0)
        speed = rng.uniform(0.06, 0.15) * float(rng.choice([-1.0, 1.0]))
        phase, pieces = rng.uniform(0.0, period), []
        for turn in range(-3, 4):
            first = turn * period + 0.5 * window + 0.2
            last = (turn + 1) * period - 0.5 * window - 0.2
            for y in np.linspace(first, last, int(np.ceil((last - first) / 0.7)) + 1):
                at = np.array([0.0, y + phase, 0.0]) + rng.uniform(-0.15, 0.15, 3) * (1, 1, 0)
                pieces.append({"center": numbers(at), "radius": 0.2})
        drift = {"drift": {"velocity": numbers([0.0, speed, 0.0])}}
        bodies.append(_body(f"fence {k + 1}", pieces, drift, (place, -100.0 * speed, 0.0)))
    return "two drifting fences", {"bodies": bodies}


def _panel(rng: np.random.Generator) -> Drawn:
    x, half = rng.uniform(4.0, 6.0), rng.uniform(2.2, 3.0)
    side, times = float(rng.choice([-1.0, 1.0])), np.linspace(0.0, DURATION, _ROWS)
    phase = 2.0 * np.pi * times / rng.uniform(70.0, 160.0) + rng.uniform(0.0, 2.0 * np.pi)
    opened = 0.75 + 0.85 * np.sin(phase)  # [rad]; at zero the panel closes the opening
    yaw = side * (0.5 * np.pi + opened)
    length = 2.0 * half - 0.1
    track = _track(times, np.tile((x, -side * half, 0.0), (_ROWS, 1)), yaw[:, None] * (0, 0, 1))
    panel = box((length, 0.2, _DEPTH), (0.5 * length, 0.0, 0.0), "panel")
    return "a swinging panel", {
        "obstacles": _wall(x, 2.0 * half),
        "bodies": [_body("panel", [panel], track)],
    }


def _boom(rng: np.random.Generator) -> Drawn:
    x, half = rng.uniform(4.0, 6.0), rng.uniform(2.0, 2.6)
    rate = rng.normal(size=3) * (2.0, 1.0, 1.0)
    rate *= math.radians(rng.uniform(2.0, 4.0)) / float(np.linalg.norm(rate))
    boom = box((2.0 * half, 0.24, 0.24), (0.0, 0.0, 0.0), "boom")
    tumble = {"tumble": {"inertia": [0.2, 1.0, 1.1], "rate": numbers(rate), "known_until": 200.0}}
    body = _body("boom", [boom], tumble, (x, 0.0, 0.0))
    body["attitude"] = numbers(rng.uniform(-1.5, 1.5, 3))
    return "a tumbling boom", {"obstacles": _wall(x, 2.0 * half + 0.3), "bodies": [body]}


def _satellites(rng: np.random.Generator) -> Drawn:
    def near() -> Array:
        return np.array([rng.uniform(3.0, 7.0), *rng.uniform(-1.0, 1.0, 2)])

    def shapes() -> list[Tables]:
        panel = rng.uniform(0.3, 0.8), rng.uniform(0.8, 1.6), 0.02
        arm = 0.25 + 0.5 * panel[1]
        parts = [box((0.5, 0.5, 0.5), (0.0, 0.0, 0.0), "bus")]
        return parts + [box(panel, (0.0, side * arm, 0.0), "panel") for side in (-1.0, 1.0)]

    velocity = rng.normal(size=3) * (0.01, 0.02, 0.02)
    spin, tumble = rng.normal(size=3) * 0.03, rng.normal(size=3) * 0.03
    drift = rng.normal(size=3) * (0.0, 0.03, 0.03)
    times = np.linspace(0.0, DURATION, 21)
    way = near() + np.cumsum(rng.normal(size=(21, 3)) * 0.1, axis=0)
    turned = np.cumsum(rng.normal(size=(21, 3)) * 0.08, axis=0)
    motions: tuple[tuple[Tables, object], ...] = (
        ({"drift": {"velocity": numbers(drift)}}, near() - 0.5 * DURATION * drift),
        ({"spin": {"rate": numbers(spin)}}, near()),
        (
            {
                "tumble": {
                    "inertia": [1.0, 1.6, 2.2],
                    "rate": numbers(tumble),
                    "velocity": numbers(velocity),
                    "known_until": DURATION,
                }
            },
            near() - 0.5 * DURATION * velocity,
        ),
        (_track(times, way, turned), None),
    )
    bodies = [
        _body(f"satellite {k + 1}", shapes(), motion, place)
        for k, (motion, place) in enumerate(motions)
    ]
    return "four satellites in space", {"bodies": bodies}


def _debris(rng: np.random.Generator) -> Drawn:
    count = int(rng.integers(60, 200))
    halfway = rng.uniform([1.0, -3.5, -0.5], [9.0, 3.5, 0.5], (count, 3))
    velocities = rng.normal(size=(count, 3)) * (0.01, 0.02, 0.002)
    radii = rng.uniform(0.03, 0.12, count)
    begin, end = halfway - 100.0 * velocities, halfway + 100.0 * velocities
    kept = np.linalg.norm(begin, axis=1) > 1.8
    kept &= np.linalg.norm(end - (10.0, 0.0, 0.0), axis=1) > 1.8
    cloud = {
        "name": "debris",
        "centers": numbers(begin[kept]),
        "radii": numbers(radii[kept]),
        "velocities": numbers(velocities[kept]),
    }
    return f"{int(kept.sum())} drifting spheres", {"debris": [cloud]}


def _track(times: Array, places: Array, vectors: Array) -> Tables:
    """A track of places (n, 3) [m] and rotation vectors (n, 3) [rad]."""
    turns = Rotation.from_rotvec(vectors).as_quat()
    return {
        "track": {
            "times": numbers(times),
            "positions": numbers(places),
            "attitudes": np.round(turns, 12).tolist(),  # of length one within 1e-9
        }
    }


FAMILY = Family(
    "moving", "past bodies that move, spin and tumble, waiting where need be", 30, 20.0, draw
)
