"""Random scenes in which the robot has to pass what moves: in the plane and in space.

A way of 10 m and 200 s. Doors, panels and booms turn in an opening of a wall; fences of debris with
windows drift across the way; in space four bodies, one of each motion, move about the way.
"""

from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

import ffsr_plan as fp

DURATION = 200.0  # [s]
FAMILIES = ("revolving door", "drifting fences", "swinging panel", "tumbling boom")
STEADY = fp.Lattice(40, lateral=fp.Axis(20, 0.15))
"""One step onwards from layer to layer."""
WAITING = fp.Lattice(
    80,
    lateral=fp.Axis(12, 0.25),
    progress=fp.Progress(20, most=1, aside=2, before=4, beyond=4),
)
"""Steps of 2.5 s, in which the base moves by 0.5 m along and across the way, at 0.2 m/s each."""
WAITING_IN_SPACE = fp.Lattice(
    80,
    lateral=fp.Axis(4, 0.5),
    normal=fp.Axis(4, 0.5),
    progress=fp.Progress(20, most=1, aside=1, before=2, beyond=2),
)
"""The same speeds along three axes."""
_DEPTH, _WALL = 1.0, 0.3  # [m] across the plane, and thickness


@cache
def _paper():
    """Start and goal of the paper's robot."""
    return fp.load_scenario("fig2a")


@cache
def _satellite():
    """A satellite with a UR5."""
    return fp.load_robot("satellite_ur5")


def _wall(x, opening):
    """A wall across the way with an opening in its middle [m]."""
    length = 7.0 - 0.5 * opening
    middle = 0.5 * (7.0 + 0.5 * opening)
    size = (_WALL, length, _DEPTH)
    return [fp.Box(size, (x, side * middle, 0.0)) for side in (1.0, -1.0)]


def _door(rng, x):
    """A panel that turns about its middle in an opening."""
    half = rng.uniform(1.9, 2.3)
    rate = np.radians(rng.uniform(1.5, 4.0)) * rng.choice([-1, 1])
    leaf = fp.Box((2.0 * half, 0.24, _DEPTH))
    door = fp.MovingBody(
        [leaf], fp.Spin((0.0, 0.0, rate)), (x, 0.0, 0.0), (rng.uniform(0.0, np.pi), 0.0, 0.0)
    )
    return _wall(x, 2.0 * half + 0.3), [door]


def _fences(rng, x):
    """Two rows of debris that drift across the way, with windows."""
    bodies = []
    for place in (x - 1.6, x + 1.6):
        window, period = rng.uniform(2.6, 3.2), rng.uniform(11.0, 14.0)
        speed, phase = rng.uniform(0.06, 0.15) * rng.choice([-1, 1]), rng.uniform(0.0, period)
        pieces = []
        for k in range(-3, 4):
            first, last = k * period + 0.5 * window + 0.2, (k + 1) * period - 0.5 * window - 0.2
            for y in np.linspace(first, last, int(np.ceil((last - first) / 0.7)) + 1):
                at = np.array([0.0, y + phase, 0.0]) + rng.uniform(-0.15, 0.15, 3) * (1, 1, 0)
                if rng.random() < 0.7:
                    pieces.append(fp.Ball(0.2, at))
                else:
                    pieces.append(fp.Box(rng.uniform(0.25, 0.4, 3), at, rng.uniform(-3, 3, 3)))
        drift = fp.Drift((0.0, speed, 0.0))
        bodies.append(fp.MovingBody(pieces, drift, (place, -0.5 * speed * DURATION, 0.0)))
    return [], bodies


