"""Rules for the fields of settings: ranges of numbers, shapes of arrays, names.

A rule stands in an annotation, `Annotated[float, Number(above=0.0)]`. It checks and converts by a
function of `core.checks`, and says in JSON Schema what it accepts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, Protocol, get_args, get_type_hints

from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, ReadOnlyDict
from ffsr_plan.core.checks import finite_array, number, one_of, path, truth, whole_number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import nearest_name
from ffsr_plan.core.settings import Given, UnknownKey, from_mapping

Vector = Given[Array, ArrayLike]
"""A field that accepts anything array-like and keeps a read-only array."""


class _Information(Protocol):
    """What pydantic passes to a validator."""

    @property
    def field_name(self) -> str | None: ...

    @property
    def data(self) -> dict[str, Any]: ...


class Rule:
    """Base of all rules: subclasses define `check` and `json_schema`."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """The clean value.

        Args:
            what: name of the field.
            value: what was given for it.
            others: the fields before it, already checked.

        Raises:
            InvalidInput: naming the field, the value and what is allowed.
        """
        raise NotImplementedError

    def json_schema(self) -> dict[str, Any]:
        """What is accepted, in JSON Schema."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: object, handler: Callable[[Any], Any]) -> Any:  # noqa: ANN401
        from pydantic_core import core_schema

        def validate(value: object, info: _Information) -> object:
            return self.check(info.field_name or "value", value, info.data or {})

        return core_schema.with_info_plain_validator_function(validate)

    def __get_pydantic_json_schema__(self, schema: object, handler: object) -> dict[str, Any]:
        return self.json_schema()


@dataclass(frozen=True)
class Number(Rule):
    """A finite number strictly inside (above, below) and in [at_least, at_most].

    Attributes:
        above: greatest number that is too small.
        below: least number that is too large.
        at_least: least number that is allowed.
        at_most: greatest number that is allowed.
    """

    above: float = -math.inf
    below: float = math.inf
    at_least: float = -math.inf
    at_most: float = math.inf

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> float:
        """See `Rule.check`."""
        return number(
            what,
            value,
            above=self.above,
            below=self.below,
            at_least=self.at_least,
            at_most=self.at_most,
        )

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        bounds = {
            "exclusiveMinimum": self.above,
            "exclusiveMaximum": self.below,
            "minimum": self.at_least,
            "maximum": self.at_most,
        }
        return {"type": "number", **{k: v for k, v in bounds.items() if math.isfinite(v)}}


@dataclass(frozen=True)
class WholeNumber(Rule):
    """An integer in [at_least, at_most].

    Attributes:
        at_least: least integer that is allowed.
        at_most: greatest integer that is allowed, or None for no limit.
    """

    at_least: int = 0
    at_most: int | None = None

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> int:
        """See `Rule.check`."""
        return whole_number(what, value, at_least=self.at_least, at_most=self.at_most)

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        most = {} if self.at_most is None else {"maximum": self.at_most}
        return {"type": "integer", "minimum": self.at_least, **most}


@dataclass(frozen=True)
class Truth(Rule):
    """True or False."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> bool:
        """See `Rule.check`."""
        return truth(what, value)

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "boolean"}


@dataclass(frozen=True)
class OneOf(Rule):
    """One of some names; the nearest one is suggested.

    Attributes:
        names: what is allowed.
    """

    names: tuple[str, ...]

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> str:
        """See `Rule.check`."""
        return one_of(what, value, self.names)

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "string", "enum": list(self.names)}


@dataclass(frozen=True)
class Text(Rule):
    """A text.

    Attributes:
        meaning: what it is, for errors: `the name of a posture`.
        empty: whether it may be empty.
    """

    meaning: str = "a text"
    empty: bool = True

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> str:
        """See `Rule.check`."""
        if not isinstance(value, str) or not (value or self.empty):
            raise InvalidInput(what, value, self.meaning)
        return value

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "string"} if self.empty else {"type": "string", "minLength": 1}


@dataclass(frozen=True)
class FilePath(Rule):
    """A path in a file of settings, as a text."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> str:
        """See `Rule.check`."""
        return str(path(what, value))

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "string", "minLength": 1}


