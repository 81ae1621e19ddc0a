"""Immutable settings: dataclasses whose fields pydantic checks by rules (`core.setting_rules`).

    @settings
    class Axis:
        half_count: Annotated[int, WholeNumber(at_least=1)]
        spacing: Annotated[float, Number(above=0.0)]

A field's type, range and default are written once, in its annotation, and its description once, in
the section `Attributes:` of the class docstring. They serve keyword arguments, tables of scenario
files and the JSON Schema alike. Pydantic is imported when the first object is made, not before:
its import takes about 0.1 s, a quarter of that of the whole package.
"""

from __future__ import annotations

import functools
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

from ffsr_plan.core.arrays import content
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import nearest_name

if sys.version_info >= (3, 11):
    from typing import dataclass_transform
else:
    from typing_extensions import dataclass_transform

if TYPE_CHECKING:
    from pydantic import TypeAdapter, ValidationError

T = TypeVar("T")
Kept = TypeVar("Kept", covariant=True)
Accepted = TypeVar("Accepted", contravariant=True)
_OR_NONE = ", or None"


class Given(Generic[Kept, Accepted]):
    """The type of a field that accepts more than it keeps: `Given[Array, ArrayLike]`.

    Type checkers read a descriptor; at run time it is an annotation and nothing else.
    """

    if TYPE_CHECKING:

        def __get__(self, instance: object, owner: type | None = None) -> Kept: ...

        def __set__(self, instance: object, value: Accepted) -> None: ...

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Callable[[Any], Any]) -> Any:  # noqa: ANN401
        return handler(source.__args__[0])


def setting(*, default: Any = MISSING, default_factory: Any = MISSING) -> Any:  # noqa: ANN401
    """`dataclasses.field` for fields of the type `Given`, whose default is of another type."""
    if default_factory is not MISSING:
        return field(default_factory=default_factory)
    return field(default=default)


@overload
def settings(cls: type[T], /) -> type[T]: ...
@overload
def settings(*, of: str = "") -> Callable[[type[T]], type[T]]: ...


@dataclass_transform(frozen_default=True, field_specifiers=(field, setting))
def settings(cls: type[T] | None = None, /, *, of: str = "") -> Any:
    """Make a frozen dataclass whose constructor checks and converts its arguments.

    `dataclasses.replace`, `fields` and `asdict` work as for any dataclass, and `replace` checks
    again. A mapping is accepted where a field's type is itself a settings class. Two objects are
    equal if they are of one class and their fields are equal, arrays element by element.

    Args:
        cls: the class, if the decorator has no arguments.
        of: what the fields belong to, for errors: `mass of the bus` instead of `mass`.

    Raises:
        InvalidInput: by the constructor: a missing, unknown or refused argument.
    """
    if cls is None:
        return functools.partial(_make, of=of)
    return _make(cls, of=of)


def part_of(
    cls: type,
    name: str,
    summary: str,
    names: Iterable[str],
    bases: tuple[type, ...] = (),
    namespace: Mapping[str, object] | None = None,
) -> type[Any]:
    """A settings class with fields of another dataclass: their rules, defaults and descriptions.

    Args:
        cls: the dataclass.
        name: of the new class.
        summary: first line of its docstring.
        names: of the fields that it takes over; all of them have defaults.
        bases: other settings classes whose fields it has as well.
        namespace: attributes of the new class that are not fields.
    """
    from typing import get_type_hints

    hints, texts, names = (
        get_type_hints(cls, include_extras=True),
        field_descriptions(cls),
        [*names],
    )
    defaults = {each.name: each.default for each in fields(cls) if each.name in names}
    lines = [f"    {each}: {texts[each]}" for each in names if each in texts]
    content = {
        **(namespace or {}),
        **defaults,
        "__annotations__": {each: hints[each] for each in names},
        "__doc__": "\n".join([summary, "", "Attributes:", *lines]),
        "__module__": __name__,
    }
    return settings(type(name, bases, content))


def field_descriptions(cls: type) -> dict[str, str]:
    """Texts of the section `Attributes:` in a class's docstring and those of its bases, by name."""
    found: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        section = re.search(r"^Attributes:\n((?:    .*\n?|\n)+)", _docstring(base), re.MULTILINE)
        if section:
            for entry in re.split(r"\n(?=    \w)", section[1].rstrip()):
                name, _, text = entry.strip().partition(": ")
                found[name] = " ".join(text.split())
    return found


def _make(cls: type[T], *, of: str) -> type[T]:
    made: Any = dataclass(frozen=True, eq=False)(cls)
    names = [each.name for each in fields(made)]

    def construct(self: T, *arguments: object, **named: object) -> None:
        from pydantic import ValidationError
        from pydantic_core import ArgsKwargs

        if len(arguments) > len(names):
            raise InvalidInput("arguments", arguments, f"at most {len(names)}: {', '.join(names)}")
        for name, value in zip(names, arguments, strict=False):
            if name in named:
                raise InvalidInput(name, named[name], "one value, not two")
            named[name] = value
        try:
            _adapter(made).validator.validate_python(ArgsKwargs((), named), self_instance=self)
            return
        except ValidationError as error:
            refusal = _in_our_words(made, error, of)
        # outside of the handler: the context of an error is pickled with it where Dask runs, and
        # pydantic's holds the arguments of the call, which cannot be pickled
        raise refusal

    def key(self: T) -> object:
        return content([getattr(self, name) for name in names])

    made.__init__ = functools.wraps(made.__init__)(construct)
    made.__eq__ = lambda self, other: (
        key(self) == key(other) if type(other) is made else NotImplemented
    )
    made.__hash__ = lambda self: hash(key(self))
    made.__pydantic_config__ = {
        "extra": "forbid",
        "arbitrary_types_allowed": True,
        "validate_default": True,
        "json_schema_extra": _describe,
    }
    made.__get_pydantic_core_schema__ = classmethod(_core_schema)
    return made


