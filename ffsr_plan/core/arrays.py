"""Array types, read-only arrays and dictionaries, and comparison of objects that hold arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Flags = NDArray[np.bool_]
States = NDArray[np.int8]
Records = NDArray[Any]
"""Rows with named fields. A kernel takes them as one argument, which compiles in less time."""
AnyArray = TypeVar("AnyArray", bound=NDArray[Any])
Key = TypeVar("Key")
Value = TypeVar("Value")
Class = TypeVar("Class", bound=type)


def frozen(array: AnyArray) -> AnyArray:
    """Make an array read-only in place and return it."""
    array.setflags(write=False)
    return array


def records(row: np.dtype[Any], *shape: int) -> Records:
    """Rows of zeros.

    Args:
        row: names and types of the fields.
        shape: of the result.
    """
    return np.zeros(shape, row)


class ReadOnlyDict(dict[Key, Value]):
    """A dictionary whose items are fixed when it is made; `dict(...)` makes a copy to change."""

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise TypeError("this dictionary is read-only; dict(...) makes a copy that can be changed")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[type, tuple[dict[Key, Value]]]:
        return type(self), (dict(self),)


def content(value: object) -> object:
    """A value in terms of tuples and bytes, which `==` and `hash` accept.

    Args:
        value: arrays, and tuples, lists and mappings that may hold arrays; anything else is
            returned as it is.
    """
    if isinstance(value, np.ndarray):
        return value.shape, (value + 0.0).tobytes()  # -0.0 equals 0.0
    if isinstance(value, Mapping):
        return frozenset((key, content(each)) for key, each in value.items())
    if isinstance(value, (tuple, list)):
        return tuple(content(each) for each in value)
    return value


def equal_by_content(cls: Class) -> Class:
    """Decorator of named tuples that hold arrays, whose own `==` raises.

    Two of them are equal if they are of one class and all their entries are equal.
    """

    def equal(self: tuple[object, ...], other: object) -> bool:
        return type(self) is type(other) and content(tuple(self)) == content(other)

    def unequal(self: tuple[object, ...], other: object) -> bool:
        return not equal(self, other)

    def hashed(self: tuple[object, ...]) -> int:
        return hash(content(tuple(self)))

    for name, method in (("__eq__", equal), ("__ne__", unequal), ("__hash__", hashed)):
        setattr(cls, name, method)
    return cls
