"""Checks of user input: each returns a clean value or raises `InvalidInput`.

The first argument of each check, `what`, names the field or argument in the message.
"""

from __future__ import annotations

import numbers
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import nearest_name

_NORM_ROUNDING = 1e-15  # of the norm of numbers that have been divided by their norm
_MOST_SHOWN = 16  # numbers of an array in a message; of more, only the first wrong one
_LARGEST_WHOLE_NUMBER = 2**128  # seeds may be as large; counts have limits of their own
_LONGEST_NAME, _LONGEST_PATH = 255, 4095  # [bytes], as Linux and others limit them
LARGEST_NUMBER = 1e9
"""Limit of all other numbers [m or rad]."""
FARTHEST = 1e5
"""Limit [m] of coordinates in the world: for larger ones, floating-point errors would exceed what
`interval_halving.ROUNDING` allows."""


def finite_array(
    what: str,
    value: ArrayLike,
    shape: tuple[int, ...],
    at_most: float = LARGEST_NUMBER,
    row: str = "",
) -> Array:
    """Check an array of finite numbers.

    Args:
        what: name in the message.
        value: array or nested sequence.
        shape: wanted shape; -1 for any length.
        at_most: largest magnitude.
        row: what the message calls one along the first axis; then it always names the first that
            is wrong, counted from 0, and otherwise only where the array is too long to be shown.

    Returns:
        Read-only float copy.

    Raises:
        InvalidInput: another shape, not numbers, masked, too large, or not finite.
    """
    plain = type(value) is np.ndarray and value.dtype == np.float64
    try:
        array = np.array(value, dtype=np.float64)
    except Exception:  # objects may raise anything where numpy looks at them
        raise InvalidInput(what, value, _allowed(shape, at_most)) from None
    if not plain and _is_masked(value):
        raise InvalidInput(what, value, f"{_allowed(shape, at_most)}, none of them masked")
    if not plain and not _holds_numbers(value):
        raise InvalidInput(what, value, _allowed(shape, at_most))
    if array.size == 0 and 0 in [max(n, 0) for n in shape]:
        array = array.reshape([max(n, 0) for n in shape])
    fits = array.ndim == len(shape) and all(
        n < 0 or n == got for n, got in zip(shape, array.shape, strict=True)
    )
    if not fits:
        raise InvalidInput(f"{what} (shape {array.shape})", value, _allowed(shape, at_most))
    if not np.abs(array).max(initial=0.0) <= at_most:  # NaN is wrong too
        if not array.ndim or (not row and array.size <= _MOST_SHOWN):
            raise InvalidInput(what, value, _allowed(shape, at_most))
        first = tuple(np.argwhere(~(np.abs(array) <= at_most))[0].tolist())
        where = f"{what}, {row or 'entry'} {first[0]}"
        raise InvalidInput(where, float(array[first]), f"a finite number of at most {at_most:g}")
    return frozen(array)


def _allowed(shape: tuple[int, ...], at_most: float) -> str:
    wanted = "x".join("N" if n < 0 else str(n) for n in shape)
    return f"finite numbers of at most {at_most:g}, of shape ({wanted})"


def _is_masked(value: object) -> bool:
    """Whether a number of an array is masked: what lies under the mask is not meant to be used."""
    if isinstance(value, np.ndarray):
        return bool(np.ma.is_masked(value))
    if isinstance(value, (list, tuple)) and not set(map(type, value)) <= {float, int}:
        return any(map(_is_masked, value))
    return False


def _holds_numbers(value: object) -> bool:
    """Whether an array or nested sequence that numpy can read has no text and no booleans."""
    if isinstance(value, (list, tuple)):
        return set(map(type, value)) <= {float, int} or all(map(_holds_numbers, value))
    if isinstance(value, (float, int, np.number)):
        return not isinstance(value, bool)
    array = np.asarray(value)
    if array.dtype.kind == "O" and array.ndim:
        return _holds_numbers(array.tolist())
    return array.dtype.kind in "iuf"


def number(
    what: str,
    value: object,
    *,
    above: float = -np.inf,
    below: float = np.inf,
    at_least: float = -np.inf,
    at_most: float = np.inf,
) -> float:
    """Check a finite number.

    Args:
        what: name in the message.
        value: a real number; booleans are refused.
        above: exclusive lower bound.
        below: exclusive upper bound.
        at_least: lower bound.
        at_most: upper bound.

    Returns:
        The number as a float.

    Raises:
        InvalidInput: not a number, not finite or out of bounds.
    """
    bounds = [
        f"greater than {above:g}" if above > -np.inf else "",
        f"at least {at_least:g}" if at_least > -np.inf else "",
        f"less than {below:g}" if below < np.inf else "",
        f"at most {at_most:g}" if at_most < np.inf else "",
    ]
    allowed = " and ".join(["a finite number", *filter(None, bounds)])
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise InvalidInput(what, value, allowed)
    try:
        result = float(value)
    except OverflowError:  # an integer beyond all floating-point numbers
        raise InvalidInput(what, value, allowed) from None
    if not (np.isfinite(result) and above < result < below and at_least <= result <= at_most):
        raise InvalidInput(what, value, allowed)
    return result


