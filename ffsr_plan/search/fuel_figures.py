"""`FuelFigures`: what a path of least fuel needs, and how far above a lattice's least it may be."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array


class FuelFigures(NamedTuple):
    """Changes of velocity for a flight of unit duration at constant pace [m].

    Divided by a duration they are a delta-v [m/s]. The change of velocity of a polygon of m equal
    times, and an upper bound on that of the smooth curve that it draws, is

        m (|e_1| + sum |e_t - e_(t-1)| + |e_m|),

    e_t the steps of the base: to set off, to turn, and to come to rest.

    Attributes:
        change: of the plan's motion.
        straight: of the straight line, which no path falls below.
        lattice_change: of the best path found on the planner's lattice, which kept the margin;
            None where that lattice has none.
        lattice_bound: that no path of that lattice falls below, `lattice_change` where it is the
            least; None without a path.
        margin: clearance that is kept and proven [m].
        start: what the motion was refined from: `pair-programme` or `lattice-optimum`.
    """

    change: float
    straight: float
    lattice_change: float | None
    lattice_bound: float | None
    margin: float
    start: str

    @property
    def gap(self) -> float | None:
        """(lattice_change - lattice_bound) / lattice_bound: 0 where the lattice path is the best.

        None where the lattice has no path. It says nothing about paths off that lattice; `change`
        may be below the bound.
        """
        if self.lattice_change is None or self.lattice_bound is None:
            return None
        return self.lattice_change / self.lattice_bound - 1.0

    def delta_v(self, duration: float) -> float:
        """Change of velocity for a flight at constant pace [m/s].

        Args:
            duration: of the flight [s].
        """
        return self.change / duration


def velocity_change(positions: Array) -> float:
    """Change of velocity along a polygon of equal times, from rest to rest.

    Args:
        positions: (m + 1, 3) its corners [m], one edge at least.

    Returns:
        That for a flight of unit duration [m], see `FuelFigures`.
    """
    steps = np.diff(positions, axis=0)
    turns = np.linalg.norm(np.diff(steps, axis=0), axis=1)
    ends = np.linalg.norm(steps[[0, -1]], axis=1)
    return len(steps) * float(turns.sum() + ends.sum())
