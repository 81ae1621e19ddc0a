"""The pace at which a path is run."""

import numpy as np
import pytest

from ffsr_plan.bodies.pace import Pace


@pytest.mark.parametrize("ramp", [0.0, 0.2, 0.5])
def test_speed_rises_and_falls_evenly_and_stays_between(ramp):
    pace = Pace(30.0, ramp, 7)
    places = np.linspace(0.0, 7.0, 7001)
    times = pace.instants(places)
    assert (times[0], times[-1]) == (0.0, 30.0)
    assert np.all(np.diff(times) > 0.0)
    middles, speeds = 0.5 * (times[1:] + times[:-1]), np.diff(places) / np.diff(times)
    top = 7.0 / 30.0 / (1.0 - ramp)
    rising = np.minimum(middles, 30.0 - middles) / 30.0
    wanted = top * (np.minimum(rising / ramp, 1.0) if ramp else 1.0)
    inside = slice(20, -20)  # a difference over the rest at the ends is no speed
    assert speeds[inside] == pytest.approx(np.broadcast_to(wanted, speeds.shape)[inside], rel=1e-3)


@pytest.mark.parametrize("ramp", [0.0, 0.2, 0.5])
def test_an_edge_is_even_if_its_speed_is_constant(ramp):
    pace = Pace(30.0, ramp, 10)
    for edge in range(10):
        times = pace.instants(edge + np.linspace(0.0, 1.0, 11))
        steady = np.ptp(np.diff(times)) < 1e-9
        assert pace.is_even(edge) == steady
