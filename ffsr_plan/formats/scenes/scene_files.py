"""Scene files of every kind, by the ends of their names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.checks import unknown_name
from ffsr_plan.formats.scenes.moveit_scenes import read_moveit_scene
from ffsr_plan.formats.scenes.primitive_scenes import read_primitives
from ffsr_plan.scenario_files.scene_file import load_scene
from ffsr_plan.scene.scene import Scene

_READERS: dict[str, Callable[[str | Path], Scene]] = {
    ".toml": load_scene,
    ".csv": Scene.from_csv,
    ".npy": Scene.from_numpy,
    ".npz": Scene.from_numpy,
    ".urdf": Scene.from_urdf,
    ".scene": read_moveit_scene,
    ".yaml": read_primitives,
    ".yml": read_primitives,
    ".json": read_primitives,
}


def read_scene(path: str | Path) -> Scene:
    """Read obstacles; the end of the file's name tells the format.

    Args:
        path: a file, or the name of a bundled scenario.

    Raises:
        InvalidInput: another end, a file that cannot be read, or what is wrong in it.
    """
    target = checked_path("scene", path)
    reader = _READERS.get(target.suffix.casefold())
    if reader is None and not target.suffix:
        return load_scene(path)
    if reader is None:
        known = [f"a file *{end}" for end in _READERS]
        raise unknown_name("scene", str(path), [*known, "or the name of a scenario"])
    return reader(path)
