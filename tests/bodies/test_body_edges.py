"""Proofs past bodies that move."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ffsr_plan as fp
from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pose_function import PoseFunction
from ffsr_plan.bodies.track import Track
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.body_edge import BodyEdge
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.interval_halving import ROUNDING, certify, clearance_bound
from ffsr_plan.proof.motion_edges import NominalPlacements
from ffsr_plan.proof.moving_obstacles import BodyProof

STILL = np.zeros(3)
SHAPES = [fp.Box((0.6, 1.6, 0.02)), fp.Capsule(0.1, 0.8, (0.3, 0.0, 0.2))]


def around(place):
    """A function of time: on a circle of 1 m about a place, turning along."""

    def pose(time):
        angle = 0.05 * time
        at = place + np.array([np.cos(angle), np.sin(angle), 0.0])
        return at, Rotation.from_rotvec([0.0, 0.0, angle]).as_quat()

    return pose


def body(rng, kind, place):
    """A body of two shapes somewhere, that moves."""
    angles = rng.uniform(-3.0, 3.0, 3)
    if kind == "drift":
        return MovingBody(SHAPES, Drift(rng.normal(size=3) * 0.05), place, angles)
    if kind == "spin":
        return MovingBody(SHAPES, Spin(rng.normal(size=3) * 0.1, (0.01, 0.0, 0.0)), place, angles)
    if kind == "tumble":
        motion = Tumble((1.0, 1.7, 2.2), rng.normal(size=3) * 0.1, known_until=60.0)
        return MovingBody(SHAPES, motion, place, angles)
    if kind == "function":
        return MovingBody(SHAPES, PoseFunction(around(place), 0.06, 0.05))
    turns = Rotation.from_rotvec(np.cumsum(rng.normal(size=(7, 3)) * 0.1, axis=0)).as_quat()
    track = place + np.cumsum(rng.normal(size=(7, 3)) * 0.1, axis=0)
    return MovingBody(SHAPES, Track(np.arange(7) * 10.0, track, turns))


class Window:
    """An edge run between two times, evenly or faster and faster."""

    def __init__(self, times, even=True):
        self.times, self.even = times, even

    def instants(self, places):
        share = places if self.even else places**2
        return self.times[0] + share * (self.times[1] - self.times[0])

    def is_even(self, edge):
        return self.even


def edge_past(moving, motion, pace):
    query = ObstacleQuery(motion.robot, fp.Scene(shapes=moving.shapes))
    step = np.array(motion.positions[1] - motion.positions[0])
    return BodyEdge(
        moving, query, NominalPlacements(motion), EdgeTravel(motion), 0, (STILL, STILL), step,
        pace, ROUNDING,
    )  # fmt: skip


def sampled(moving, motion, pace, count=160):
    """Distances from the shapes where they are in the world, one scene an instant."""
    shares = np.linspace(0.0, 1.0, count + 1)
    q = motion.at(np.zeros(count + 1, dtype=np.int64), shares)
    poses = moving.poses(pace.instants(shares))
    least = []
    for row, place, attitude in zip(q, poses.positions, poses.attitudes, strict=True):
        turn = Rotation.from_quat(np.array(attitude))
        here = [
            type(shape)(
                *([shape.size] if isinstance(shape, fp.Box) else [shape.radius, shape.length]),
                place + turn.apply(np.array(shape.position)),
                (turn * Rotation.from_quat(np.array(shape.attitude))).as_quat(),
            )
            for shape in SHAPES
        ]
        least.append(fp.clearance(motion.robot, fp.Scene(shapes=here), row))
    return np.array(least)


@pytest.mark.parametrize("kind", ["drift", "spin", "tumble", "track", "function"])
def test_no_edge_that_a_moving_body_touches_is_proven_free(kind):
    robot, counts = fp.load_robot("planar_dual_arm"), np.zeros(3, dtype=int)
    for seed in range(10):
        rng = np.random.default_rng(seed)
        begin = robot.configuration(rng.uniform(-0.5, 0.5, 3))
        joints = dict(zip(robot.joint_names, rng.uniform(-0.5, 0.5, robot.nd), strict=True))
        end = robot.configuration(rng.uniform(-0.5, 0.5, 3), joints=joints)
        motion = Motion(robot, "free-flying", begin, end, np.stack([begin[:3], end[:3]]))
        moving = body(rng, kind, rng.normal(size=3) * 0.9)
        start = rng.uniform(0.0, 40.0)
        pace = Window((start, start + rng.uniform(0.5, 15.0)), even=seed % 2 == 0)
        edge = edge_past(moving, motion, pace)
        ends = edge.clearance(0.0), edge.clearance(1.0)
        least = sampled(moving, motion, pace)
        assert ends == pytest.approx((least[0], least[-1]), abs=1e-8)
        free = min(ends) > 0.0 and certify(edge, ends, 1e-4).free
        assert not (free and np.min(least) <= 0.0)
        assert free or np.min(least) < 2e-3
        counts += [free, not free, free and edge.speed > sum(ends)]
    assert counts[0] >= 2
    assert counts[1] >= 1


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("kind", ["drift", "spin", "tumble", "track"])
def test_compiled_proofs_say_what_those_by_coal_say(kind, even):
    robot, rng = fp.load_robot("planar_dual_arm"), np.random.default_rng(3)
    counts = np.zeros(3, dtype=int)
    for _ in range(12):
        end = robot.configuration(rng.uniform(-0.5, 0.5, 3), joints={"left_1": 0.7})
        motion = Motion(robot, "free-flying", robot.neutral(), end, np.stack([STILL, end[:3]]))
        moving = body(rng, kind, rng.normal(size=3) * 1.2)
        start = rng.uniform(0.0, 40.0)
        edge = edge_past(moving, motion, Window((start, start + rng.uniform(0.5, 15.0)), even))
        ends = edge.clearance(0.0), edge.clearance(1.0)
        by_coal = certify(edge, ends, 1e-4)
        proof = BodyProof(motion, fp.Scene(shapes=moving.shapes), EdgeTravel(motion), True)
        found = proof.certify(edge, ends, 1e-4)
        assert found.free == by_coal.free
        assert found.least_clearance == pytest.approx(by_coal.least_clearance, abs=1e-7)
        counts += [found.free, not found.free, found.free and found.queries > 0]
        if found.free:
            bound, least = proof.clearance_bound(edge, ends, min(ends), 0.05)
            reference = clearance_bound(edge, ends, min(ends), 0.05)
            assert least == pytest.approx(reference[1], abs=1e-7)
            assert bound == pytest.approx(reference[0], abs=0.05 * least + 1e-7)
            assert least * 0.95 - 1e-7 <= bound <= least
    assert counts.all()


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("kind", ["drift", "spin", "tumble", "track", "function"])
def test_clearances_change_by_no_more_than_both_travel(kind, even):
    robot, rng = fp.load_robot("planar_dual_arm"), np.random.default_rng(1)
    begin = robot.neutral()
    end = robot.configuration((0.4, 0.2, 0.0), joints={"left_1": 0.7})
    motion = Motion(robot, "free-flying", begin, end, np.stack([begin[:3], end[:3]]))
    shares = []
    for _ in range(12):
        moving = body(rng, kind, rng.normal(size=3) * 2.0)
        edge = edge_past(moving, motion, Window((2.0, 20.0), even))
        for _ in range(6):
            a, b = np.sort(rng.uniform(0.0, 1.0, 2))
            change = abs(edge.clearance(b) - edge.clearance(a))
            bound = float(np.max(edge.travel(a, b)))
            assert change <= bound + 1e-8
            shares.append(change / bound)
    assert max(shares) > 0.3


def test_a_body_without_shapes_or_with_a_zone_or_two_poses_is_refused():
    with pytest.raises(InvalidInput, match="shapes"):
        MovingBody([], Drift())
    with pytest.raises(InvalidInput, match=r"shapes\.0"):
        MovingBody([fp.HalfSpace((1.0, 0.0, 0.0))], Drift())
    with pytest.raises(InvalidInput, match="motion"):
        MovingBody(SHAPES, "fast")
    track = Track([0.0, 1.0], np.zeros((2, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)))
    with pytest.raises(InvalidInput, match="the Track tells it"):
        MovingBody(SHAPES, track, (1.0, 0.0, 0.0))
    with pytest.raises(InvalidInput, match="from 0 to 1 s"):
        MovingBody(SHAPES, track).poses([2.0])


def test_a_function_that_is_faster_than_stated_is_refused():
    slow = PoseFunction(around(np.zeros(3)), 0.03, 0.05)
    with pytest.raises(InvalidInput, match=r"speed: got 0\.03; allowed: the 0\.0499"):
        MovingBody(SHAPES, slow).poses([0.0, 2.0])
    with pytest.raises(InvalidInput, match="turn_rate"):
        MovingBody(SHAPES, PoseFunction(around(np.zeros(3)), 0.06)).poses([0.0, 2.0])
    with pytest.raises(InvalidInput, match="a position and an attitude"):
        MovingBody(SHAPES, PoseFunction(lambda _: np.zeros(7), 0.06)).poses([0.0])


def test_shapes_are_where_the_body_has_them():
    moving = body(np.random.default_rng(3), "tumble", np.array([1.0, 2.0, 3.0]))
    (place,), (turn,) = moving.poses([30.0])
    axes = Rotation.from_quat(np.array(turn))
    for shape, own in zip(moving.shapes_at(30.0, "it"), moving.shapes, strict=True):
        assert shape.position == pytest.approx(place + axes.apply(np.array(own.position)))
        wanted = (axes * Rotation.from_quat(np.array(own.attitude))).as_matrix()
        assert Rotation.from_quat(np.array(shape.attitude)).as_matrix() == pytest.approx(wanted)
        assert shape.name == "it"
        assert moving.point(own.position, 30.0) == pytest.approx(np.array(shape.position))


@pytest.mark.parametrize("kind", ["drift", "spin", "tumble", "track", "function"])
def test_no_point_of_a_body_outruns_its_bounds(kind):
    rng = np.random.default_rng(4)
    for _ in range(5):
        moving = body(rng, kind, rng.normal(size=3))
        times = np.linspace(0.0, 50.0, 501)
        poses, points = moving.poses(times), rng.normal(size=(60, 3))
        inside = points * (moving.reach / np.linalg.norm(points, axis=1).max())
        axes = Rotation.from_quat(np.array(poses.attitudes)).as_matrix()
        placed = poses.positions[:, None] + inside @ axes.transpose(0, 2, 1)
        ways = np.linalg.norm(np.diff(placed, axis=0), axis=2)
        assert ways.sum(axis=0).max() <= moving.travel(0.0, 50.0) * (1.0 + 1e-9)
        fastest = ways.max() / 0.1
        assert fastest <= moving.speed * (1.0 + 1e-9)
        if kind in ("drift", "track"):
            assert fastest > 0.3 * moving.speed
