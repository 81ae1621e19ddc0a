"""Uniform cubic B-splines in Bernstein form.

Piece i belongs to edge i of the control polygon. A phantom control point beyond each end is the
reflection of the second one at the first, so that the curve begins and ends at the polygon's ends,
without curvature there. Control points in equal steps on a line give that line, run steadily.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_banded

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.curves.kernels.pieces import BENDS, RATES, ROWS, TURN, VALUES, Pieces


def bernstein_pieces(control: Array) -> Array:
    """Bernstein coefficients of the B-spline's pieces.

    Args:
        control: (m + 1, k) control points.

    Returns:
        (m, 4, k) coefficients; the last of a piece is the first of the next, bit for bit.
    """
    knots = control.copy()
    step = np.diff(control, axis=0)  # by differences: what does not move stays as it is
    knots[1:-1] += np.diff(step, axis=0) / 6.0
    return np.stack(
        [knots[:-1], control[:-1] + step / 3.0, control[1:] - step / 3.0, knots[1:]], axis=1
    )


def derivative(coefficients: Array) -> Array:
    """Bernstein coefficients (m, d, k) of the derivative of pieces (m, d + 1, k) of degree d."""
    degree = coefficients.shape[1] - 1
    steps: Array = degree * np.diff(coefficients, axis=1)
    return steps


def pieces_with(control: Array, turn: Array) -> Pieces:
    """The pieces of a curve.

    Args:
        control: (m + 1, D) control points, columns as in `Pieces`.
        turn: (3,) rotation by wheels from start to goal, base axes [rad].
    """
    return pieces_of(bernstein_pieces(control), turn)


def pieces_of(values: Array, turn: Array) -> Pieces:
    """The pieces with given coefficients.

    Args:
        values: (m, 4, D) Bernstein coefficients, columns as in `Pieces`.
        turn: (3,) rotation by wheels from start to goal, base axes [rad].
    """
    rows = np.zeros((len(values), ROWS, values.shape[2]))
    rows[:, VALUES:RATES] = values
    rows[:, RATES:BENDS] = rates = derivative(values)
    rows[:, BENDS:TURN] = derivative(rates)
    rows[:, TURN, :3] = turn
    return Pieces(rows)


def evaluate(coefficients: Array, piece: IntArray, time: Array) -> Array:
    """Values of pieces, by de Casteljau's scheme.

    Args:
        coefficients: (m, d + 1, k) in Bernstein form.
        piece: (N,) pieces.
        time: (N,) times on them, in [0, 1].

    Returns:
        (N, k) values.
    """
    left, t = coefficients[piece], time[:, None, None]
    while left.shape[1] > 1:
        left = (1.0 - t) * left[:, :-1] + t * left[:, 1:]
    values: Array = left[:, 0]
    return values


def control_points_through(nodes: Array) -> Array:
    """Control points (m + 1, k) of the B-spline whose knots are the given nodes (m + 1, k)."""
    control = nodes.copy()
    inner = 6.0 * nodes[1:-1]
    if len(inner):
        inner[0] -= nodes[0]
        inner[-1] -= nodes[-1]
        bands = np.repeat([[1.0], [4.0], [1.0]], len(inner), axis=1)
        control[1:-1] = solve_banded((1, 1), bands, inner)
    return control
