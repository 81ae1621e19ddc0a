"""Number of distance queries of the colony on lattices with posture axes.

The kernels are compiled anew from their own source, in this process alone, with a `clearance_at`
that adds one behind the kinds of the shapes each time it is asked. Paths stay the same bit for
bit; times grow by about a fifth. Only `counting_ground` may then make the ground that they walk on.
"""

import numpy as np
from numba import njit
from numba.core.dispatcher import Dispatcher

from ffsr_plan.search.postures import annealing_kernels, colony, cost_kernels, walk_kernels
from ffsr_plan.search.postures.cost_kernels import Ground
from ffsr_plan.search.postures.posture_lattice import PostureLattice

_MODULES = (cost_kernels, walk_kernels, annealing_kernels, colony)


def count_queries() -> None:
    """From now on, all kernels of the colony count."""
    plain = cost_kernels.clearance_at

    @njit
    def clearance_at(obstacles, *node):
        obstacles.kinds[-1] += 1
        return plain(obstacles, *node)

    kernels = {k for module in _MODULES for k in vars(module).values() if isinstance(k, Dispatcher)}
    anew = {k: clearance_at if k is plain else njit(k.py_func) for k in kernels}
    for module in _MODULES:
        for name, value in list(vars(module).items()):
            if isinstance(value, Dispatcher):
                setattr(module, name, anew[value])


def counting_ground(lattice: PostureLattice) -> Ground:
    """As `ground_of`, with room for the count."""
    ground = colony.ground_of(lattice)
    kinds = np.append(ground.obstacles.kinds, 0)
    return ground._replace(obstacles=ground.obstacles._replace(kinds=kinds))


def queries(ground: Ground) -> int:
    """How many distances were asked for on this ground so far."""
    return int(ground.obstacles.kinds[-1])
