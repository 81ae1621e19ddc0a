"""Masses and inertia tensors of links."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import NamedTuple, cast
from xml.etree import ElementTree

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.urdf.known_elements import MOMENTS, check_element
from ffsr_plan.robots.urdf.number_texts import attribute_text, numbers, words
from ffsr_plan.robots.urdf.origins import add_origin
from ffsr_plan.robots.urdf.xml_reading import is_comment, placed_errors, refused

HEAVIEST = 1e9
"""Limit [kg] of the mass of a body; beside heavier ones, light bodies are lost in rounding."""
INERTIA = ("exact", "balance")
"""What becomes of a tensor that no body has: it is refused, or the nearest valid one is taken."""
_FEWEST_DIGITS = 3  # programs that print fewer leave out zeros
_MOST_EXCESS = 0.01  # of the largest moment, for tensors of few digits
_NEGLIGIBLE = 1e-12  # [m^2] times the mass: moments of a point
_BALANCED = re.compile(r" inertia balanced, given: (.*) ")


class Balanced(NamedTuple):
    """An inertia tensor that no body has, and the one taken in its place.

    Attributes:
        link: name of the link.
        given: ixx, ixy, ixz, iyy, iyz, izz of the file [kg m^2].
        taken: the same of the tensor taken, about the same point [kg m^2].
    """

    link: str
    given: tuple[float, ...]
    taken: tuple[float, ...]


def add_inertial(
    part: ElementTree.Element, link: ElementTree.Element, where: str, inertia: str
) -> None:
    """Add the canonical `<inertial>` of a link to its canonical copy, if it has one.

    Args:
        part: the copy.
        link: the link.
        where: robot and link, for the message.
        inertia: `exact` or `balance`.

    Raises:
        InvalidInput: no mass or tensor, a value that no body has, or a fault in the elements.
    """
    inertial = link.find("inertial")
    if inertial is None:
        return  # a frame; `plausibility.check_bodies` checks that each moving body has a mass
    check_element(inertial, f"{where}, inertial")
    copy = ElementTree.SubElement(part, "inertial")
    add_origin(copy, inertial, f"{where}, inertial")
    mass, tensor = inertial.find("mass"), inertial.find("inertia")
    if mass is None or tensor is None:
        raise refused(inertial, where, "inertial without mass or inertia", "both of them")
    for element, name in ((mass, "mass"), (tensor, "inertia")):
        check_element(element, f"{where}, {name}")
    with placed_errors(mass):
        (value,) = numbers(f"{where}, mass", mass.get("value"), 1)
        if value > HEAVIEST:
            raise InvalidInput(f"{where}, mass", value, f"at most {HEAVIEST:g} kg")
    with placed_errors(tensor):
        given = [numbers(f"{where}, {key}", tensor.get(key), 1)[0] for key in MOMENTS]
    is_frame = value == 0.0 and not any(given)  # some files have such tool frames
    if value <= 0.0 and not is_frame:
        allowed = "greater than 0 kg, or 0 kg without inertia for a frame"
        raise refused(mass, f"{where}, mass", value, allowed)
    taken = given
    if fault := tensor_fault(given, [tensor.get(key) for key in MOMENTS], value):
        if inertia != "balance":
            allowed = f"{fault}; inertia='balance' takes the nearest tensor that a body can have"
            raise refused(tensor, f"{where}, inertia", principal_moments(given), allowed)
        taken = balanced(given)
        copy.append(_comment(f"inertia balanced, given: {attribute_text(given)}"))
    else:
        copy.extend(comment for comment in inertial if _record(comment) is not None)
    ElementTree.SubElement(copy, "mass", value=attribute_text(value))
    moments = {key: attribute_text(v) for key, v in zip(MOMENTS, taken, strict=True)}
    ElementTree.SubElement(copy, "inertia", moments)


def tensor_fault(
    given: Sequence[float], texts: Sequence[str | None], mass: float = 0.0
) -> str | None:
    """What is wrong with an inertia tensor, or None.

    The moments of a thin plate just meet the triangle inequality; rounded to a few digits, a third
    of them break it. So the inequality may be broken by as much as half a unit in the last digit of
    each number. Numbers of fewer than three digits count as three, and 1 % of the largest moment is
    the limit.

    Args:
        given: ixx, ixy, ixz, iyy, iyz, izz [kg m^2].
        texts: the same as they are printed.
        mass: of the body [kg].

    Returns:
        What is allowed, for the message.
    """
    small, middle, large = principal_moments(given)
    rounding = min(sum(map(_half_unit, texts)), _MOST_EXCESS * large)
    slack = max(rounding, 1e-9 * large, _NEGLIGIBLE * mass)
    if small < -slack or small + middle < large - slack:
        return "principal moments >= 0 of which no two sum to less than the third"
    return None


def principal_moments(given: Sequence[float]) -> list[float]:
    """Principal moments of ixx, ixy, ixz, iyy, iyz, izz, in ascending order."""
    return cast("list[float]", np.linalg.eigvalsh(_tensor(given)).tolist())


def balanced(given: Sequence[float]) -> list[float]:
    """The nearest tensor that a body can have, at least the given one about every axis.

    A tensor J is one of a body if no second moment of its mass, S = tr(J)/2 1 - J, is negative;
    those that are become zero.

    Args:
        given: ixx, ixy, ixz, iyy, iyz, izz [kg m^2].
    """
    tensor = _tensor(given)
    values, axes = np.linalg.eigh(0.5 * np.trace(tensor) * np.eye(3) - tensor)
    moments = (axes * np.maximum(values, 0.0)) @ axes.T
    lifted = np.trace(moments) * np.eye(3) - moments
    return [float(lifted[i, j]) for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))]


def balanced_links(robot: ElementTree.Element) -> tuple[Balanced, ...]:
    """Links of a canonical robot whose tensor was balanced."""
    return tuple(
        Balanced(str(link.get("name")), given, moments(link.find("inertial/inertia")))
        for link in robot.findall("link")
        for inertial in link.findall("inertial")
        for comment in inertial
        if (given := _record(comment)) is not None
    )


def moments(inertia: ElementTree.Element | None) -> tuple[float, ...]:
    """ixx, ixy, ixz, iyy, iyz, izz of a canonical `<inertia>`; zeros without one."""
    if inertia is None:
        return (0.0,) * len(MOMENTS)
    return tuple(float(str(inertia.get(key))) for key in MOMENTS)


def _record(comment: ElementTree.Element) -> tuple[float, ...] | None:
    """The tensor given, of a comment that `add_inertial` wrote; None for other elements."""
    if not is_comment(comment):
        return None
    match = _BALANCED.fullmatch(comment.text or "")
    try:
        return None if match is None else tuple(numbers("comment", match[1], len(MOMENTS)))
    except InvalidInput:
        return None


def _comment(text: str) -> ElementTree.Element:
    return cast("ElementTree.Element", ElementTree.Comment(f" {text} "))


def _tensor(given: Sequence[float]) -> Array:
    xx, xy, xz, yy, yz, zz = given
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _half_unit(text: str | None) -> float:
    """Half a unit in the last digit of a number's text."""
    (word,) = words(text)
    mantissa = re.split("[eE]", word)[0].lstrip("+-")
    digits = max(_FEWEST_DIGITS, len(mantissa.replace(".", "").lstrip("0")))
    size = abs(float(word))
    return 0.5 * 10.0 ** (math.floor(math.log10(size)) - digits + 1) if size > 0.0 else 0.0
