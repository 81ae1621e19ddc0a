"""Scenes from files: obstacles of a scenario file, or of a file that has nothing but obstacles."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.settings import from_mapping, settings
from ffsr_plan.core.text_files import read_text
from ffsr_plan.scenario_files.body_tables import BodyTable
from ffsr_plan.scenario_files.obstacle_tables import Obstacle
from ffsr_plan.scenario_files.scenario import load_scenario
from ffsr_plan.scenario_files.shape_tables import KeepIn, with_names
from ffsr_plan.scene.scene import Scene

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


@settings
class SceneFile:
    """A TOML file of obstacles alone.

    Attributes:
        obstacles: tables as in scenario files.
        keep_in: zones, as there.
        bodies: bodies that move, as there.
        title: of no use here.
    """

    obstacles: tuple[Obstacle, ...] = ()
    keep_in: tuple[KeepIn, ...] = ()
    bodies: tuple[BodyTable, ...] = ()
    title: str = ""


def load_scene(source: str | Path) -> Scene:
    """The obstacles of a TOML file.

    Args:
        source: path or bundled name of a scenario; or the path of a file that has the tables
            `[[obstacles]]`, `[[keep_in]]` and `[[bodies]]` alone.

    Raises:
        InvalidInput: names file, field and value.
    """
    path = checked_path("scene", source)
    if not path.is_file():
        return load_scenario(source).scene
    text = read_text("scene", path, "utf-8-sig")
    try:
        data: dict[str, Any] = tomllib.loads(text)
    except (RecursionError, ValueError) as error:
        raise InvalidInput(f"scene '{source}'", str(error), "a TOML file") from None
    if "robot" in data or "goal" in data:
        return load_scenario(source).scene
    try:
        return _scene(from_mapping(SceneFile, data), path.parent)
    except InvalidInput as error:
        place = f"scene '{source}': {error.what.removeprefix('.')}"
        raise InvalidInput(place, error.value, error.allowed) from None


def _scene(file: SceneFile, folder: Path) -> Scene:
    scene = Scene()
    for k, obstacle in enumerate(file.obstacles):
        made = with_names(obstacle.scene(folder), f"obstacles.{k}")
        scene += made if made.sources else made.named(f"obstacles.{k}")
    return scene + Scene(
        keep_in=[table.zone for table in file.keep_in],
        bodies=[table.body(folder) for table in file.bodies],
    )
