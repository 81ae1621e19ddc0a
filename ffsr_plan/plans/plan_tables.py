"""The tables of a plan file: the fields of each, with their types and ranges.

Whole files are described here, so that a missing, unknown or impossible field is refused by its
name, whatever it holds. That the fields agree with one another is the matter of `plan_reading`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.checks import one_of
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Number, OneOf, Rule, Text, Truth, WholeNumber
from ffsr_plan.core.settings import from_mapping, settings
from ffsr_plan.plans.body_entries import BodyTable, DebrisTable
from ffsr_plan.plans.planner_registry import PLANNERS, Planner
from ffsr_plan.plans.shape_entries import ZONE_KINDS, Bodies
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.robots.collision_shapes import CONTAINERS
from ffsr_plan.scene.shapes.obstacle_shapes import SHAPES

FORMAT = "ffsr-plan/3"
_LARGEST = 1e300


@dataclass(frozen=True)
class Columns(Rule):
    """An array of numbers, as nested lists.

    Attributes:
        dimensions: their numbers of axes that are allowed.
        whole: whether the numbers are integers.
        infinite: whether null stands for what is infinite.
        at_least: least number that is allowed.
    """

    dimensions: tuple[int, ...] = (1,)
    whole: bool = False
    infinite: bool = False
    at_least: float = -_LARGEST

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array | IntArray:
        """See `Rule.check`."""
        kinds = {int} if self.whole else {int, float}
        kinds |= {type(None)} if self.infinite else set()
        if not self._consists_of(value, kinds):
            raise InvalidInput(what, value, self._allowed())
        try:
            array = np.array(value, dtype=np.float64)  # None becomes NaN, which no number is
        except (TypeError, ValueError, OverflowError):
            raise InvalidInput(what, value, self._allowed()) from None
        if array.size == 0 and array.ndim < min(self.dimensions):
            array = array.reshape([0] * min(self.dimensions))
        missing = np.isnan(array)
        most = 2.0**53 if self.whole else _LARGEST
        if array.ndim not in self.dimensions or np.any(np.abs(array[~missing]) >= most):
            raise InvalidInput(what, value, self._allowed())
        for first in np.argwhere(array < self.at_least)[:1]:
            place = ".".join(map(str, [what, *first.tolist()]))
            got = array[tuple(first)].item()
            got = int(got) if self.whole else got
            raise InvalidInput(place, got, f"at least {self.at_least:g}")
        if self.whole:
            return frozen(array.astype(np.int64))
        return frozen(np.where(missing, np.inf, array))

    def _consists_of(self, value: object, kinds: set[type]) -> bool:
        """Whether a nested list holds only some types, NaN and infinity excluded."""
        if not isinstance(value, (list, tuple)):
            return False
        if value and isinstance(value[0], (list, tuple)):
            return all(self._consists_of(each, kinds) for each in value)
        return set(map(type, value)) <= kinds and all(each == each for each in value)

    def _allowed(self) -> str:
        numbers = "integers" if self.whole else "finite numbers"
        nesting = " or ".join("a list" if n == 1 else "lists" for n in self.dimensions)
        return f"{nesting} of {numbers}" + (" or null" if self.infinite else "")


@dataclass(frozen=True)
class Meshes(Rule):
    """Corners of meshes (n, 3) by address."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> dict[str, Array]:
        """See `Rule.check`."""
        if not isinstance(value, Mapping):
            raise InvalidInput(what, value, "corners by mesh address")
        found: dict[str, Array] = {}
        for address, corners in value.items():
            array: Any = Columns((2,)).check(f"{what}.{address}", corners, {})
            if array.shape[1] != 3 or not np.all(np.abs(array) <= 1e9):
                allowed = "lists of three numbers of at most 1e9"
                raise InvalidInput(f"{what}.{address}", corners, allowed)
            found[str(address)] = array
        return found


@dataclass(frozen=True)
class AnyValue(Rule):
    """A value that what is made of the table checks."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        return value


@dataclass(frozen=True)
class PlannerTable(Rule):
    """The name and the settings of a planner."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Planner:
        """See `Rule.check`."""
        if not isinstance(value, Mapping):
            raise InvalidInput(what, value, "a table with the name of a planner and its settings")
        table = dict(value)
        name = one_of(f"{what}.name", table.pop("name", None), list(PLANNERS))
        return from_mapping(PLANNERS[name], table)


@settings
class ContainersTable:
    """Which kinds of solids replace meshes and cylinders."""

    meshes: Annotated[str, OneOf(CONTAINERS)]
    cylinders: Annotated[str, OneOf(CONTAINERS)]


@settings
class ReplacementTable:
    """A solid that replaces a shape."""

    link: Annotated[str, Text()]
    number: Annotated[int, WholeNumber(at_least=0)]
    shape: Annotated[str, Text()]
    by: Annotated[str, Text()]
    excess: Annotated[float, Number(at_least=0.0)]


@settings
class RobotTable:
    """A robot, and what it made of its shapes."""

    name: Annotated[str, Text()]
    urdf: Annotated[str, Text()]
    package_dirs: tuple[Annotated[str, Text()], ...]
    srdf: Annotated[str, Text()]
    disabled_pairs: Annotated[Any, AnyValue()]
    containers: ContainersTable
    meshes: Annotated[Any, Meshes()]
    replacements: tuple[ReplacementTable, ...]


