"""The planners that search a lattice: by name, and the default for a lattice."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.settings import from_mapping
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.search.ants.ant_system import AntSystem
from ffsr_plan.search.ants.max_min import MaxMinAntSystem
from ffsr_plan.search.optimum_planner import LatticeOptimum
from ffsr_plan.search.postures.posture_annealing import PostureAnnealing

OnLattice = AntSystem | MaxMinAntSystem | LatticeOptimum | PostureAnnealing
LATTICE_PLANNERS: dict[str, type[OnLattice]] = {
    kind.name: kind for kind in (AntSystem, MaxMinAntSystem, LatticeOptimum, PostureAnnealing)
}


def default_on_lattice(lattice: Lattice) -> OnLattice:
    """`PostureAnnealing` with posture axes, `LatticeOptimum` with progress, else ants."""
    if lattice.progress is not None:
        return LatticeOptimum()
    return PostureAnnealing() if lattice.postures else MaxMinAntSystem()


class ByName:
    """The annotation of a field for one of `LATTICE_PLANNERS`; tables have the key `name`."""

    def planner(self, value: object) -> object:
        """The planner of a table.

        Raises:
            InvalidInput: an unknown name, or a setting that the planner does not have.
        """
        if isinstance(value, tuple(LATTICE_PLANNERS.values())):
            return value
        if not isinstance(value, Mapping):
            names = " or ".join(f"{kind.__name__}()" for kind in LATTICE_PLANNERS.values())
            raise InvalidInput("", value, names)
        given = dict(value)
        name = one_of(".name", given.pop("name", None), list(LATTICE_PLANNERS))
        return from_mapping(LATTICE_PLANNERS[name], given)

    def __get_pydantic_core_schema__(self, source: object, handler: Callable[[Any], Any]) -> Any:  # noqa: ANN401
        from pydantic_core import core_schema

        kinds = [handler.generate_schema(kind) for kind in LATTICE_PLANNERS.values()]  # type: ignore[attr-defined]
        return core_schema.no_info_before_validator_function(
            self.planner, core_schema.union_schema(kinds)
        )

    def __get_pydantic_json_schema__(self, schema: object, handler: Any) -> dict[str, Any]:  # noqa: ANN401
        union: dict[str, Any] = handler(schema)
        for name, entry in zip(LATTICE_PLANNERS, union["anyOf"], strict=True):
            table = handler.resolve_ref_schema(entry)
            table["properties"]["name"] = {"type": "string", "enum": [name]}
            table["required"] = ["name"]
        return union
