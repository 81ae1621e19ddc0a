"""Links: their inertial, collision shapes and visual shapes in canonical form."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from xml.etree import ElementTree

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.urdf.inertias import add_inertial
from ffsr_plan.robots.urdf.known_elements import SHAPES, check_element
from ffsr_plan.robots.urdf.number_texts import attribute_numbers, attribute_text, numbers
from ffsr_plan.robots.urdf.origins import add_origin, lengths
from ffsr_plan.robots.urdf.xml_reading import is_comment, placed_errors, refused

COLLISION = ("collision", "visual", "ignore")
"""What becomes of a link with `<visual>` shapes and no `<collision>`: it is refused, its visual
shapes are taken, or it has no shape."""
_MASS_OF_A_FRAME = 1e-6  # [kg]


def canonical_link(
    link: ElementTree.Element,
    where: str,
    colours: Mapping[str, str],
    collision: str,
    inertia: str,
) -> ElementTree.Element:
    """A link in canonical form.

    Args:
        link: the `<link>`.
        where: file or robot name and link, for the message.
        colours: red, green, blue and opacity of the robot's materials, by name.
        collision: one of `COLLISION`; with `visual`, visual shapes become collision shapes.
        inertia: `exact` or `balance`.

    Raises:
        InvalidInput: names the element, the value and what is allowed.
    """
    check_element(link, where)
    _refuse_origin(link, where)
    copy = ElementTree.Element("link", name=str(link.get("name")))
    add_inertial(copy, link, where, inertia)
    for part in link:
        if is_comment(part):
            copy.append(part)
        elif part.tag in ("visual", "collision"):
            copy.append(_shape(part, f"{where}, {part.tag}", colours))
    if collision == "visual" and copy.find("collision") is None:
        for visual in copy.findall("visual"):
            shape = ElementTree.SubElement(copy, "collision")
            shape.extend(deepcopy(part) for part in visual if part.tag in ("origin", "geometry"))
    return copy


def check_shapes(robot: ElementTree.Element, where: str) -> None:
    """Raise `InvalidInput` that names all links with visual and without collision shapes.

    Args:
        robot: the canonical robot.
        where: file or robot name that starts the message.
    """
    names = [
        str(link.get("name"))
        for link in robot.findall("link")
        if link.find("visual") is not None and link.find("collision") is None
    ]
    if names:
        what = f"{where}, link{'s' if len(names) > 1 else ''} {_listed(names)}"
        allowed = (
            "a <collision>; collision='visual' takes the visual shapes of such links, "
            "collision='ignore' leaves these links out of all checks"
        )
        raise InvalidInput(what, "<visual> without <collision>", allowed)


def unchecked_links(robot: ElementTree.Element) -> tuple[str, ...]:
    """Links of a canonical robot that have a mass or a visual shape, but no collision shape."""
    return tuple(
        str(link.get("name"))
        for link in robot.findall("link")
        if link.find("collision") is None and (link.find("visual") is not None or has_mass(link))
    )


def shapeless_links(robot: ElementTree.Element) -> tuple[str, ...]:
    """Links of a canonical robot that have a mass and no shape of either kind.

    Tool frames of some files have masses of less than a milligram, for parsers that demand one;
    they are left out.
    """
    return tuple(
        str(link.get("name"))
        for link in robot.findall("link")
        if has_mass(link, _MASS_OF_A_FRAME)
        and link.find("collision") is None
        and link.find("visual") is None
    )


def has_mass(link: ElementTree.Element, above: float = 0.0) -> bool:
    """Whether a canonical link has a mass greater than `above` [kg]."""
    mass = link.find("inertial/mass")
    return mass is not None and float(str(mass.get("value"))) > above


def colours_of(robot: ElementTree.Element, where: str) -> dict[str, str]:
    """Colours of the materials at the top of a robot, by name."""
    colours = {}
    for material in robot.findall("material"):
        name = material.get("name") or ""
        colour = _colour(material, f"{where}, material '{name}'", {})
        if colour is not None:
            colours[name] = colour
    return colours


def _refuse_origin(link: ElementTree.Element, where: str) -> None:
    """Refuse an `<origin>` of a link itself, which readers ignore, unless it says nothing."""
    copy = ElementTree.Element("link")
    add_origin(copy, link, where)
    for origin in copy:
        if any(attribute_numbers(origin, key).any() for key in ("xyz", "rpy")):
            allowed = "an <origin> in <inertial>, <visual>, <collision> or a joint"
            raise refused(link, where, "<origin>", allowed)


def _shape(
    shape: ElementTree.Element, where: str, colours: Mapping[str, str]
) -> ElementTree.Element:
    """A `<collision>` or `<visual>` in canonical form."""
    check_element(shape, where)
    copy = ElementTree.Element(shape.tag)
    add_origin(copy, shape, where)
    geometry = shape.find("geometry")
    if geometry is not None:
        check_element(geometry, where)
    found = [] if geometry is None else [part for part in geometry if isinstance(part.tag, str)]
    if len(found) != 1 or found[0].tag not in SHAPES:
        tags = ", ".join(part.tag for part in found) or None
        raise refused(shape, where, tags, f"one shape of: {', '.join(SHAPES)}")
    with placed_errors(found[0]):
        ElementTree.SubElement(copy, "geometry").append(_solid(found[0], where))
    material = shape.find("material")
    if shape.tag == "visual" and material is not None:
        _add_material(copy, material, where, colours)
    return copy


def _solid(solid: ElementTree.Element, where: str) -> ElementTree.Element:
    """A box, sphere, capsule, cylinder or mesh in canonical form."""
    where = f"{where} {solid.tag}"
    check_element(solid, where)
    copy = ElementTree.Element(solid.tag)
    for key, count in SHAPES[solid.tag].items():
        sizes = lengths(f"{where}, {key}", solid.get(key), count)
        if min(sizes) <= 0.0:
            raise InvalidInput(f"{where}, {key}", sizes, "greater than 0 m")
        copy.set(key, attribute_text(sizes))
    if solid.tag == "mesh":
        if not solid.get("filename"):
            raise InvalidInput(f"{where}, filename", solid.get("filename"), "the address of a file")
        copy.set("filename", str(solid.get("filename")))
        if "scale" in solid.attrib:
            scale = numbers(f"{where}, scale", solid.get("scale"), 3)
            if 0.0 in scale:
                raise InvalidInput(f"{where}, scale", scale, "three numbers other than 0")
            copy.set("scale", attribute_text(scale))
    return copy


def _add_material(
    copy: ElementTree.Element,
    material: ElementTree.Element,
    where: str,
    colours: Mapping[str, str],
) -> None:
    """Add the material of a visual shape, its colour looked up; no colour, no material."""
    colour = _colour(material, f"{where} material", colours)
    name = material.get("name") or ""
    if colour is not None:
        element = ElementTree.SubElement(copy, "material", name=name)
        ElementTree.SubElement(element, "color", rgba=colour)


def _colour(material: ElementTree.Element, where: str, colours: Mapping[str, str]) -> str | None:
    check_element(material, where)
    colour = material.find("color")
    if colour is None:
        return colours.get(material.get("name") or "")
    check_element(colour, where)
    with placed_errors(colour):
        rgba = numbers(f"{where}, rgba", colour.get("rgba"), 4)
        if not all(0.0 <= value <= 1.0 for value in rgba):
            raise InvalidInput(f"{where}, rgba", rgba, "four numbers from 0 to 1")
    return attribute_text(rgba)


def _listed(names: list[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
