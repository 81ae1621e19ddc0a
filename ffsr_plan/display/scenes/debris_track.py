"""Debris at the times of a picture's frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ffsr_plan.bodies.debris.debris_cloud import DebrisCloud
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.scene.scene import Scene


class DebrisTrack(NamedTuple):
    """The debris of a scene at the times of N frames; of a scene without any, no spheres.

    Attributes:
        clouds: the debris.
        times: (N,) [s].
    """

    clouds: Sequence[DebrisCloud]
    times: Array

    @property
    def radii(self) -> Array:
        """(k,) radii of all spheres [m]."""
        return np.concatenate([np.zeros(0), *(cloud.radii for cloud in self.clouds)])

    @property
    def velocities(self) -> Array:
        """(k, 3) velocities of all spheres [m/s]."""
        return np.concatenate([np.zeros((0, 3)), *(cloud.velocities for cloud in self.clouds)])

    def centers(self, row: int) -> Array:
        """(k, 3) centres of all spheres in one frame, world [m]."""
        each = [cloud.centers_at(float(self.times[row])) for cloud in self.clouds]
        return np.concatenate([np.zeros((0, 3)), *each])

    def corners(self) -> Array:
        """(n, 3) centres in the first and the last frame, between which all others are [m]."""
        if not self.clouds:
            return np.zeros((0, 3))
        return np.concatenate([self.centers(0), self.centers(-1)])

    def __bool__(self) -> bool:
        """Whether there are spheres."""
        return bool(self.clouds)


def debris_track(scene: Scene, times: Array | None) -> DebrisTrack:
    """The debris of a scene at the times of frames.

    All pictures of scenes with debris ask for it, so that none draws it as if at rest.

    Args:
        scene: the obstacles.
        times: (N,) times of the frames [s]; None if they have none.

    Raises:
        InvalidInput: there is debris and there are no times.
    """
    if times is None and scene.debris:
        raise InvalidInput("times", None, "a time [s] of each frame, as debris of the scene moves")
    return DebrisTrack(scene.debris, np.zeros(1) if times is None else np.asarray(times))
