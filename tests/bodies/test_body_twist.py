"""The twist of a body is the change of its poses."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.bodies.body_twist import body_state
from ffsr_plan.core import rotations
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.verification.moving_bodies.body_courses import course_of
from tests.helpers.moving_scenes import KINDS, body_of

STEP = 1e-3  # [s]


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "function"])
def test_the_twist_is_that_of_differences_of_poses(kind):
    body, time, place = body_of(kind, seed=5), 7.0, np.array([1.0, -2.0, 0.5])
    state = body_state(body, time)
    before, after = (body.poses([time + step]) for step in (-STEP, STEP))
    turn = rotations.multiply(after.attitudes[0], rotations.inverse(before.attitudes[0]))
    assert state.angular_velocity == pytest.approx(rotations.log(turn) / (2.0 * STEP), abs=1e-6)
    own = rotations.matrix(state.attitude).T @ (place - state.position)
    moved = body.point(own, time + STEP) - body.point(own, time - STEP)
    assert state.velocity_at(place) == pytest.approx(moved / (2.0 * STEP), abs=1e-6)
    other = course_of(body, 20.0).twist(time)
    assert np.concatenate(other) == pytest.approx(np.concatenate(state[2:]), abs=1e-9)


def test_a_function_tells_no_velocity():
    with pytest.raises(InvalidInput, match=r"motion of body 'told': .*whose velocity is known"):
        body_state(body_of("function"), 1.0)


def test_a_row_of_a_track_counts_up_to_its_end():
    track = fp.Track([0.0, 1.0, 2.0], [[0, 0, 0], [1, 0, 0], [1, 2, 0]], [[0, 0, 0, 1.0]] * 3)
    body = fp.MovingBody([fp.Ball(0.1)], track)
    for time, velocity in ((0.0, (1, 0, 0)), (1.0, (1, 0, 0)), (1.5, (0, 2, 0)), (2.0, (0, 2, 0))):
        assert body_state(body, time).velocity == pytest.approx(velocity)
