"""`BenchProblem`: a problem of the set, as its file has it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text
from ffsr_plan.problem.problem import Problem
from ffsr_plan.scenario_files.scenario import Scenario
from ffsr_plan.scene.scene import Scene

FORMAT = "ffsr-plan problem 1"
_LONG = ("obstacles", "bodies", "debris")  # tables of many rows, written one row a line


@dataclass(frozen=True)
class BenchProblem:
    """A problem of the set.

    Attributes:
        name: such as `cups/07`.
        family: the first part of the name.
        seed: number of the problem in its family, from which it was drawn.
        title: what it is.
        time_limit: in which a planner is asked to solve it [s].
        straight_motion: `blocked` or `free`; `not defined` where the arms have to bring about an
            attitude.
        scenario: tables of a scenario file; paths in them are relative to `folder`.
        spheres_sha256: of centres and radii of the scene's spheres at rest, which tables may draw
            from a seed; empty without any.
        folder: of the set's data.
    """

    name: str
    family: str
    seed: int
    title: str
    time_limit: float
    straight_motion: str
    scenario: dict[str, Any]
    spheres_sha256: str
    folder: Path

    @cached_property
    def problem(self) -> Problem:
        """The problem, made of the tables.

        Raises:
            InvalidInput: tables that are not allowed, or spheres drawn on this machine that are not
                those of the set.
        """
        made = Scenario.from_tables(self.scenario, self.folder).problem
        found = spheres_digest(made.scene)
        if found != self.spheres_sha256:
            allowed = f"spheres of SHA-256 {self.spheres_sha256[:12]}..., as in the file"
            raise InvalidInput(f"problem {self.name}, spheres", f"{found[:12]}...", allowed)
        return made

    def text(self) -> str:
        """The text of the file."""
        data = {
            "format": FORMAT,
            "name": self.name,
            "family": self.family,
            "seed": self.seed,
            "title": self.title,
            "time_limit": self.time_limit,
            "straight_motion": self.straight_motion,
            "spheres_sha256": self.spheres_sha256,
        }
        lines = [f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in data.items()]
        lines.append('  "scenario": {\n' + ",\n".join(_tables(self.scenario)) + "\n  }")
        return "{\n" + ",\n".join(lines) + "\n}\n"


def _tables(scenario: dict[str, Any]) -> list[str]:
    """Lines of the tables, one for each obstacle."""
    lines = []
    for key, value in scenario.items():
        if key in _LONG:
            rows = ",\n".join(f"      {json.dumps(row)}" for row in value)
            lines.append(f"    {json.dumps(key)}: [\n{rows}\n    ]")
        else:
            lines.append(f"    {json.dumps(key)}: {json.dumps(value)}")
    return lines


def spheres_digest(scene: Scene) -> str:
    """SHA-256 of the spheres of a scene that are at rest; empty without any.

    Args:
        scene: centres and radii are taken as little-endian numbers of 64 bits.
    """
    if not len(scene.radii):
        return ""
    whole = hashlib.sha256(scene.centers.astype("<f8").tobytes())
    whole.update(scene.radii.astype("<f8").tobytes())
    return whole.hexdigest()


def text_digest(text: str) -> str:
    """SHA-256 of a text file.

    Args:
        text: its contents.
    """
    return hashlib.sha256(text.encode()).hexdigest()


def read_problem(path: Path, folder: Path, expected: str | None = None) -> BenchProblem:
    """Read a problem file.

    Args:
        path: of the file.
        folder: of the set's data.
        expected: SHA-256 of the file, or None not to look.

    Raises:
        InvalidInput: no such file, one that has changed, or one that is no problem.
    """
    what = f"problem file '{path}'"
    text = read_text("problem file", path)
    if expected is not None and text_digest(text) != expected:
        raise InvalidInput(what, "contents that do not match the index", "an unchanged file")
    try:
        data = json.loads(text)
    except ValueError as error:
        raise InvalidInput(what, str(error), "a JSON file") from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        found = data.get("format") if isinstance(data, dict) else type(data).__name__
        raise InvalidInput(what, found, f"format '{FORMAT}'")
    fields = {key: value for key, value in data.items() if key != "format"}
    try:
        return BenchProblem(**fields, folder=folder)
    except TypeError as error:
        raise InvalidInput(what, str(error), "the keys of the schema, all of them") from None
