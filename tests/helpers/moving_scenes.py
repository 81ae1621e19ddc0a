"""Problems past bodies that move, and their clearances a thousand times a second, by other code."""

from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

import ffsr_plan as fp
from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pose_function import PoseFunction
from ffsr_plan.bodies.track import Track
from ffsr_plan.bodies.tumble import Tumble
from tests.helpers.careless_plans import placed

DURATION = 20.0
MILLISECOND = 1e-3
KINDS = ("drift", "spin", "tumble", "track", "function")


def told(time):
    """The poses of a body that a function tells."""
    attitude = Rotation.from_rotvec([0.0, 0.0, 0.5 * np.sin(0.2 * time)]).as_quat()
    return (2.0 + 0.3 * np.sin(0.3 * time), 0.9 + 0.2 * np.cos(0.3 * time), 0.0), attitude


def body_of(kind, seed=0):
    """A dumb-bell of balls that moves beside the middle of a way of 4 m along x."""
    rng = np.random.default_rng(seed)
    balls = [fp.Ball(0.15, p) for p in ((0.25, 0.0, 0.0), (-0.25, 0.1, 0.0), (0.0, 0.2, 0.1))]
    place = np.array([rng.uniform(1.5, 2.5), rng.uniform(0.8, 1.2), 0.0])
    angles = rng.uniform(-3.0, 3.0, 3)
    velocity = rng.normal(size=3) * (0.03, 0.02, 0.0)
    if kind == "drift":
        motion = Drift(velocity * 2.0)
    elif kind == "spin":
        motion = Spin(rng.normal(size=3) * 0.4, velocity)
    elif kind == "tumble":
        motion = Tumble((1.0, 1.6, 2.1), rng.normal(size=3) * 0.4, velocity, DURATION)
    elif kind == "function":
        return MovingBody(balls, PoseFunction(told, 0.1, 0.11), name="told")
    else:
        times = np.linspace(0.0, DURATION, 9)
        steps = Rotation.from_rotvec(rng.normal(size=(9, 3)) * 0.1)
        turns = [Rotation.from_rotvec(angles)]
        for step in steps[1:]:
            turns.append(turns[-1] * step)
        ways = place + np.cumsum(rng.normal(size=(9, 3)) * (0.08, 0.08, 0.0), axis=0)
        track = Track(times, ways, np.array([turn.as_quat() for turn in turns]))
        return MovingBody(balls, track, name="track")
    return MovingBody(balls, motion, place, angles, name=kind)


def problem_past(*bodies, seed=0, length=4.0, ramp=0.0, duration=DURATION, **fields):
    """A way along x past bodies."""
    rng, robot = np.random.default_rng(seed), fp.load_robot("planar_dual_arm")
    return fp.Problem(
        robot,
        fp.Scene(bodies=bodies),
        start=robot.neutral(),
        goal=robot.configuration((length, 0.0, 0.0), joints={"left_1": rng.uniform(-0.6, 0.6)}),
        lattice=fp.Lattice(6, lateral=fp.Axis(4, 0.4)),
        delta=0.1,
        duration=duration,
        ramp=ramp,
        **fields,
    )


def share_run(problem, times):
    """The share of the path that is run at times (n,), from the integral of the trapezoid."""
    u, ramp = np.asarray(times) / problem.duration, problem.ramp
    if ramp == 0.0:
        return u
    early, late = np.minimum(u, ramp), np.maximum(u - 1.0 + ramp, 0.0)
    even = np.maximum(u - ramp, 0.0)
    return (early**2 / (2.0 * ramp) + even - late**2 / (2.0 * ramp)) / (1.0 - ramp)


def tumble_by_hand(motion, times):
    """Rotations of a body without torque, by the classical method of Runge and Kutta."""
    inertia = np.asarray(motion.inertia)
    inverse = np.linalg.inv(inertia)

    def slope(y):
        rate, (a, b, c, d) = y[:3], 0.5 * y[3:]
        x, y_, z = rate
        carried = inertia @ rate
        turn = (d * x + b * z - c * y_, d * y_ + c * x - a * z, d * z + a * y_ - b * x)
        return np.array([*(inverse @ np.cross(carried, rate)), *turn, -a * x - b * y_ - c * z])

    now = np.array([*motion.rate, 0.0, 0.0, 0.0, 1.0])
    found = [now]
    for begin, end in pairwise(times):
        step = end - begin
        k1 = slope(now)
        k2 = slope(now + 0.5 * step * k1)
        k3 = slope(now + 0.5 * step * k2)
        k4 = slope(now + step * k3)
        now = now + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        found.append(now)
    return Rotation.from_quat(np.array(found)[:, 3:])


def poses_by_hand(body, times):
    """Positions (n, 3) and rotations of a body in the world at even times (n,)."""
    motion = body.motion
    if isinstance(motion, Track):
        rows = [np.interp(times, motion.times, column) for column in motion.positions.T]
        slerp = Slerp(motion.times, Rotation.from_quat(motion.attitudes))
        return np.column_stack(rows), slerp(times)
    if isinstance(motion, PoseFunction):
        poses = [motion.function(time) for time in times]
        return np.array([place for place, _ in poses]), Rotation.from_quat([q for _, q in poses])
    places = body.position + times[:, None] * motion.velocity
    begin = Rotation.from_quat(body.attitude)
    if isinstance(motion, Spin):
        return places, begin * Rotation.from_rotvec(times[:, None] * motion.rate)
    if isinstance(motion, Tumble):
        return places, begin * tumble_by_hand(motion, times)
    return places, Rotation.from_quat(np.tile(begin.as_quat(), (len(times), 1)))


def clearances_by_hand(plan, times):
    """(n,) distances of the links to bodies of balls at even times."""
    return _distances(plan.problem, placed(plan, share_run(plan.problem, times)), times)


class _Places:
    """The path of a flight by its times."""

    def __init__(self, flight):
        self.problem, self._flight = flight.problem, flight

    def at(self, times):
        return self._flight.at(times).configurations


def flown_clearances_by_hand(flight, times, late=0.0):
    """(n,) the same along the path of a flight that is late by so many seconds."""
    links = placed(_Places(flight), np.clip(times - late, 0.0, flight.duration))
    return _distances(flight.problem, links, times)


def _distances(problem, links, times):
    found = np.full(len(times), np.inf)
    for body in problem.scene.bodies:
        places, turns = poses_by_hand(body, times)
        for ball in body.shapes:
            centers = places + turns.apply(np.array(ball.position))
            radius = ball.radius + problem.min_clearance
            for solid, poses in links:
                own = np.einsum("nji,nj->ni", poses[:, :3, :3], centers - poses[:, :3, 3])
                found = np.minimum(found, _from_solid(solid, own) - radius)
    return found


def _from_solid(solid, points):
    """(n,) signed distances of points from a box, a ball or a capsule."""
    if solid.half is not None:
        beyond = np.abs(points) - solid.half
        return np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0)
    first, last = solid.points[0], solid.points[-1]
    along = last - first
    share = np.clip((points - first) @ along / max(along @ along, 1e-30), 0.0, 1.0)
    return np.linalg.norm(points - first - share[:, None] * along, axis=1) - solid.swell
