"""The table `[planner]` of a scenario file: a settings class for each planner."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Annotated, Any, ClassVar

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Truth, WholeNumber
from ffsr_plan.core.settings import from_mapping, part_of, settings
from ffsr_plan.plans.planner_registry import PLANNERS, Planner, default_planner
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.problem.posture_axes import PostureTarget


@settings
class PlannerTable:
    """The table `[planner]`; without a name, the default planner of the lattice runs.

    Attributes:
        seed: of the random numbers.
        refine: whether to move the path off the lattice after the search; without it, on every
            lattice without posture axes.
    """

    kind: ClassVar[type[Planner] | None] = None

    seed: Annotated[int, WholeNumber()] = 0
    refine: Annotated[bool, Truth()] | None = None

    def planner(self) -> Planner | None:
        """The planner, or None for the default of the lattice."""
        if self.kind is None:
            return None
        return self.kind(**{name: getattr(self, name) for name in _names(self.kind)})


def _names(kind: type[Planner | PlannerTable]) -> list[str]:
    return [each.name for each in fields(kind)]


PLANNER_TABLES: dict[str, type[PlannerTable]] = {
    name: part_of(
        kind,
        f"{kind.__name__}Table",
        f"The table `[planner]` of `{kind.__name__}`.",
        _names(kind),
        bases=(PlannerTable,),
        namespace={"kind": kind},
    )
    for name, kind in PLANNERS.items()
}
"""Tables by the planner's name."""
_DEFAULTS = [
    default_planner(lattice).name
    for lattice in (Lattice(), Lattice(postures=[PostureTarget("any", 1)]), None)
]
"""Planners whose settings may be given without a name, on the lattices whose default they are."""


class ByPlannerName:
    """The annotation of a field for one of `PLANNER_TABLES`, told apart by the key `name`."""

    def table(self, value: object, lattice: Lattice | None) -> object:
        """The table of a mapping; without a name, settings are those of the lattice's default.

        Raises:
            InvalidInput: an unknown planner, or a setting that it does not have.
        """
        if isinstance(value, PlannerTable):
            return value
        if not isinstance(value, Mapping):
            raise InvalidInput("", value, "a table")
        given = dict(value)
        kind = PLANNER_TABLES[default_planner(lattice).name]
        if "name" in given:
            kind = PLANNER_TABLES[one_of(".name", given.pop("name"), list(PLANNER_TABLES))]
        elif set(given) <= set(_names(PlannerTable)):
            kind = PlannerTable
        return from_mapping(kind, given)

    def __get_pydantic_core_schema__(self, source: object, handler: Callable[[Any], Any]) -> Any:  # noqa: ANN401
        from pydantic_core import core_schema

        def made(value: object, info: Any) -> object:  # noqa: ANN401 - pydantic's
            return self.table(value, info.data.get("lattice", Lattice()))

        kinds = [handler.generate_schema(kind) for kind in PLANNER_TABLES.values()]  # type: ignore[attr-defined]
        kinds.append(handler(PlannerTable))
        return core_schema.with_info_before_validator_function(
            made, core_schema.union_schema(kinds)
        )

    def __get_pydantic_json_schema__(self, schema: object, handler: Any) -> dict[str, Any]:  # noqa: ANN401
        union: dict[str, Any] = handler(schema)
        for name, entry in zip(PLANNER_TABLES, union["anyOf"], strict=False):
            table = handler.resolve_ref_schema(entry)
            table["properties"]["name"] = {"type": "string", "enum": [name]}
            if name not in _DEFAULTS:
                table["required"] = ["name"]
        return union