@settings
class SceneTable:
    """Obstacles; files of older versions, and of scenes without them, have spheres alone."""

    centers: Annotated[Any, Columns((2,))]
    radii: Annotated[Any, Columns()]
    excess: Annotated[float, Number(at_least=0.0)] = 0.0
    sources: Annotated[Any, AnyValue()] = ()
    shapes: Annotated[Any, Bodies(SHAPES)] = ()
    keep_in: Annotated[Any, Bodies(ZONE_KINDS)] = ()
    growth: Annotated[float, Number(at_least=0.0)] = 0.0
    bodies: tuple[BodyTable, ...] = ()
    debris: tuple[DebrisTable, ...] = ()


@settings
class ProblemTable:
    """A problem; what is not a table of its own is checked by `Problem`."""

    robot: RobotTable
    scene: SceneTable
    start: Annotated[Any, Columns()]
    goal: Annotated[Any, Columns()]
    lattice: Lattice | None
    mode: Annotated[Any, AnyValue()]
    delta: Annotated[Any, AnyValue()]
    length_unit: Annotated[Any, AnyValue()]
    clearance_cap: Annotated[Any, AnyValue()]
    position_weight: Annotated[Any, AnyValue()]
    rotation_weight: Annotated[Any, AnyValue()]
    tolerance: Annotated[Any, AnyValue()]
    reach_attitude: Annotated[Any, AnyValue()]
    window: Annotated[Any, AnyValue()] = None
    min_clearance: Annotated[Any, AnyValue()] = 0.0
    duration: Annotated[Any, AnyValue()] = None
    ramp: Annotated[Any, AnyValue()] = 0.0


@settings
class MotionTable:
    """The corners of a motion."""

    positions: Annotated[Any, Columns((2,))]
    joint_values: Annotated[Any, Columns((2,))] | None
    turn_shares: Annotated[Any, Columns()] | None = None


@settings
class HistoryTable:
    """Progress of a search."""

    best: Annotated[Any, Columns(infinite=True, at_least=0)]
    iteration_best: Annotated[Any, Columns(infinite=True, at_least=0)]
    mean: Annotated[Any, Columns(infinite=True, at_least=0)]
    distinct: Annotated[Any, Columns(whole=True, at_least=1)]


@settings
class TrailsTable:
    """Edges that ants walked."""

    layer: Annotated[Any, Columns(whole=True, at_least=0)]
    tail: Annotated[Any, Columns(whole=True, at_least=0)]
    head: Annotated[Any, Columns(whole=True, at_least=0)]
    ants: Annotated[Any, Columns(whole=True, at_least=1)]
    laid: Annotated[Any, Columns(at_least=0)]
    pheromone: Annotated[Any, Columns(at_least=0)]


@settings
class BranchesTable:
    """Edges of the trees of a search."""

    begin: Annotated[Any, Columns((2,))]
    end: Annotated[Any, Columns((2,))]
    tree: Annotated[Any, Columns(whole=True, at_least=0)]


@settings
class CertificateTable:
    """What was proven; the bound may fall short of zero by rounding, null is infinite."""

    edges_free: Annotated[int, WholeNumber(at_least=0)]
    edges_refused: Annotated[int, WholeNumber(at_least=0)]
    node_queries: Annotated[int, WholeNumber(at_least=0)]
    edge_queries: Annotated[int, WholeNumber(at_least=0)]
    least_clearance: Annotated[float, Number(at_least=-1e-6)] | None


@settings
class FuelTable:
    """Change of velocity of a plan by `LeastFuel`."""

    change: Annotated[float, Number(at_least=0.0)]
    straight: Annotated[float, Number(at_least=0.0)]
    lattice_change: Annotated[float, Number(at_least=0.0)] | None
    lattice_bound: Annotated[float, Number(at_least=0.0)] | None
    margin: Annotated[float, Number(at_least=0.0)]
    start: Annotated[str, Text()]


@settings
class PlanTable:
    """A whole plan file, without its digest."""

    format: Annotated[str, OneOf((FORMAT,))]
    problem: ProblemTable
    planner: Annotated[Any, PlannerTable()]
    seed: Annotated[int, WholeNumber(at_least=0)] | None
    nodes: Annotated[Any, Columns((1, 2), whole=True)]
    motion: MotionTable
    configurations: Annotated[Any, Columns((2,))]
    length: Annotated[float, Number(at_least=0.0)]
    objective: Annotated[float, Number(at_least=0.0)]
    lattice_objective: Annotated[float, Number(at_least=0.0)]
    optimum: Annotated[float, Number(at_least=0.0)]
    optimum_is_exact: Annotated[bool, Truth()]
    clearances: Annotated[Any, Columns(infinite=True)]
    history: HistoryTable
    trails: TrailsTable
    certificate: CertificateTable
    interrupted: Annotated[bool, Truth()]
    seconds: Annotated[float, Number(at_least=0.0)]
    branches: BranchesTable | None = None
    fuel: FuelTable | None = None
