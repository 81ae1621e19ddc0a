"""The fastest law along a curve by toppra, as an oracle: its limits are linear programmes."""

import numpy as np
import toppra
from toppra.algorithm import TOPPRA
from toppra.constraint import ConstraintType, DiscretizationType, LinearConstraint

toppra.setup_logging("ERROR")


class _Path:
    """What toppra asks of a path whose limits are given as numbers: its interval."""

    def __init__(self, end):
        self.path_interval = np.array([0.0, end])
        self.dof = 1
        self.waypoints = None

    @property
    def duration(self):
        return self.path_interval[1]

    def __call__(self, s, order=0):
        return np.zeros((*np.shape(s), 1))


class _Limits(LinearConstraint):
    """F (a u + b x) <= 1, and x <= highest, at the parameters s."""

    def __init__(self, s, a, b, facets, highest):
        super().__init__()
        self.discretization_type = DiscretizationType.Interpolation
        self.identical = True
        self._format_string = ""
        self.s, self.a, self.b, self.facets, self.highest = s, a, b, facets, highest

    def compute_constraint_params(self, path, gridpoints, *_, **__):
        assert np.array_equal(gridpoints, self.s)
        one, none = np.ones(len(self.facets)), np.zeros_like(self.a)
        xbound = np.column_stack([np.zeros_like(self.highest), self.highest])
        found = self.a, self.b, none, self.facets, one, None, xbound
        if self.discretization_type == DiscretizationType.Interpolation:
            from toppra.constraint.linear_constraint import (
                canlinear_colloc_to_interpolate as interpolated,
            )

            return interpolated(*found[:5], None, xbound, gridpoints, identical=True)
        return found

    def get_constraint_type(self):
        return ConstraintType.CanonicalLinear


def facets_of(discs, lines, sides):
    """(f, 3 D + L) rows of F: a polygon around each disc, in the plane of the first two axes."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    polygon = np.column_stack([np.cos(angles), np.sin(angles)])
    rows = []
    for d in range(discs):
        row = np.zeros((sides, 3 * discs + lines))
        row[:, 3 * d : 3 * d + 2] = polygon  # inside the circle of radius 1 / cos(pi / sides)
        rows.append(row)
    for k in range(lines):
        row = np.zeros((2, 3 * discs + lines))
        row[:, 3 * discs + k] = 1.0, -1.0
        rows.append(row)
    return np.vstack(rows)


def duration_by_toppra(s, wanted, sides=64):
    """Duration [s] of toppra's law under `Demands` at the parameters s (N,), discs in the plane.

    The polygon has as many sides as asked for and contains the disc, so that the law is faster than
    the fastest by up to half of 1 - cos(pi / sides).
    """
    count = wanted.discs.shape[2]
    a, b = (np.hstack([wanted.discs[:, k].reshape(len(s), -1), wanted.lines[:, k]]) for k in (0, 1))
    facets = facets_of(count, wanted.lines.shape[2], sides)
    limits = _Limits(s, a, b, facets, np.minimum(wanted.highest, 1e6))
    law = TOPPRA([limits], _Path(s[-1]), gridpoints=s, solver_wrapper="seidel")
    _, speeds, _, _ = law.compute_parameterization(0.0, 0.0, return_data=True)
    return float(np.sum(2.0 * np.diff(s) / (speeds[1:] + speeds[:-1])))
