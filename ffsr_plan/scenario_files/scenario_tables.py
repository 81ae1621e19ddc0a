"""The tables of a scenario file as a pydantic schema: keys, types and defaults."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, JsonValue

from ffsr_plan.dynamics.mode import Mode
from ffsr_plan.plans.planners import PLANNERS
from ffsr_plan.robots.collision_shapes import CONTAINERS
from ffsr_plan.search.ants.max_min import MaxMinAntSystem

Number = Annotated[float, Field(allow_inf_nan=False)]
Triple = Annotated[list[Number], Field(min_length=3, max_length=3)]


Pair = Annotated[list[Number], Field(min_length=2, max_length=2)]


class Table(BaseModel):
    """What all tables share: no key beyond those listed, no conversion between types."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, use_attribute_docstrings=True
    )


def _one_of(names: Iterable[str]) -> Any:  # noqa: ANN401 - what pydantic takes
    """Names for the exported schema; `inputs.one_of` checks them, with a suggestion."""
    return Field(json_schema_extra={"enum": list(names)})


OBSTACLES = {"center": ["radius"], "csv": [], "numpy": [], "mesh": ["excess"]}
"""What an obstacle is made from, and what has to be given as well."""
OF_A_MESH = ("scale", "position", "attitude", "inside")
_NEEDED_KEYS: list[JsonValue] = [{"required": [first, *rest]} for first, rest in OBSTACLES.items()]


class RobotTable(Table):
    """The table `[robot]`."""

    urdf: str
    """Name of a bundled robot, or a path relative to the scenario file."""
    mode: Annotated[str, _one_of([mode.value for mode in Mode])] = "free-flying"
    """What moves the base."""
    package_dirs: list[str] = []
    srdf: str | None = None
    """Path of an SRDF, relative to the scenario file."""
    meshes: Annotated[str, _one_of(CONTAINERS)] = "hull"
    cylinders: Annotated[str, _one_of(CONTAINERS)] = "hull"


class PoseTable(Table):
    """The table `[start]`."""

    position: Triple = [0.0, 0.0, 0.0]
    attitude: Triple = [0.0, 0.0, 0.0]
    """ZYX angles alpha, beta, gamma [rad]."""
    joints: dict[str, Number] = {}
    """Joints that are not named are at zero."""


class EndEffectorTable(Table):
    """The table `end_effector` of `[goal]`."""

    frame: str
    """Name of a link, joint or other frame of the robot."""
    position: Triple
    """Of the frame's origin, world [m]."""
    attitude: Triple | None = None
    """ZYX angles of the frame [rad]; any will do if not given."""
    seed: int = 0


class GoalTable(Table):
    """The table `[goal]`."""

    position: Triple | None = None
    """At the world's origin if not given; not to be given in the mode free-floating."""
    attitude: Triple | None = None
    joints: dict[str, Number] = {}
    end_effector: EndEffectorTable | None = None
    """Instead of joints: they follow by inverse kinematics."""


class ObstacleTable(Table):
    """The table `[[obstacles]]`: a sphere (`center`, `radius`), a file of spheres or a mesh."""

    model_config = ConfigDict(json_schema_extra={"oneOf": _NEEDED_KEYS})

    center: Triple | None = None
    radius: Number | None = None
    csv: str | None = None
    """A table of x, y, z and radius; like all paths relative to the scenario file."""
    numpy: str | None = None
    """A .npy file, (N, 4), or a .npz file with centers and radii."""
    mesh: str | None = None
    """A .stl, .obj, .dae or .ply file; `excess` has to be given."""
    excess: Number | None = None
    """How far spheres may reach beyond the mesh [m]."""
    scale: Number | None = None
    position: Triple | None = None
    attitude: Triple | None = None
    inside: bool | None = None
    """False to cover the surface of the mesh alone."""


class CloudTable(Table):
    """The table `[[clouds]]`: spheres drawn from a seed."""

    seed: int
    count: int
    low: Triple
    high: Triple
    radii: Pair
    spared: Number = 0.0
    """No sphere comes nearer than this to the base at start or goal [m]."""


class BeltTable(Table):
    """The table `[[belts]]`: debris in a ring, drawn from a seed; see `generators.belt`."""

    seed: int
    count: int
    radius: Number
    thickness: Number
    radii: Pair
    center: Triple = [0.0, 0.0, 0.0]
    attitude: Triple = [0.0, 0.0, 0.0]
    arc: Pair = [0.0, 2.0 * math.pi]
    spared: Number = 0.0
    """No sphere comes nearer than this to the base at start or goal [m]."""


class ScatterTable(Table):
    """The table `[[scatters]]`: a few spheres in the xy-plane; see `generators.scatter`."""

    seed: int
    counts: Annotated[list[int], Field(min_length=2, max_length=2)]
    low: Pair
    high: Pair
    radii: Pair


class TrussTable(Table):
    """The table `[[trusses]]`: a boom of struts; see `generators.truss`."""

    begin: Triple
    end: Triple
    width: Number
    bays: int
    radius: Number
    roll: Number = 0.0


class GateTable(Table):
    """The table `[[gates]]`: two spheres with a gap between them; see `generators.gate`."""

    along: Number
    aside: Number
    opening: Number
    radius: Number


class AxisTable(Table):
    """The tables `lateral` and `normal`."""

    half_count: int
    spacing: Number


class PostureTable(Table):
    """An entry of `postures`: `towards` and `levels`, or `joints`, `half_count` and `spacing`."""

    towards: str | None = None
    levels: int | None = None
    joints: dict[str, Number] | None = None
    half_count: int | None = None
    spacing: Number | None = None


class LatticeTable(Table):
    """The table `[lattice]`."""

    divisions: int = 40
    lateral: AxisTable | None = None
    normal: AxisTable | None = None
    postures: list[PostureTable] = []


class ObjectiveTable(Table):
    """The table `[objective]`."""

    delta: Number = 0.0
    length_unit: Number = 1.0
    clearance_cap: Number | None = None
    position_weight: Number = 1.0
    rotation_weight: Number = 1.0


class PlannerTable(Table):
    """The table `[planner]`: what is not given stays at the planner's default."""

    name: Annotated[str, _one_of(PLANNERS)] = MaxMinAntSystem.name
    seed: int = 0
    refine: bool = True
    ants: int | None = None
    cycles: int | None = None
    alpha: Number | None = None
    beta: Number | None = None
    rho: Number | None = None
    Q: Number | None = None
    C: Number | None = None
    improved: int | None = None
    patience: int | None = None
    cost_aware: bool | None = None
    pheromone: bool | None = None


class ScenarioFile(Table):
    """A whole scenario file."""

    title: str = ""
    robot: RobotTable
    start: PoseTable = PoseTable()
    goal: GoalTable
    obstacles: list[ObstacleTable] = []
    clouds: list[CloudTable] = []
    belts: list[BeltTable] = []
    scatters: list[ScatterTable] = []
    trusses: list[TrussTable] = []
    gates: list[GateTable] = []
    lattice: LatticeTable
    objective: ObjectiveTable = ObjectiveTable()
    planner: PlannerTable = PlannerTable()


def schema() -> dict[str, Any]:
    """The JSON Schema of scenario files, by which editors complete and check them.

    It knows tables, keys, types and names; numbers and combinations are checked by `read_scenario`.
    """
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **ScenarioFile.model_json_schema(),
        "title": "ffsr-plan scenario",
    }