@functools.cache
def _adapter(cls: type) -> TypeAdapter[Any]:
    from pydantic import TypeAdapter

    return TypeAdapter(cls)


def _core_schema(cls: type, source: object, handler: Callable[[Any], Any]) -> Any:  # noqa: ANN401
    """The dataclass schema of pydantic, before which a mapping becomes an object by `__init__`."""
    from pydantic_core import ArgsKwargs, core_schema

    def made(value: object) -> object:
        return value if isinstance(value, (cls, ArgsKwargs)) else from_mapping(cls, value)

    inner = dict(handler(source))
    ref = inner.pop("ref", None)  # other uses of the class refer to the whole, not to `inner`
    return core_schema.no_info_before_validator_function(made, inner, ref=ref)


def from_mapping(cls: type[T], value: object) -> T:
    """An object of a settings class from a table of a file.

    Raises:
        InvalidInput: with a path relative to the table in `what`, after a dot.
    """
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise InvalidInput("", value, _call(cls))
    try:
        return cls(**value)
    except UnknownKey:
        raise
    except InvalidInput as error:
        allowed = error.allowed.removesuffix(_OR_NONE)  # in a file, the key is left out
        what = f".{error.what}" if error.what else ""
        raise InvalidInput(what, error.value, allowed) from None


class UnknownKey(InvalidInput):
    """A key that a table does not have; the nearest one is suggested.

    Attributes:
        key: the key.
        known: the keys that the table has.
        path: of the table in the file, empty or ending with a dot.
    """

    def __init__(self, key: str, known: Sequence[str], path: str = "", of: str = "") -> None:
        nearest = nearest_name(key, known)
        hint = "" if nearest is None else f" (did you mean '{path}{nearest}'?)"
        names = ", ".join(path + name for name in known) or "no key, as it has none"
        super().__init__(f"unknown key{of and ' of '}{of}", path + key, names + hint)
        self.key, self.known, self.path = key, tuple(known), path

    def __reduce__(self) -> tuple[object, ...]:
        return InvalidInput, (self.what, self.value, self.allowed)

    def within(self, path: str) -> UnknownKey:
        """The same error, seen from the table in which this one has a path."""
        return UnknownKey(self.key, self.known, f"{path}.{self.path}")


def _in_our_words(cls: type, error: ValidationError, of: str) -> InvalidInput:
    """The first error that pydantic reports, unknown names before missing ones."""
    # a misspelt name also leaves the right one missing: the misspelling is what to report
    first = min(error.errors(), key=lambda each: each["type"] != "unexpected_keyword_argument")
    place, value, context = (
        [str(step) for step in first["loc"]],
        first["input"],
        first.get("ctx", {}),
    )
    path, kind, inner = ".".join(place), first["type"], context.get("error")
    if kind == "unexpected_keyword_argument":
        *tables, key = place
        path = "".join(f"{table}." for table in tables)
        return UnknownKey(key, [each.name for each in fields(_nested(cls, tables))], path, of)
    if isinstance(inner, UnknownKey):
        return inner.within(path)
    if isinstance(inner, InvalidInput):
        value, allowed = inner.value, inner.allowed
        path = _joined(place, inner.what)
    elif kind.startswith("missing"):
        value, allowed = None, "a value: it is required"
    elif kind in ("tuple_type", "list_type"):
        table = isinstance(value, Mapping)
        allowed = "a list of tables, [[name]] in a file" if table else "a list"
    else:
        allowed = first["msg"].removeprefix("Input should be ")
    if len(place) == 1 and "None" not in allowed and _may_be_none(cls, place[0]):
        allowed += _OR_NONE
    if of:
        path = re.sub(r"^[\w.]+", lambda found: f"{found[0]} of {of}", path, count=1)
    return InvalidInput(path, value, allowed)


def _nested(cls: type, path: Sequence[str]) -> type:
    """The settings class of a field of a field ... of `cls`."""
    from typing import get_args, get_type_hints

    for name in path:
        parts = [get_type_hints(cls)[name]]
        while parts and not hasattr(parts[0], "__pydantic_config__"):
            parts = [*get_args(parts[0]), *parts[1:]]
        cls = parts[0] if parts else cls
    return cls


def _may_be_none(cls: type, name: str) -> bool:
    from typing import get_args, get_type_hints

    return type(None) in get_args(get_type_hints(cls)[name])


def _call(cls: type) -> str:
    names = ", ".join(each.name for each in fields(cls))
    if cls.__name__.endswith("Table"):  # of a file; not part of the interface
        return f"a table with keys among {names}"
    return f"{cls.__name__}({names})"


def _joined(place: list[str], what: str) -> str:
    """Path of a value: where pydantic met it, and what the error that it met says of it."""
    path = ".".join(place)
    if not place or not what or what.startswith("."):
        return path + what
    field = next((step for step in reversed(place) if not step.isdecimal()), "")
    if re.match(rf"{re.escape(field)}\b", what):  # entries of a list are named by their field
        return path + what[len(field) :]
    return f"{path}: {what}"


def _describe(schema: dict[str, Any], cls: type) -> None:
    """Put the docstring's texts into a JSON Schema."""
    schema["description"] = _docstring(cls).split("\n\n", maxsplit=1)[0].replace("\n", " ")
    for name, text in field_descriptions(cls).items():
        entry = schema.get("properties", {}).get(name)
        if entry is not None:
            entry["description"] = text


def _docstring(cls: type) -> str:
    import inspect

    return inspect.cleandoc(cls.__dict__.get("__doc__") or "")
