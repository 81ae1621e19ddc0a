"""The travel bound along curves: never exceeded, sharp, and that of straight edges on these."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.edge_travel import EdgeTravel
from tests.helpers.curved_flights import MODES, places, random_curve, shares_of_the_bound
from tests.helpers.random_robots import Limb, at, body, dot, put_together, random_tree

ROBOTS, PARTS = 300, 5  # by six pieces and three modes: 27 000 intervals


def parts(rng):
    """The whole piece, and shorter and shorter parts of it."""
    lengths = 0.5 ** rng.uniform(0.0, 6.0, PARTS)
    lengths[0] = 1.0
    begin = rng.uniform(0.0, 1.0 - lengths)
    return zip(begin.tolist(), (begin + lengths).tolist(), strict=True)


@pytest.mark.parametrize("mode", MODES)
def test_no_point_travels_farther_along_a_curve_than_the_bound(mode):
    largest = 0.0
    for seed in range(ROBOTS):
        curve = random_curve(seed, mode)
        for begin, end in parts(np.random.default_rng(seed)):
            shares = shares_of_the_bound(curve, begin, end)
            assert shares.max() <= 1.0, (seed, begin, end)
            largest = max(largest, float(shares.max()))
    assert largest > 0.9  # a bound lower by a tenth would be exceeded


def test_no_point_travels_farther_in_the_base_than_its_bound_along_a_curve():
    largest = 0.0
    for seed in range(ROBOTS):
        curve = random_curve(seed, "free-flying")
        for begin, end in parts(np.random.default_rng(seed)):
            shares = shares_of_the_bound(curve, begin, end, in_base=True)
            assert shares.max() <= 1.0, (seed, begin, end)
            largest = max(largest, float(shares.max()))
    assert largest > 0.9


@pytest.mark.parametrize("mode", MODES)
def test_no_point_is_faster_or_bends_more_than_its_bounds(mode):
    """Of first and second differences, which are means of velocity and acceleration."""
    for seed in range(60):
        curve = random_curve(seed, mode)
        begin, length = 0.25, 0.5
        points = EdgeTravel(curve).over(begin, begin + length)[0].points
        at = places(curve, begin, begin + length)
        step = length / (at.shape[1] - 1)
        speed = np.linalg.norm(np.diff(at, axis=1), axis=-1).max(axis=1) / step
        bend = np.linalg.norm(np.diff(at, 2, axis=1), axis=-1).max(axis=1) / step**2
        assert np.all(speed <= points["speed"] + 1e-9)
        assert np.all(bend <= points["curvature"] * 4.0 / length**2 + 1e-7)
        whole = EdgeTravel(curve).speeds
        assert np.all(speed.max(axis=1) <= whole + 1e-9)


def test_the_speed_bound_holds_for_short_parts_of_a_piece():
    """A piece may be fast in a part and slow elsewhere: the bound is on speed, not on length."""
    robot = fp.load_robot("planar_dual_arm")
    start, goal = (robot.configuration(p) for p in ((0, 0, 0), (1, 0, 0)))
    positions = np.array([[0, 0, 0], [0.0, 0, 0], [1, 0, 0], [1, 0, 0], [1.0, 0, 0]])
    motion = Motion(robot, "free-flying", start, goal, positions)
    curve = CurvedMotion(motion, control_points_on(motion, np.arange(5.0)))
    speeds = EdgeTravel(curve).speeds
    for k in range(4):
        way = np.diff(curve.at(np.full(65, k), np.linspace(0, 1, 65))[:, 0]) * 64
        assert np.abs(way).max() <= speeds[k] + 1e-9


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("seed", range(12))
def test_along_straight_edges_the_bound_is_that_of_straight_edges(mode, seed):
    rng, robot, edges = np.random.default_rng(seed), random_tree(seed), 4
    joints = rng.uniform(-1, 1, robot.nd) + np.arange(edges + 1.0)[:, None] * rng.normal(
        size=robot.nd
    )
    positions = np.arange(edges + 1.0)[:, None] * rng.normal(size=3)
    quats = rotations.exp(rng.normal(size=(2, 3)))
    start, goal = robot.assemble(positions[[0, -1]], quats, joints[[0, -1]])
    motion = Motion(robot, mode, start, goal, positions, joints)
    curve = CurvedMotion(motion, control_points_on(motion, np.arange(edges + 1.0)))
    steps, still = motion.base_steps(), np.zeros((edges, 3))
    for begin, end in ((0.0, 1.0), (0.5, 0.75), (0.125, 0.25)):
        for in_base in (False, True):
            expected, found = (
                EdgeTravel(each).over(begin, end, in_base)[0] for each in (motion, curve)
            )
            moves = still if in_base else steps
            wanted = expected.bounds(np.arange(edges), moves)
            assert found.bounds(np.arange(edges), still) == pytest.approx(
                wanted, rel=1e-8, abs=1e-12
            )


BENT = np.array([12.5, 4.5, 0.5, 0.5, 4.5, 12.5]) - 0.5  # on the middle piece q' = t - 1/2, q'' = 1
LEVEL, MIDDLE = np.zeros(6), 2


def one_joint(
    kind,
    base_mass,
    base=LEVEL,
    joint=LEVEL,
    mode="free-flying",
    turn=0.0,
    share=None,
    on_base=False,
):
    """A curve of a robot with one joint about z or along x, and a dot at (0.5, 0, 0).

    Args:
        kind: of the joint.
        base_mass: mass and moment of the base, heavy or light against the link.
        base: (6,) control points of the base origin along y [m].
        joint: (6,) of the joint [rad or m].
        mode: what actuates the base.
        turn: of the base by wheels about z [rad].
        share: (6,) of that turn.
        on_base: whether the dot is on the base, and not on the link.
    """
    axis = 2 if kind == "revolute" else 0
    made = Limb(0, kind, axis, at(), body(1.0, 0.1), [] if on_base else [dot(x=0.5)])
    robot = put_together(body(base_mass, base_mass), [dot(x=0.5)] if on_base else [], [made])
    positions = np.column_stack([LEVEL, base, LEVEL])
    quats = rotations.exp(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, turn]]))
    start, goal = robot.assemble(positions[[0, -1]], quats, joint[[0, -1], None])
    motion = Motion(robot, mode, start, goal, positions, joint[:, None])
    control = control_points_on(motion, np.arange(6.0))
    return CurvedMotion(motion, control if share is None else control._replace(shares=share))


@pytest.mark.parametrize(
    ("curve", "least"),
    [
        (one_joint("revolute", 1.0, base=BENT), 0.999),  # max |p''|
        (one_joint("prismatic", 1e12, joint=0.1 * BENT), 0.999),  # b_j of a sliding joint
        (one_joint("revolute", 1e12, joint=0.01 * BENT), 0.98),  # b_j of a turning joint
        (
            one_joint("revolute", 1.0, joint=0.01 * BENT, on_base=True),
            0.95,
        ),  # l' of a base that reacts
        (
            one_joint("revolute", 1.0, mode="attitude-held", turn=0.3, share=0.1 * BENT),
            0.97,
        ),  # kappa of wheels
    ],
    ids=["base", "sliding", "turning", "reaction", "wheels"],
)
def test_each_term_of_a_curve_can_be_attained(curve, least):
    """The point rests in the middle, so that the terms of the second derivatives are alone."""
    assert shares_of_the_bound(curve, 0.0, 1.0)[MIDDLE].max() > least
    assert shares_of_the_bound(curve, 0.0, 1.0).max() <= 1.0
