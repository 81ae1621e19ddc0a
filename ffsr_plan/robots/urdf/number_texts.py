"""Numbers in XML attributes: read strictly, written with all their digits.

Readers of URDF disagree about number texts: Python takes `0.7_0` and digits of any script, urdfdom
takes neither and drops some of what it cannot read. Only what all of them mean the same by is a
number here: plain decimal digits in ASCII, between XML's own blanks.
"""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_BLANKS = re.compile(r"[ \t\r\n]+")


def words(text: str | None) -> list[str]:
    """The words of an attribute between XML's blanks; none of a missing attribute."""
    return [word for word in _BLANKS.split(text or "") if word]


def numbers(where: str, text: str | None, count: int) -> list[float]:
    """Parse and check the numbers of an attribute.

    Args:
        where: link or joint and attribute, for the message.
        text: the attribute; None if it is missing.
        count: how many finite numbers it must contain.

    Returns:
        The numbers.

    Raises:
        InvalidInput: other than `count` finite numbers in plain digits.
    """
    found = words(text)
    values = [float(word) if _NUMBER.fullmatch(word) else math.nan for word in found]
    if len(values) != count or not all(map(math.isfinite, values)):
        allowed = f"{count} finite number{'s' if count > 1 else ''} in plain digits"
        raise InvalidInput(where, text, allowed)
    return values


def attribute_numbers(element: ElementTree.Element, key: str, default: str = "") -> Array:
    """Parse the numbers of an attribute that has been checked.

    Args:
        element: the element of a checked URDF.
        key: name of the attribute.
        default: its text if it is missing.

    Returns:
        (n,) the numbers.
    """
    return np.array([float(word) for word in words(element.get(key, default))])


def attribute_text(values: ArrayLike) -> str:
    """Numbers as a URDF attribute, with all digits that tell a double from its neighbours.

    Args:
        values: any shape.
    """
    texts = (repr(float(n)) for n in np.asarray(values, dtype=np.float64).ravel())
    return " ".join(text.removesuffix(".0") for text in texts)
