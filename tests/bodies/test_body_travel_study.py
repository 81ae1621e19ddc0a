"""The study of bounds on the travel of bodies."""

import numpy as np
import pytest

from benchmarks.studies.moving.body_travel import (
    KINDS,
    body_shares,
    edge_shares,
    random_body,
    rate_share,
    report,
    shares_travelled,
)


@pytest.mark.parametrize("kind", KINDS)
def test_points_of_random_bodies_stay_within_their_bound(kind):
    rng = np.random.default_rng(1)
    shares = np.concatenate([body_shares(rng, kind, 30) for _ in range(4)])
    assert 0.7 < shares.max() <= 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_a_bound_that_is_too_small_is_noticed(kind):
    body = random_body(np.random.default_rng(2), kind)

    class Slow:
        motion, shapes, poses = body.motion, body.shapes, staticmethod(body.poses)

        @staticmethod
        def travel(begin, end):
            return 0.5 * body.travel(begin, end)

    begins = np.linspace(0.0, 200.0, 20)
    assert shares_travelled(Slow, begins, begins + 1.0).max() > 1.0


@pytest.mark.parametrize("ramp", [0.0, 0.2])
@pytest.mark.parametrize("kind", KINDS)
def test_clearances_on_random_edges_stay_within_their_bound(kind, ramp):
    rng = np.random.default_rng(3)
    shares = [share for _ in range(6) for share in edge_shares(rng, kind, ramp, 5)]
    assert 0.2 < max(shares) <= 1.0


def test_tumbles_reach_their_largest_rate():
    rng = np.random.default_rng(4)
    for _ in range(5):
        peak, largest = rate_share(rng)
        assert peak == pytest.approx(1.0, abs=1e-9)
        assert largest <= 1.0 + 1e-9


def test_the_report_counts_what_is_beyond_the_bound():
    shares = {"Drift": np.array([0.5, 1.0, 1.5])}
    page = report(shares, {("Drift", 0.2): np.array([0.5, 2.0])}, [(1.0, 1.0)], "")
    assert "**2 violations** on 5 intervals" in page
    assert "| Drift, ramp 0.2 | 2 | 1 |" in page
