"""The layered lattice: path frame, layers, nodes and their configurations (Eqs. 2 to 5)."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.rotations import level_direction
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.memory_estimate import check_lattice
from ffsr_plan.problem.problem import Problem


def path_frame(travel: Array) -> Array:
    """Sigma_B as a rotation matrix (3, 3), columns x', y', z' in world axes (Eq. 3).

    z' points along `travel` (3,), x' is lateral, y' = z' x x' normal. The paper is planar and
    leaves x' open; here it lies in the world's xy-plane, so that motions in that plane have y' = z.
    Along the world's z axis, x' is the world's x.
    """
    z = travel / np.linalg.norm(travel)
    y = np.cross(z, level_direction(z))
    y /= np.linalg.norm(y)
    return np.column_stack([np.cross(y, z), y, z])


class LayeredLattice:
    """All nodes of a problem's lattice; built and inspected without running any ant.

    A node is (layer i, node j). Every layer has the same n offsets; layers 0 and m consist of the
    node without offset, `origin`, alone. Attitude and joints are the same for all nodes of a layer.

    Attributes:
        problem: what the lattice was built from.
        indices: (n, axes) offset index of each node along each axis, 0 = no offset.
        offsets: (n, 3) displacement of the base from the nominal position, world axes [m].
        origin: index j of the node without offset.
        directions: (axes, 3) unit vectors of the axes, world axes.
        nominal: the motion through the nodes without offset.
    """

    def __init__(self, problem: Problem) -> None:
        check_lattice(problem)
        self.problem = problem
        lattice = problem.given_lattice
        axes = [getattr(lattice, name) for name in lattice.axes]
        counts = [np.arange(-a.half_count, a.half_count + 1) for a in axes]
        grids = np.meshgrid(*counts, indexing="ij")
        self.indices: IntArray = (
            np.stack([g.ravel() for g in grids], axis=1)
            if axes
            else (np.zeros((1, 0), dtype=np.int64))
        )
        self.indices.setflags(write=False)
        self.origin = len(self.indices) // 2
        if axes:
            columns = {"lateral": 0, "normal": 1}
            frame = path_frame(problem.base_displacement)
            self.directions = frozen(np.array([frame[:, columns[name]] for name in lattice.axes]))
            spacing = np.array([a.spacing for a in axes])
            self.offsets = frozen((self.indices * spacing) @ self.directions)
        else:
            self.directions = frozen(np.zeros((0, 3)))
            self.offsets = frozen(np.zeros((1, 3)))
        progress = np.arange(lattice.divisions + 1) / lattice.divisions
        along = problem.start[:3] + progress[:, None] * problem.base_displacement
        along[-1] = problem.start[:3] + problem.base_displacement
        self.nominal = Motion(problem.robot, problem.mode, problem.start, problem.goal, along)

    @property
    def divisions(self) -> int:
        """m, the number of edges of a path."""
        return self.problem.given_lattice.divisions

    @property
    def size(self) -> int:
        """n, the number of nodes of an inner layer."""
        return len(self.offsets)

    @cached_property
    def steps(self) -> Array:
        """(n, n) length d_pq of the edges between two layers [m], Eq. 6: only offsets differ."""
        across = self.distances * self.problem.position_weight
        return frozen(np.sqrt(self.problem.delta_d**2 + across**2))

    @cached_property
    def distances(self) -> Array:
        """(n, n) distance between the offsets of two nodes [m]."""
        return frozen(np.linalg.norm(self.offsets[:, None] - self.offsets[None], axis=2))

    @cached_property
    def base_travel(self) -> Array:
        """(n, n) distance that the base origin covers over an edge [m]."""
        step = self.problem.base_displacement / self.divisions
        apart = self.offsets[None] - self.offsets[:, None]
        return frozen(np.linalg.norm(step + apart, axis=2))

    def layer(self, i: int) -> Array:
        """(n, nq) configurations of all offsets on layer i."""
        return self.problem.robot.assemble(
            self.nominal.positions[i] + self.offsets,
            self.nominal.attitudes[i],
            self.nominal.joint_values[i],
        )

    def indices_along(self, path: IntArray) -> IntArray:
        """Offset indices along a path (m + 1,): (m + 1,), or (m + 1, axes) with several."""
        indices = self.indices[path]
        return frozen(indices if indices.shape[1] > 1 else indices.sum(axis=1))

    def motion(self, path: IntArray) -> Motion:
        """The motion through node `path[i]` of each layer i, (m + 1,)."""
        return self.nominal.displaced(self.offsets[path])
