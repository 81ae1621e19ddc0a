"""Tables of a scenario file that make bodies that move, and the pace of the robot among them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from ffsr_plan.bodies.body_motion import BodyMotion, Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.track import Track
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import ByKey, FilePath
from ffsr_plan.core.settings import part_of, setting, settings
from ffsr_plan.problem.problem import Problem
from ffsr_plan.scenario_files.obstacle_tables import Obstacle
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Name, ObstacleShape, Place, Turn

_MOTIONS = ("drift", "spin", "tumble", "track")


@settings
class TrackFileTable:
    """The table `track` of a motion in a file; see `Track.from_csv`.

    Attributes:
        csv: path of the file, relative to the scenario file.
    """

    csv: Annotated[str, FilePath()]


@settings
class BodyTable:
    """The table `[[bodies]]`: a body that moves, by one of drift, spin, tumble and track.

    Attributes:
        shapes: its shapes along its own axes, each like a table `[[obstacles]]`.
        name: by which errors name it.
        position: (3,) of its reference point at time zero, world [m]; none with a track.
        attitude: of its axes at time zero: (3,) ZYX angles [rad], or (4,) quaternion (x, y, z, w).
        drift: uniform translation.
        spin: rotation at a constant rate.
        tumble: free rotation about the centre of mass.
        track: poses in the world at given times, or a file of them.
    """

    shapes: tuple[Obstacle, ...]
    name: Name = ""
    position: Place = setting(default=(0.0, 0.0, 0.0))
    attitude: Turn = setting(default=(0.0, 0.0, 0.0, 1.0))
    drift: Drift | None = None
    spin: Spin | None = None
    tumble: Tumble | None = None
    track: Annotated[Track | TrackFileTable, ByKey(times=Track, csv=TrackFileTable)] | None = None

    def __post_init__(self) -> None:
        given = [name for name in _MOTIONS if getattr(self, name) is not None]
        if len(given) != 1:
            found = ", ".join(given) or "no motion"
            raise InvalidInput("", found, f"one of {', '.join(_MOTIONS)}")

    def body(self, folder: Path) -> MovingBody:
        """The body; paths are relative to `folder`."""
        shapes = list[ObstacleShape]()
        for table in self.shapes:
            made = table.scene(folder)
            shapes += made.shapes
            shapes += map(Ball, made.radii.tolist(), made.centers)
        return MovingBody(shapes, self._motion(folder), self.position, self.attitude, self.name)

    def _motion(self, folder: Path) -> BodyMotion:
        (motion,) = (found for name in _MOTIONS if (found := getattr(self, name)) is not None)
        if isinstance(motion, TrackFileTable):
            return Track.from_csv(folder / motion.csv)
        return motion


if TYPE_CHECKING:
    PaceTable = Any
else:
    PaceTable = part_of(
        Problem, "PaceTable", "The table `[pace]`, where bodies move.", ("duration", "ramp")
    )
