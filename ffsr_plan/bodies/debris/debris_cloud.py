"""A cloud of debris: spheres, each of which drifts at a velocity of its own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.bodies.debris.debris_files import read_debris, write_debris
from ffsr_plan.core.arrays import Array, content
from ffsr_plan.core.checks import FARTHEST, finite_array, number, text
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import counted


@dataclass(frozen=True, eq=False, init=False)
class DebrisCloud:
    """Spheres that drift, thousands of them as one group. They do not see one another.

    Attributes:
        centers: (N, 3) centres at time zero, world [m].
        radii: (N,) radii [m], greater than zero.
        velocities: (N, 3) constant velocities, world axes [m/s].
        name: by which errors name it, with the number of a sphere in it.
    """

    word: ClassVar[str] = "debris cloud"

    centers: Array
    radii: Array
    velocities: Array
    name: str

    def __init__(
        self, centers: ArrayLike, radii: ArrayLike, velocities: ArrayLike, name: str = ""
    ) -> None:
        """Check the spheres and make them read-only.

        Args:
            centers: (N, 3) centres at time zero, world [m].
            radii: (N,) radii [m].
            velocities: (N, 3) world axes [m/s].
            name: by which errors name it.

        Raises:
            InvalidInput: no spheres, arrays that do not fit, a number that is not finite, or a
                radius <= 0; with the number of the sphere.
        """
        own = text("name", name)
        of = f"debris cloud '{own}', " if own else "debris cloud, "
        c = finite_array(f"{of}centers", centers, (-1, 3), FARTHEST, "sphere")
        r = finite_array(f"{of}radii", radii, (-1,), row="sphere")
        v = finite_array(f"{of}velocities", velocities, (-1, 3), FARTHEST, "sphere")
        if not len(c):
            raise InvalidInput(f"{of}centers", "none", "at least one sphere")
        for what, rows in (("radii", r), ("velocities", v)):
            if len(rows) != len(c):
                allowed = f"one for each of {len(c)} centers"
                raise InvalidInput(f"{of}{what}", f"{len(rows)} {what}", allowed)
        for k in np.flatnonzero(r <= 0.0)[:1]:
            raise InvalidInput(f"{of}radii, sphere {k}", float(r[k]), "greater than 0 m")
        object.__setattr__(self, "centers", c)
        object.__setattr__(self, "radii", r)
        object.__setattr__(self, "velocities", v)
        object.__setattr__(self, "name", own)

    @classmethod
    def from_csv(cls, path: str | Path, name: str | None = None) -> DebrisCloud:
        """Read a comma-separated table with the columns x, y, z, radius, vx, vy and vz.

        Args:
            path: the file. A header such as `x [mm]` or `vx [mm/s]` gives a unit (m, cm, mm, km;
                the same per second); the default is metres, and metres per second.
            name: of the cloud; that of the file by default.

        Raises:
            InvalidInput: names file, line, column and value, or the sphere.
        """
        centers, radii, velocities = read_debris(path)
        return cls(centers, radii, velocities, Path(path).name if name is None else name)

    def to_csv(self, path: str | Path) -> None:
        """Write a table that `from_csv` reads again bit for bit.

        Args:
            path: the file, replaced if it exists.

        Raises:
            InvalidInput: a path that cannot be written.
        """
        write_debris(path, self.centers, self.radii, self.velocities)

    def centers_at(self, time: float) -> Array:
        """Where the spheres are at a time.

        Args:
            time: [s], not negative.

        Returns:
            (N, 3) centres, world [m].
        """
        return np.asarray(self.centers + number("time", time, at_least=0.0) * self.velocities)

    def later(self, time: float) -> DebrisCloud:
        """The same spheres from a later instant on.

        Args:
            time: [s], which becomes time zero.
        """
        return DebrisCloud(self.centers_at(time), self.radii, self.velocities, self.name)

    @property
    def speed(self) -> float:
        """Speed of the fastest sphere [m/s]."""
        return float(np.linalg.norm(self.velocities, axis=1).max())

    def __len__(self) -> int:
        """Number of spheres."""
        return len(self.radii)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, DebrisCloud):
            return NotImplemented
        return self._content() == other._content()

    def __hash__(self) -> int:
        return hash(self._content())

    def _content(self) -> object:
        return content((self.centers, self.radii, self.velocities, self.name))

    def __repr__(self) -> str:
        name = f"{self.name!r}, " if self.name else ""
        return f"DebrisCloud({name}{counted(len(self), 'sphere')}, at most {self.speed:.3g} m/s)"