def whole_number(what: str, value: object, *, at_least: int, at_most: int | None = None) -> int:
    """Check an integer.

    Args:
        what: name in the message.
        value: an integer; booleans and floats are refused.
        at_least: lower bound.
        at_most: upper bound; without one, 2^128.

    Returns:
        The number as an int.

    Raises:
        InvalidInput: not an integer, or out of bounds.
    """
    allowed = f"a whole number of at least {at_least}"
    allowed += "" if at_most is None else f" and at most {at_most}"
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Integral):
        raise InvalidInput(what, value, allowed)
    if at_most is None and int(value) > _LARGEST_WHOLE_NUMBER:
        raise InvalidInput(what, value, f"{allowed} and at most 2^128")
    if int(value) < at_least or (at_most is not None and int(value) > at_most):
        raise InvalidInput(what, value, allowed)
    return int(value)


def truth(what: str, value: object) -> bool:
    """Check a boolean; numbers are refused."""
    if not isinstance(value, (bool, np.bool_)):
        raise InvalidInput(what, value, "True or False")
    return bool(value)


def text(what: str, value: object) -> str:
    """Check a text, which may be empty."""
    if not isinstance(value, str):
        raise InvalidInput(what, value, "a text")
    return value


def path(what: str, value: object, *suffixes: str) -> Path:
    """Check a path; whether there is a file is not asked.

    Args:
        what: name in the message.
        value: a text that is not empty, or a `pathlib.Path`.
        suffixes: the suffixes of which it must have one; none for any.

    Returns:
        The path.

    Raises:
        InvalidInput: of another type, or no file can have such a name.
    """
    ending = f" that ends in {' or '.join(suffixes)}" if suffixes else ""
    if not isinstance(value, (str, Path)):
        raise InvalidInput(what, value, f"a path{ending}")
    if not str(value):
        raise InvalidInput(what, value, f"a path{ending or ' that is not empty'}")
    try:
        name = os.fsencode(value)
    except UnicodeEncodeError:
        raise InvalidInput(what, value, "a path of characters that file names may have") from None
    if b"\0" in name:
        raise InvalidInput(what, value, "a path without the character NUL")
    longest = max(map(len, name.split(os.sep.encode())))
    if longest > _LONGEST_NAME or len(name) > _LONGEST_PATH:
        allowed = f"a path of at most {_LONGEST_PATH} bytes, {_LONGEST_NAME} for each name in it"
        raise InvalidInput(what, value, allowed)
    found = Path(value)
    if suffixes and found.suffix not in suffixes:
        raise InvalidInput(what, str(value), f"a path{ending}")
    return found


def one_of(
    what: str, value: object, names: Sequence[str], none: str = "no name, as there is none"
) -> str:
    """Check a name.

    Args:
        what: name of the argument in the message.
        value: the name.
        names: the allowed names.
        none: what is allowed if there are no names.

    Raises:
        InvalidInput: another name; suggests the most similar one.
    """
    if not isinstance(value, str) or value not in names:
        raise unknown_name(what, value, names, none)
    return value


def unit_quaternion(what: str, value: ArrayLike) -> Array:
    """Check a unit quaternion.

    It is normalised, because a norm of 1 + 1e-7 would appear as a momentum residual of that size.
    A normalised one is returned as it is, bit for bit: a file gives back what was written to it.

    Args:
        what: name in the message.
        value: (4,) x, y, z, w, of norm one within 1e-6.

    Returns:
        (4,) the normalised quaternion, read-only.

    Raises:
        InvalidInput: not four finite numbers, or another norm.
    """
    quat = finite_array(what, value, (4,))
    norm = float(np.linalg.norm(quat))
    if abs(norm - 1.0) > 1e-6:
        raise InvalidInput(what, value, f"a unit quaternion (x, y, z, w); this norm is {norm:.9g}")
    return normalised(quat)


def normalised(vector: Array) -> Array:
    """A vector (n,) divided by its norm, unless that is one but for rounding; read-only."""
    norm = float(np.linalg.norm(vector))
    return frozen(vector if abs(norm - 1.0) <= _NORM_ROUNDING else vector / norm)


def unknown_name(
    what: str, value: object, names: Iterable[str], none: str = "no name, as there is none"
) -> InvalidInput:
    """An `InvalidInput` that lists the known names and suggests the most similar one.

    Args:
        what: the field or argument.
        value: the name.
        names: the known names.
        none: what is allowed if there are no names.
    """
    known = list(names)
    similar = nearest_name(value, known)
    hint = "" if similar is None else f" (did you mean '{similar}'?)"
    return InvalidInput(what, value, f"{', '.join(known) or none}{hint}")
