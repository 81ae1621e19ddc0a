"""`Scene`: the obstacles, spheres at rest in the world."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.errors import InvalidInput
from ffsr_plan.inputs import FARTHEST, Array, finite_array
from ffsr_plan.sphere_tree import SphereTree, sphere_tree


@dataclass(frozen=True, eq=False, init=False)
class Scene:
    """Sphere obstacles.

    Attributes:
        centers: (N, 3) centres in the world [m].
        radii: (N,) radii [m], greater than zero.
    """

    centers: Array
    radii: Array

    def __init__(self, centers: ArrayLike = (), radii: ArrayLike = ()) -> None:
        """Check and freeze the obstacles; N = 0 is an empty scene.

        Raises:
            InvalidInput: shapes that do not fit, not finite, or a radius <= 0, with its index.
        """
        if np.size(centers) == 0:  # so that [] will do for "no obstacle"
            centers = np.zeros((0, 3))
        c = finite_array("scene centers", centers, (-1, 3), FARTHEST)
        r = finite_array("scene radii", radii, (-1,))
        if len(c) != len(r):
            raise InvalidInput(
                "scene radii", f"{len(r)} radii", f"one for each of {len(c)} centers"
            )
        for i in np.flatnonzero(r <= 0.0)[:1]:
            raise InvalidInput(f"scene radii[{i}]", float(r[i]), "greater than 0 m")
        object.__setattr__(self, "centers", c)
        object.__setattr__(self, "radii", r)

    @cached_property
    def tree(self) -> SphereTree:
        """The spheres as a tree, built when it is first needed."""
        return sphere_tree(self.centers, self.radii)

    def __len__(self) -> int:
        return len(self.radii)
