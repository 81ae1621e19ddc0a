"""`ProblemSet`: the index of the problems, and the problems and best plans by name."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text
from ffsr_plan.problem_set.bench_problem import BenchProblem, read_problem
from ffsr_plan.problem_set.best_plans import BestPlans

VERSION = "1"
INDEX, INDEX_FORMAT = "index.json", "ffsr-plan problem index 1"
DATA = Path(__file__).resolve().parent / "data"
"""The data that come with the package."""


class ProblemSet:
    """The problem set: problems as data files, with an index and checksums.

    Attributes:
        folder: of the data.
        version: of the set.
        families: titles by name of the family.
    """

    def __init__(self, folder: str | Path | None = None) -> None:
        """Read the index.

        Args:
            folder: of the data; None for those of the package.

        Raises:
            InvalidInput: no index in the folder, or another format.
        """
        self.folder = DATA if folder is None else checked_path("folder", folder)
        what = f"index '{self.folder / INDEX}'"
        text = read_text("index", self.folder / INDEX)
        try:
            data: Any = json.loads(text)
        except ValueError as error:
            raise InvalidInput(what, str(error), "a JSON file") from None
        if not isinstance(data, dict) or data.get("format") != INDEX_FORMAT:
            found = data.get("format") if isinstance(data, dict) else type(data).__name__
            raise InvalidInput(what, found, f"format '{INDEX_FORMAT}'")
        self.version: str = data["version"]
        self.families: dict[str, str] = data["families"]
        self._entries: dict[str, dict[str, Any]] = {e["name"]: e for e in data["problems"]}

    def names(self, family: str | Sequence[str] | None = None) -> list[str]:
        """Names of the problems, of all families, of one, or of several.

        Args:
            family: name or names; None for all.

        Raises:
            InvalidInput: an unknown family; the nearest name is suggested.
        """
        if family is None:
            return list(self._entries)
        if not isinstance(family, (str, list, tuple)):
            raise InvalidInput("family", family, "a name, a list of names, or None")
        wanted = [family] if isinstance(family, str) else list(family)
        for each in wanted:
            one_of("family", each, list(self.families))
        return [name for name, entry in self._entries.items() if entry["family"] in wanted]

    def entry(self, name: str) -> dict[str, Any]:
        """What the index says of a problem: family, title, file, sha256 and time_limit.

        Args:
            name: of the problem, such as `traps/07`.

        Raises:
            InvalidInput: an unknown problem; the nearest name is suggested.
        """
        return dict(self._entries[one_of("problem", name, list(self._entries))])

    def __getitem__(self, name: str) -> BenchProblem:
        """A problem by name; its file has to be the one of the index.

        Raises:
            InvalidInput: an unknown problem, or a file that is not there or has changed.
        """
        entry = self.entry(name)
        return read_problem(self.folder / entry["file"], self.folder, entry["sha256"])

    @property
    def best(self) -> BestPlans:
        """The best plans known: `get(name)` has the figures, `trajectory(name)` the motion."""
        return BestPlans(self.folder)

    def __len__(self) -> int:
        return len(self._entries)

    def __iter__(self) -> Iterator[BenchProblem]:
        return (self[name] for name in self._entries)

    def __repr__(self) -> str:
        return f"ProblemSet(version {self.version}, {len(self)} problems)"
