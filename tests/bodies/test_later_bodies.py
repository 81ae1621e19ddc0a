"""Bodies, debris and scenes from a later instant on."""

import numpy as np
import pytest

import ffsr_plan as fp
from tests.helpers.moving_scenes import KINDS, body_of


@pytest.mark.parametrize("kind", KINDS)
def test_a_later_body_is_where_the_body_is_later(kind):
    body, by, times = body_of(kind), 7.3, np.linspace(0.0, 12.0, 25)
    later = body.later(by)
    here, there = later.poses(times), body.poses(times + by)
    assert here.positions == pytest.approx(there.positions, abs=1e-12)
    same = np.abs(np.sum(here.attitudes * there.attitudes, axis=1))
    assert same == pytest.approx(np.ones(len(times)), abs=1e-12)
    assert later.motion.known_until == pytest.approx(body.motion.known_until - by)
    assert (later.name, later.shapes) == (body.name, body.shapes)


def test_a_later_scene_is_the_scene_at_a_later_time():
    cloud = fp.DebrisCloud(np.eye(3), [0.1, 0.2, 0.3], np.eye(3)[::-1], "cloud")
    scene = fp.Scene([[0.0, 0.0, 5.0]], [0.5], bodies=[body_of("spin")], debris=[cloud])
    later = scene.later(2.5)
    for now in (0.0, 3.0):
        assert later.at(now).centers == pytest.approx(scene.at(now + 2.5).centers)
        places = [
            [s.position for s in each.at(t).shapes]
            for each, t in ((later, now), (scene, now + 2.5))
        ]
        assert np.array(places[0]) == pytest.approx(np.array(places[1]))
    assert fp.Scene([[0.0, 0.0, 5.0]], [0.5]).later(3.0) == fp.Scene([[0.0, 0.0, 5.0]], [0.5])


def test_a_motion_that_is_not_known_later_is_refused():
    for time in (20.0, 30.0, -1.0):
        with pytest.raises(fp.InvalidInput, match="time"):
            body_of("track").later(time)
