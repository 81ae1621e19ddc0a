"""Debris in pages and figures, where it is at the time of each frame."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.collections import EllipseCollection

import ffsr_plan as fp
from ffsr_plan.display.figures import path_figure
from ffsr_plan.display.scenes.debris_track import debris_track
from ffsr_plan.display.scenes.timed_clearances import clearances
from tests.helpers.drifting_spheres import DURATION, problem_in_debris
from tests.helpers.plan_past_bodies import data_of


@pytest.fixture(scope="module")
def flown():
    """A plan through debris."""
    return fp.plan(problem_in_debris(3, 60), fp.LatticeOptimum(), refine=False)


def test_a_page_moves_every_sphere(flown, tmp_path):
    flown.write_html(tmp_path / "plan.html")
    data = data_of((tmp_path / "plan.html").read_text(encoding="utf-8"))
    (cloud,) = flown.problem.scene.debris
    assert np.allclose(data["drifts"], DURATION * cloud.velocities, atol=1e-4)
    (row,) = data["bodies"]
    assert row["name"] == f"{len(cloud)} spheres of debris"
    assert row["least"] >= flown.certificate.least_clearance - 1e-4


def test_clearances_of_frames_are_those_at_their_times(flown):
    from ffsr_plan.display.scenes.plan_samples import sample_plan

    samples = sample_plan(flown, 7)
    found = clearances(samples.frames, flown.problem.scene, samples.times)
    for q, time, own in zip(samples.frames.configurations, samples.times, found, strict=True):
        there = flown.problem.scene.at(float(time))
        assert own == pytest.approx(fp.clearance(flown.problem.robot, there, q), abs=1e-9)


def test_a_figure_has_the_spheres_at_several_times(flown):
    figure = path_figure(flown)
    (cloud,) = flown.problem.scene.debris
    discs = [each for each in figure.axes[0].collections if isinstance(each, EllipseCollection)]
    drawn = [each for each in discs if len(each.get_offsets()) == len(cloud)]
    assert len(drawn) > 2
    offsets = [np.sort(each.get_offsets()[:, 0]) for each in drawn]
    assert not np.allclose(offsets[0], offsets[-1])
    plt.close(figure)


def test_no_picture_draws_debris_without_a_time(flown):
    with pytest.raises(fp.InvalidInput, match="times"):
        debris_track(flown.problem.scene, None)
