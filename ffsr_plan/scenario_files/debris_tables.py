"""Tables of a scenario file that make clouds of debris."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from ffsr_plan.bodies.debris.debris_cloud import DebrisCloud
from ffsr_plan.core.setting_rules import ByKey, FilePath, Rule
from ffsr_plan.core.settings import settings
from ffsr_plan.scene.shapes.obstacle_shapes import Name


@dataclass(frozen=True)
class SphereColumn(Rule):
    """A number, or a row of numbers, for each sphere; `DebrisCloud` checks them.

    Attributes:
        width: numbers of a row; 0 for plain numbers.
    """

    width: int = 0

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        return value

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        item: dict[str, Any] = {"type": "number"}
        if self.width:
            item = {"type": "array", "items": item, "minItems": self.width, "maxItems": self.width}
        return {"type": "array", "items": item, "minItems": 1}


@settings
class DebrisTable:
    """The table `[[debris]]` of spheres in the file itself.

    Attributes:
        centers: (N, 3) at time zero, world [m].
        radii: (N,) [m].
        velocities: (N, 3) world axes [m/s].
        name: by which errors name the cloud.
    """

    centers: Annotated[Any, SphereColumn(3)]
    radii: Annotated[Any, SphereColumn()]
    velocities: Annotated[Any, SphereColumn(3)]
    name: Name = ""

    def cloud(self, folder: Path) -> DebrisCloud:
        """The cloud; `folder` is not looked at."""
        return DebrisCloud(self.centers, self.radii, self.velocities, self.name)


@settings
class DebrisFileTable:
    """The table `[[debris]]` of a CSV file; see `DebrisCloud.from_csv`.

    Attributes:
        csv: path of the file, relative to the scenario file.
        name: by which errors name the cloud; that of the file by default.
    """

    csv: Annotated[str, FilePath()]
    name: Name = ""

    def cloud(self, folder: Path) -> DebrisCloud:
        """The cloud of the file; its path is relative to `folder`."""
        return DebrisCloud.from_csv(folder / self.csv, self.name or None)


Debris = Annotated[DebrisTable | DebrisFileTable, ByKey(centers=DebrisTable, csv=DebrisFileTable)]
"""A table `[[debris]]`."""
