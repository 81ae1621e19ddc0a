"""Movies and flights show bodies that move where they are at the time of each frame."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image, ImageSequence

import ffsr_plan as fp
from ffsr_plan.bodies.body_motion import Drift
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display.flights.flight_figure import flight_figure
from ffsr_plan.display.flights.flight_movie import write_flight_movie
from ffsr_plan.display.flights.flight_page import flight_page
from ffsr_plan.display.flights.flight_samples import FlownProblem, sample_flight
from ffsr_plan.display.motion_page import Axis, PlayedMotion, motion_page
from ffsr_plan.display.movie_frames import MovingScene, PanelCurve, pictures, robot_outlines
from ffsr_plan.display.moving_picture import write_gif
from ffsr_plan.display.scenes.plan_samples import sample_plan
from ffsr_plan.display.scenes.projection import view_axes
from tests.helpers.plan_past_bodies import BODIES, data_of, plan_past_bodies


@pytest.fixture(scope="module")
def plan():
    return plan_past_bodies()


def moving_scene(plan, times):
    samples = sample_plan(plan, 3)
    axes = view_axes(plan.problem)
    robot = robot_outlines(samples.frames, axes, "visual")
    curve = PanelCurve(np.linspace(0.0, 1.0, 3), [], "#ffffff")
    words = [[]] * 3
    return MovingScene(
        plan.problem, "", samples.frames, axes, robot, [curve], words, None, None, times
    )


def test_a_movie_draws_bodies_where_they_are_in_each_frame(plan):
    """In pixels of the colour of bodies, their middle is that of the ball that drifts."""
    alone = replace(plan, problem=replace(plan.problem, scene=fp.Scene(bodies=BODIES[1:2])))
    times = np.array([0.0, 20.0, 40.0])
    scene = moving_scene(alone, times)
    middles = []
    for picture in pictures(scene, 800):
        red, green, blue = np.moveaxis(np.asarray(picture).astype(float), 2, 0)
        pink = (red > 1.4 * green) & (blue > 1.15 * green) & (red > blue) & (red > 60)
        rows, columns = np.nonzero(pink)
        middles.append([columns.mean(), -rows.mean()])
    expected = BODIES[1].poses(times).positions @ scene.axes[:2].T
    ratios = np.diff(middles, axis=0) / np.diff(expected, axis=0)  # pixels a metre
    assert np.allclose(ratios, ratios[0, 0], rtol=0.08)
    assert ratios[0, 0] > 50


def test_a_gif_of_a_plan_past_bodies_moves_and_tells_the_time(plan, tmp_path):
    write_gif(plan, tmp_path / "plan.gif", frames=4)
    frames = [
        np.array(f.convert("RGB")).astype(int)
        for f in ImageSequence.Iterator(Image.open(tmp_path / "plan.gif"))
    ]
    assert len(frames) == 4
    clock = np.s_[-170:-120, 190:240]
    for one, other in pairwise(frames):
        assert np.abs(one[clock] - other[clock]).sum() > 0


@pytest.fixture(scope="module")
def flown(flight):
    """A flight of a plan without bodies, past a body that was put there afterwards."""
    body = MovingBody([fp.Ball(0.3)], Drift((0.01, 0.0, 0.0)), (0.0, 3.0, 0.0), name="debris")
    problem = flight.problem
    problem = replace(problem, scene=fp.Scene(bodies=[body]), duration=flight.duration)
    return FlownProblem(problem, flight.limits, flight)


def test_clearances_of_a_flight_are_those_at_its_own_times(flown):
    times = np.linspace(0.0, flown.flight.duration, 4)
    samples = sample_flight(flown, times)
    for time, q, found in zip(
        times, samples.frames.configurations, samples.clearances, strict=True
    ):
        scene = flown.problem.scene.at(time)
        assert found == pytest.approx(fp.clearance(flown.problem.robot, scene, q))


def test_pictures_of_a_flight_show_bodies_and_its_slip(flown, tmp_path):
    late = replace(flown.flight, problem=flown.problem)
    flown = flown._replace(flight=late)
    data = data_of(flight_page(flown))
    assert data["subtitle"].endswith(f"free of bodies even {late.slip:.2g} s early or late")
    assert np.isfinite(late.slip)
    assert [row["name"] for row in data["bodies"]] == ["debris"]
    figure = flight_figure(flown, silhouettes=5)
    assert "early or late" in figure.get_suptitle()
    texts = [t.get_text() for t in figure.axes[0].texts if t.get_color() == "#c2528b"]
    assert texts[0] == "debris\n0 s"
    assert "clearance\n[m]" in [ax.get_ylabel() for ax in figure.axes]
    write_flight_movie(flown, tmp_path / "flight.gif", speed=flown.flight.duration / 0.4)


def test_a_flight_longer_than_a_motion_is_known_is_not_drawn(flown):
    tumble = Tumble((1.0, 2.0, 2.5), (0.1, 0.0, 0.0), known_until=10.0)
    body = MovingBody([fp.Ball(0.3)], tumble, (0.0, 3.0, 0.0))
    problem = replace(flown.problem, scene=fp.Scene(bodies=[body]), duration=10.0)
    with pytest.raises(InvalidInput, match="times from 0 to 10 s"):
        flight_page(flown._replace(problem=problem))


def test_nothing_is_drawn_of_bodies_without_times(plan):
    samples = sample_plan(plan, 3)
    axis = Axis("s", "", "", 1.0, 12.0, 1)
    with pytest.raises(InvalidInput, match=r"times.*a time"):
        motion_page(PlayedMotion(plan.problem, samples.frames, axis, [], "", "", ""))
    with pytest.raises(InvalidInput, match=r"times.*a time"):
        pictures(moving_scene(plan, None), 400)