def _panel(rng, x):
    """A panel on a hinge at one side of an opening, that swings to and fro."""
    half, side = rng.uniform(2.2, 3.0), float(rng.choice([-1, 1]))
    times = np.linspace(0.0, DURATION, 401)
    swing = np.sin(2.0 * np.pi * times / rng.uniform(70.0, 160.0) + rng.uniform(0.0, 2.0 * np.pi))
    opened = 0.75 + 0.85 * swing  # [rad]; at zero the panel closes the opening
    length = 2.0 * half - 0.1
    yaw = side * (0.5 * np.pi + opened)
    turns = Rotation.from_rotvec(yaw[:, None] * (0.0, 0.0, 1.0)).as_quat()
    places = np.tile((x, -side * half, 0.0), (len(times), 1))
    panel = fp.Box((length, 0.2, _DEPTH), (0.5 * length, 0.0, 0.0))
    return _wall(x, 2.0 * half), [fp.MovingBody([panel], fp.Track(times, places, turns))]


def _boom(rng, x):
    """A boom that tumbles in an opening."""
    half = rng.uniform(2.0, 2.6)
    rate = rng.normal(size=3) * (2.0, 1.0, 1.0)
    rate *= np.radians(rng.uniform(2.0, 4.0)) / np.linalg.norm(rate)
    motion = fp.Tumble((0.2, 1.0, 1.1), rate, known_until=DURATION)
    boom = fp.Box((2.0 * half, 0.24, 0.24))
    turn = Rotation.random(rng=rng).as_quat()
    return _wall(x, 2.0 * half + 0.3), [fp.MovingBody([boom], motion, (x, 0.0, 0.0), turn)]


def drawn(seed, family):
    """The problem of a seed on the waiting lattice; its ends may be blocked.

    Args:
        seed: of the scene.
        family: number of the family.
    """
    rng = np.random.default_rng((seed, family))
    still, bodies = (_door, _fences, _panel, _boom)[family](rng, rng.uniform(4.0, 6.0))
    ends = _paper()
    return fp.Problem(
        ends.robot,
        fp.Scene(shapes=still, bodies=bodies),
        ends.start,
        ends.goal,
        lattice=WAITING,
        delta=0.02,
        duration=DURATION,
    )


def drawn_in_space(seed):
    """The problem of a seed in space, past a wall with an opening; its ends may be blocked."""
    rng, robot = np.random.default_rng((seed, 4)), _satellite()

    def near():
        """A place near the way [m]."""
        return np.array([rng.uniform(3.0, 7.0), *rng.uniform(-1.0, 1.0, 2)])

    def shapes():
        """A bus with two panels."""
        panel = rng.uniform(0.3, 0.8), rng.uniform(0.8, 1.6), 0.02
        arm = 0.25 + 0.5 * panel[1]
        return [fp.Box((0.5, 0.5, 0.5)), *(fp.Box(panel, (0.0, s * arm, 0.0)) for s in (-1, 1))]

    velocity = rng.normal(size=3) * (0.01, 0.02, 0.02)
    spin, tumble = rng.normal(size=3) * 0.03, rng.normal(size=3) * 0.03
    drift = rng.normal(size=3) * (0.0, 0.03, 0.03)
    times, place = np.linspace(0.0, DURATION, 21), near()
    way = place + np.cumsum(rng.normal(size=(21, 3)) * 0.1, axis=0)
    turned = Rotation.from_rotvec(np.cumsum(rng.normal(size=(21, 3)) * 0.08, axis=0)).as_quat()
    bodies = [
        fp.MovingBody(shapes(), fp.Drift(drift), near() - 0.5 * DURATION * drift),
        fp.MovingBody(shapes(), fp.Spin(spin), near(), rng.uniform(-3, 3, 3)),
        fp.MovingBody(
            shapes(),
            fp.Tumble((1.0, 1.6, 2.2), tumble, velocity, DURATION),
            near() - 0.5 * DURATION * velocity,
        ),
        fp.MovingBody(shapes(), fp.Track(times, way, turned)),
    ]
    start = robot.configuration((0.0, 0.0, 0.0), joints="stowed")
    goal = robot.configuration((10.0, 0.0, 0.0), joints="ready")
    return fp.Problem(
        robot,
        fp.Scene(bodies=bodies),
        start,
        goal,
        lattice=WAITING_IN_SPACE,
        delta=0.02,
        clearance_cap=1.0,
        duration=DURATION,
    )