@dataclass(frozen=True)
class Numbers(Rule):
    """An array of finite numbers of one length, kept read-only.

    Attributes:
        length: how many numbers; -1 for any number of them.
        at_most: greatest absolute value.
    """

    length: int = 3
    at_most: float = 1e9

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array:
        """See `Rule.check`."""
        return finite_array(what, value, (self.length,), self.at_most)  # type: ignore[arg-type]

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        items = {"type": "number", "minimum": -self.at_most, "maximum": self.at_most}
        sizes = {"minItems": self.length, "maxItems": self.length} if self.length >= 0 else {}
        return {"type": "array", "items": items, **sizes}


@dataclass(frozen=True)
class NamedNumbers(Rule):
    """Numbers by name, such as joint values, kept read-only.

    Attributes:
        meaning: what they are, for errors.
    """

    meaning: str = "joint names with their values"

    def check(
        self, what: str, value: object, others: Mapping[str, Any]
    ) -> ReadOnlyDict[str, float]:
        """See `Rule.check`."""
        if not isinstance(value, Mapping):
            raise InvalidInput(what, value, self.meaning)
        return ReadOnlyDict(
            {str(name): number(f"{what}.{name}", each) for name, each in value.items()}
        )

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "object", "additionalProperties": {"type": "number"}}


@dataclass(frozen=True)
class InstanceOf(Rule):
    """An object of a class, such as a robot, that no table describes.

    Attributes:
        kind: the class.
    """

    kind: type

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        if not isinstance(value, self.kind):
            raise InvalidInput(what, value, f"a {self.kind.__name__}")
        return value


class NoneMeans:
    """A field for which None is a request for an object made by a function.

    Args:
        make: the function, without arguments.
    """

    def __init__(self, make: Callable[[], object]) -> None:
        self.make = make

    def __get_pydantic_core_schema__(self, source: object, handler: Callable[[Any], Any]) -> Any:  # noqa: ANN401
        from pydantic_core import core_schema

        def given(value: object) -> object:
            return self.make() if value is None else value

        return core_schema.no_info_before_validator_function(given, handler(source))


class ByKey:
    """A union of settings classes, told apart by the key that only one of them has.

    Args:
        kinds: the classes by that key.
    """

    def __init__(self, **kinds: type) -> None:
        self.kinds = kinds

    def kind(self, table: Mapping[str, object]) -> type:
        """The class of a table.

        Raises:
            InvalidInput: none or several of the keys are there.
        """
        given = [key for key in self.kinds if key in table]
        if len(given) == 1:
            return self.kinds[given[0]]
        if not given:
            self._refuse_inner_fields(table)
        for key in [] if given else table:
            owners = [kind for kind in self.kinds.values() if key in _field_names(kind)]
            if len(owners) == 1:  # then the key that tells the kinds apart is missing
                return owners[0]
            if nearest_name(key, self.kinds) is not None:
                raise UnknownKey(key, list(self.kinds))
        keys = ", ".join(given or table) or "no key"
        raise InvalidInput("", keys, f"one of {', '.join(self.kinds)}")

    def _refuse_inner_fields(self, table: Mapping[str, object]) -> None:
        """Refuse a table whose keys are fields of a table that should stand in it."""
        if not table or any(set(table) <= set(_field_names(kind)) for kind in self.kinds.values()):
            return
        found = []
        for key, kind in self.kinds.items():
            hint = get_type_hints(kind)[key]
            inner = [each for each in get_args(hint) or (hint,) if is_dataclass(each)]
            if any(set(table) <= set(_field_names(each)) for each in inner):  # type: ignore[arg-type]
                found.append(f"{key} = {{ {', '.join(f'{name} = ...' for name in table)} }}")
        if found:
            allowed = f"these in a table of their own: {' or '.join(found)}"
            raise InvalidInput("", ", ".join(table), allowed)

    def __get_pydantic_core_schema__(self, source: object, handler: Callable[[Any], Any]) -> Any:  # noqa: ANN401
        from pydantic_core import core_schema

        kinds = tuple(self.kinds.values())

        def made(value: object) -> object:
            if isinstance(value, kinds):
                return value
            if not isinstance(value, Mapping):
                names = " or ".join(kind.__name__ for kind in kinds)
                raise InvalidInput("", value, f"an object of the class {names}")
            return from_mapping(self.kind(value), value)

        choices: Iterable[Any] = [handler.generate_schema(kind) for kind in kinds]  # type: ignore[attr-defined]
        return core_schema.no_info_before_validator_function(
            made, core_schema.union_schema(list(choices))
        )


def _field_names(kind: type) -> list[str]:
    return [each.name for each in fields(kind)]
