"""Collada (.dae) files, read by trimesh and pycollada, after a check of what these overlook.

Pycollada takes positions that are no numbers for zeros, and trimesh leaves out whatever pycollada
cannot read.
"""

from __future__ import annotations

import logging
import math
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from xml.etree import ElementTree

import numpy as np

from ffsr_plan.meshes.triangle_files import Triangles

_KEPT = ("asset", "library_geometries", "library_nodes", "library_visual_scenes", "scene")
_REMOVED = ("bind_material", "instance_camera", "instance_light", "extra")


def read_dae(content: bytes) -> Triangles:
    """Read the triangles of all parts of a Collada file, placed as its scene places them.

    The unit of length that the file names is applied; its up axis is ignored.

    Args:
        content: all bytes of the file.

    Returns:
        Vertices [m] and faces.

    Raises:
        ValueError: what is wrong with the file.
    """
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise ValueError("a DOCTYPE or ENTITY")
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise ValueError(f"no well-formed XML: {error}") from None
    _check_positions(root)
    _keep_geometry(root)
    bare = BytesIO(ElementTree.tostring(root))
    with _silence():
        import trimesh

        try:
            scene = trimesh.load_scene(bare, file_type="dae", process=False, ignore_broken=False)
            scale = trimesh.units.unit_conversion(scene.units, "meters") if scene.units else 1.0
            mesh = scene.to_mesh()
            vertices = np.asarray(mesh.vertices, dtype=np.float64) * scale
            return Triangles(vertices, np.asarray(mesh.faces, dtype=np.int64))
        except Exception as error:  # of many types, for a file of arbitrary content
            raise ValueError(f"{type(error).__name__}: {error}") from None


def _check_positions(root: ElementTree.Element) -> None:
    """Check that the coordinates of all vertices are finite numbers."""
    space = _namespace(root)
    sources = {
        str(entry.get("source"))[1:]
        for entry in root.iterfind(f".//{space}vertices/{space}input")
        if entry.get("semantic") == "POSITION"
    }
    for source in root.iter(f"{space}source"):
        if source.get("id") in sources:
            for numbers in source.iter(f"{space}float_array"):
                words = (word[0] for word in re.finditer(r"\S+", numbers.text or ""))
                bad = next((word for word in words if not _is_finite(word)), None)
                if bad is not None:
                    raise ValueError(f"a position {bad[:60]!r}")


def _keep_geometry(root: ElementTree.Element) -> None:
    """Remove materials, images, cameras and lights, in place: many files have broken ones."""
    space = _namespace(root)
    kept = {f"{space}{name}" for name in _KEPT}
    for part in [*root]:
        if part.tag not in kept:
            root.remove(part)
    for parent in [*root.iter()]:
        for part in [*parent]:
            if part.tag in {f"{space}{name}" for name in _REMOVED}:
                parent.remove(part)


def _namespace(root: ElementTree.Element) -> str:
    return root.tag.partition("}")[0] + "}" if root.tag.startswith("{") else ""


def _is_finite(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


@contextmanager
def _silence() -> Iterator[None]:
    """Keep warnings and records of trimesh and pycollada off standard error."""
    handler, loggers = logging.NullHandler(), [logging.getLogger(n) for n in ("trimesh", "collada")]
    for each in loggers:
        each.addHandler(handler)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        for each in loggers:
            each.removeHandler(handler)
