"""Motions of bodies, and how far their points travel."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.track import Track, WideTurns
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core import rotations
from ffsr_plan.core.errors import InvalidInput


def table(seed, rows=30):
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(1.0, 5.0, rows - 1))])
    steps = Rotation.from_rotvec(rng.normal(size=(rows - 1, 3)) * 0.1)
    turns = [Rotation.random(random_state=seed)]
    for step in steps:
        turns.append(turns[-1] * step)
    places = np.cumsum(rng.normal(size=(rows, 3)) * 0.2, axis=0)
    return Track(times, places, Rotation.concatenate(turns).as_quat())


MOTIONS = {
    "drift": lambda seed: Drift(np.random.default_rng(seed).normal(size=3) * 0.1),
    "spin": lambda seed: Spin(np.random.default_rng(seed).normal(size=3) * 0.1, (0.01, 0.02, 0.0)),
    "tumble": lambda seed: Tumble(
        (1.0, 1.6, 2.1), np.random.default_rng(seed).normal(size=3) * 0.1, (0.0, 0.01, 0.0), 60.0
    ),
    "track": table,
}


@pytest.mark.parametrize("kind", MOTIONS)
@pytest.mark.parametrize("seed", range(3))
def test_no_point_of_a_body_outruns_its_bound(kind, seed):
    motion, rng = MOTIONS[kind](seed), np.random.default_rng(seed)
    shares = []
    for _ in range(30):
        begin = rng.uniform(0.0, 40.0)
        end, point = begin + 10.0 ** rng.uniform(-2.0, 1.0), rng.normal(size=3)
        poses = motion.poses(np.linspace(begin, end, 400))
        track = poses.positions + rotations.rotate(poses.attitudes, np.tile(point, (400, 1)))
        travelled = np.sum(np.linalg.norm(np.diff(track, axis=0), axis=1))
        arm = np.linalg.norm(point)
        if motion.axis is not None:
            arm = np.linalg.norm(np.cross(motion.axis, point))
        bound = motion.path(begin, end) + motion.turned(begin, end) * arm
        assert travelled <= bound * (1.0 + 1e-9) + 1e-12
        shares.append(travelled / bound)
    assert max(shares) > 0.7


def test_between_rows_of_a_table_lines_and_constant_rates_are_the_motion():
    motion, rng = table(5), np.random.default_rng(5)
    times = np.sort(rng.uniform(0.0, motion.known_until, 200))
    poses = motion.poses(times)
    expected = Slerp(motion.times, Rotation.from_quat(motion.attitudes))(times)
    assert np.max((expected.inv() * Rotation.from_quat(poses.attitudes)).magnitude()) < 1e-7
    for axis in range(3):
        line = np.interp(times, motion.times, motion.positions[:, axis])
        assert poses.positions[:, axis] == pytest.approx(line, abs=1e-12)


def test_signs_of_quaternions_in_a_table_do_not_matter():
    motion = table(6)
    flipped = motion.attitudes * np.where(np.arange(30) % 3 == 0, -1.0, 1.0)[:, None]
    same = Track(motion.times, motion.positions, flipped)
    times = np.linspace(0.0, motion.known_until, 100)
    there, here = motion.poses(times).attitudes, same.poses(times).attitudes
    assert np.max(rotations.angle_between(there, here)) < 1e-7
    assert same.turned(0.0, 20.0) == pytest.approx(motion.turned(0.0, 20.0), abs=1e-12)


def test_wide_turns_of_a_table_are_doubtful_or_refused():
    turns = Rotation.from_euler("z", [[0.0], [40.0]], degrees=True).as_quat()
    with pytest.warns(WideTurns, match="40 degrees"):
        Track([0.0, 1.0], np.zeros((2, 3)), turns)
    turns = Rotation.from_euler("z", [[0.0], [100.0]], degrees=True).as_quat()
    with pytest.raises(InvalidInput, match="rows 0 and 1"):
        Track([0.0, 1.0], np.zeros((2, 3)), turns)


@pytest.mark.parametrize("times", [[0.0], [1.0, 2.0], [0.0, 2.0, 2.0]])
def test_times_that_do_not_ascend_from_zero_are_refused(times):
    count = len(times)
    with pytest.raises(InvalidInput, match="times"):
        Track(times, np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))
