"""Speed profiles along a straight run: closed forms, limits, and agreement with Ruckig."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from ruckig import InputParameter, Ruckig, Trajectory

from ffsr_plan.trajectory.profiles import s_curve, trapezoid

sizes = st.floats(-6.0, 6.0).map(lambda power: 10.0**power)


def duration(phases):
    return sum(t for t, *_ in phases)


def end_of(phases, speed=0.0):
    """x and x' at the end."""
    x = 0.0
    for t, acceleration, jerk in phases:
        x += speed * t + acceleration * t**2 / 2.0 + jerk * t**3 / 6.0
        speed += acceleration * t + jerk * t**2 / 2.0
    return x, speed


@given(sizes, sizes, sizes)
def test_rest_to_rest_uses_full_acceleration_speed_and_braking(length, top, push):
    """Bang-bang if the speed limit is not reached, a trapezoid if it is."""
    phases = trapezoid(length, 0.0, 0.0, top, push)
    reached = top**2 < push * length
    best = length / top + top / push if reached else 2.0 * np.sqrt(length / push)
    assert duration(phases) == pytest.approx(best, rel=1e-9)
    x, speed = end_of(phases)
    assert x == pytest.approx(length, rel=1e-9)
    assert abs(speed) <= 1e-9 * push * best


@given(*[st.floats(0.1, 10.0)] * 3, st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_between_any_two_speeds_it_is_as_fast_as_ruckig(length, top, push, first, second):
    begin = first * top
    most, least = (max(begin**2 + sign * 2.0 * push * length, 0.0) ** 0.5 for sign in (1, -1))
    end = min(least + (0.001 + 0.998 * second) * (most - least), top)
    phases = trapezoid(length, begin, end, top, push)
    query, answer = InputParameter(1), Trajectory(1)
    query.current_position, query.target_position = [0.0], [length]
    query.current_velocity, query.target_velocity = [begin], [end]
    query.max_velocity, query.max_acceleration, query.max_jerk = [top], [push], [np.inf]
    Ruckig(1).calculate(query, answer)
    assert duration(phases) == pytest.approx(answer.duration, rel=1e-6)
    x, speed = end_of(phases, begin)
    assert (x, speed) == pytest.approx((length, end), rel=1e-6, abs=1e-6)


@given(sizes, sizes)
def test_a_jerk_limited_duration_is_its_closed_form(length, jerk):
    second = np.cbrt(length / jerk)
    phases = s_curve(length, 1e4 * length / second, 1e7 * length / second**2, jerk)
    assert duration(phases) == pytest.approx(4.0 * np.cbrt(length / (2.0 * jerk)), rel=1e-9)


@given(sizes, sizes, st.floats(0.01, 1.0), st.floats(0.01, 0.99))
def test_an_s_curve_at_its_limits_takes_its_closed_form(length, top, soft, full):
    """L / v + v / a + a / j, where a^2 <= v j, and v^2 / a + v a / j <= L."""
    push = top**2 * (1.0 + soft) / (full * length)
    jerk = push**2 / (top * soft)
    phases = s_curve(length, top, push, jerk)
    assert duration(phases) == pytest.approx(length / top + top / push + push / jerk, rel=1e-9)


@given(sizes, sizes, sizes, sizes)
def test_s_curves_of_any_size_arrive_within_their_limits(length, top, push, jerk):
    phases = s_curve(length, top, push, jerk)
    x, speed = end_of(phases)
    assert x == pytest.approx(length, rel=1e-9)
    assert abs(speed) <= 1e-9 * length / duration(phases)
    speed = 0.0
    for t, acceleration, change in phases:
        speed += acceleration * t + change * t**2 / 2.0
        assert speed <= top * (1.0 + 1e-9)
        assert abs(acceleration) <= push * (1.0 + 1e-9)
        assert abs(change) <= jerk * (1.0 + 1e-9)
    each = length / top, 2.0 * np.sqrt(length / push), 4.0 * np.cbrt(length / (2.0 * jerk))
    assert (1.0 - 1e-9) * max(each) <= duration(phases) <= 1.0001 * sum(each)


@given(sizes, sizes, st.floats(0.0, 10.0))
def test_end_speeds_that_are_just_reachable_need_one_phase(length, push, begin):
    """Ruckig fails here: rounding makes it move back and forth."""
    begin *= np.sqrt(push * length)
    end = np.sqrt(begin**2 + 2.0 * push * length)
    shortest = (end - begin) / push
    for first, last in ((begin, end), (end, begin)):
        phases = trapezoid(length, first, last, 1.1 * end, push)
        assert duration(phases) == pytest.approx(shortest, rel=1e-6)
