"""Compiled integration of a rigid body that no torque acts on.

Euler's equations I w' = (I w) x w are integrated by the classical Runge-Kutta method, twice in each
step, and the attitude by fourth-order Magnus steps from the rates at begin, middle and end:

    R <- R exp( h/6 (w0 + 4 w1 + w2) + h^2/12 w0 x w2 )
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.quaternions import turn_by


@kernel
def _change(moments: Array, rate: Array, step: float, slope: Array, into: Array) -> None:
    """`into` = slope of the rates at `rate` + `step` * `slope`; `into` may be `slope`."""
    x, y, z = rate[0] + step * slope[0], rate[1] + step * slope[1], rate[2] + step * slope[2]
    a, b, c = moments[0], moments[1], moments[2]
    into[0] = (b - c) / a * y * z
    into[1] = (c - a) / b * z * x
    into[2] = (a - b) / c * x * y


@kernel
def advance_rates(moments: Array, rate: Array, step: float, slopes: Array) -> None:
    """Advance the rates (3,) by a time step.

    Args:
        moments: (3,) principal moments of inertia [kg m^2].
        rate: (3,) along the principal axes [rad/s]; changed.
        step: [s].
        slopes: (5, 3) memory, its last row zeros.
    """
    first, second, third, fourth, none = slopes
    _change(moments, rate, 0.0, none, first)
    _change(moments, rate, 0.5 * step, first, second)
    _change(moments, rate, 0.5 * step, second, third)
    _change(moments, rate, step, third, fourth)
    for a in range(3):
        rate[a] += step / 6.0 * (first[a] + 2.0 * (second[a] + third[a]) + fourth[a])


@kernel
def tumble(moments: Array, rate: Array, attitude: Array, steps: Array) -> tuple[Array, Array]:
    """Rates and attitudes after each of some time steps.

    Args:
        moments: (3,) principal moments of inertia [kg m^2].
        rate: (3,) at the begin, along the principal axes [rad/s].
        attitude: (4,) of the principal axes at the begin.
        steps: (n,) lengths [s].

    Returns:
        (n + 1, 3) rates [rad/s], and (n + 1, 4) attitudes.
    """
    count, spare, slopes = len(steps), np.empty(4), np.zeros((5, 3))
    rates, attitudes = np.empty((count + 1, 3)), np.empty((count + 1, 4))
    now, middle, quat = rate.copy(), np.empty(3), attitude.copy()
    rates[0], attitudes[0] = now, quat
    for k in range(count):
        step = steps[k]
        x, y, z = now[0], now[1], now[2]
        advance_rates(moments, now, 0.5 * step, slopes)
        middle[:] = now
        advance_rates(moments, now, 0.5 * step, slopes)
        one, two = step / 6.0, step * step / 12.0
        turn_by(
            quat,
            one * (x + 4.0 * middle[0] + now[0]) + two * (y * now[2] - z * now[1]),
            one * (y + 4.0 * middle[1] + now[1]) + two * (z * now[0] - x * now[2]),
            one * (z + 4.0 * middle[2] + now[2]) + two * (x * now[1] - y * now[0]),
            spare,
        )
        rates[k + 1], attitudes[k + 1] = now, quat
    return rates, attitudes
