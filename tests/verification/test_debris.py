"""Plans verified among debris."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.verification.moving_bodies.drifting_spheres import DriftingSpheres
from tests.helpers.drifting_spheres import DURATION, cloud_about, problem_in_debris


@pytest.fixture(scope="module")
def flown():
    """A plan through debris."""
    return fp.plan(problem_in_debris(3, 60), fp.LatticeOptimum(), refine=False)


def among(plan, *clouds):
    """The plan among other debris; what it claims of its clearance is zero."""
    problem = replace(plan.problem, scene=fp.Scene(debris=clouds))
    certificate = plan.certificate._replace(least_clearance=0.0)
    return replace(plan, problem=problem, certificate=certificate)


def test_a_plan_through_debris_verifies(flown):
    report = flown.verify()
    assert report.ok, report.problems
    assert report.nearest_body == "debris cloud 'shell'"
    assert report.clearance_error < 1e-9
    least = flown.certificate.least_clearance
    assert least - 1e-6 <= report.clearance_bound <= report.least_clearance
    assert flown.slip == pytest.approx(least / flown.problem.scene.debris[0].speed)


def test_a_sphere_in_the_way_is_found_and_named(flown):
    time = 0.4 * DURATION
    there, velocity = flown.at(0.4)[:3], np.array((0.0, 0.8, 0.0))
    far = cloud_about(5, 30, name="far")
    away = far.centers + np.array((0.0, 60.0, 0.0))
    centers = np.vstack([away, there - time * velocity])
    drifts = np.vstack([far.velocities, velocity])
    hit = fp.DebrisCloud(centers, np.append(far.radii, 0.05), drifts, "hit")
    report = among(flown, hit).verify()
    (found,) = [each for each in report.problems if "on edge" in each]
    assert "sphere 30 of debris cloud 'hit'" in found
    assert report.nearest_time == pytest.approx(time, abs=1.5)


def test_listed_spheres_hold_the_nearest_of_all():
    cloud, rng = cloud_about(9, 400), np.random.default_rng(0)
    spheres = DriftingSpheres([cloud], 0.0, np.zeros(3))
    times = np.linspace(10.0, 14.0, 9)
    tracks = np.linspace((1.0, 0.0, 0.0), (1.6, 0.2, 0.0), 9)[:, None]
    beside = np.full((9, len(spheres.speeds), 1), 0.2)
    stretch = np.zeros(9, dtype=np.int64)
    spheres.stretches(np.full(1, 0.1), stretch, times, tracks, beside)
    listed = np.concatenate([near for near, _ in spheres._lists])
    assert len(listed) < 400
    for _ in range(50):
        time = rng.uniform(10.0, 14.0)
        point = tracks[int((time - 10.0) / 0.5), 0] + 0.05
        apart = np.linalg.norm(cloud.centers_at(time) - point, axis=1) - cloud.radii
        assert int(np.argmin(apart)) in listed
