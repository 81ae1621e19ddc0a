"""Problem files, drawn by the generators.

    python -m ffsr_plan.problem_set.making.generation [--family NAME] [--out DIRECTORY]

writes robots, problems and index. The same version of the generators gives the same files.
"""

from __future__ import annotations

import argparse
import json
import zlib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.text_files import write_text
from ffsr_plan.problem_set.bench_problem import BenchProblem, spheres_digest, text_digest
from ffsr_plan.problem_set.families import (
    attitudes,
    clutter,
    debris,
    flights,
    gates,
    mounted,
    moving,
    paper,
    reaching,
    traps,
)
from ffsr_plan.problem_set.families.drafts import Family, accepted
from ffsr_plan.problem_set.set_index import DATA, INDEX, INDEX_FORMAT, VERSION

FAMILIES: dict[str, Family] = {
    each.name: each
    for each in (
        paper.FAMILY,
        flights.FAMILY,
        clutter.FAMILY,
        gates.FAMILY,
        traps.FAMILY,
        reaching.FAMILY,
        attitudes.FAMILY,
        debris.FAMILY,
        moving.FAMILY,
        mounted.SERVICING,
        mounted.REMOUNTED,
    )
}
_DRAWS = 1000


def made(family: Family, number: int, folder: Path = DATA) -> BenchProblem:
    """A problem, drawn until one passes the checks.

    Args:
        family: its family.
        number: of the problem in the family; it is the seed.
        folder: of the set's data, in which the robots are.

    Raises:
        RuntimeError: no draw passed.
    """
    rng = np.random.default_rng([zlib.crc32(family.name.encode()), number])
    for _ in range(_DRAWS):
        draft = family.draw(rng, number)
        if draft is None or (found := accepted(draft, folder)) is None:
            continue
        problem, straight = found
        tables = {"title": f"{family.name} {number:02d}: {draft.title}", **draft.tables}
        return BenchProblem(
            name=f"{family.name}/{number:02d}",
            family=family.name,
            seed=number,
            title=draft.title,
            time_limit=family.time_limit,
            straight_motion=straight,
            scenario=json.loads(json.dumps(tables)),
            spheres_sha256=spheres_digest(problem.scene),
            folder=folder,
        )
    raise RuntimeError(f"{family.name} {number}: none of {_DRAWS} draws passed")


def write_robots(folder: Path) -> None:
    """Write the robots that are not bundled.

    Args:
        folder: of the set's data.
    """
    for name, text in mounted.robot_files().items():
        write_text("robot file", folder / "robots" / name, text)


def write_family(family: Family, folder: Path) -> list[dict[str, Any]]:
    """Write the problems of a family; return their entries of the index.

    Args:
        family: the family.
        folder: of the set's data.
    """
    entries = []
    for number in range(family.count):
        problem = replace(made(family, number, folder))
        file, text = f"problems/{problem.name}.json", problem.text()
        write_text("problem file", folder / file, text)
        entries.append(
            {
                "name": problem.name,
                "family": family.name,
                "title": problem.title,
                "file": file,
                "sha256": text_digest(text),
                "time_limit": problem.time_limit,
            }
        )
        print(f"{problem.name}: {problem.title}, straight motion {problem.straight_motion}")
    return entries


def write_index(folder: Path, entries: Sequence[dict[str, Any]]) -> None:
    """Write the index.

    Args:
        folder: of the set's data.
        entries: of all problems.
    """
    order = list(FAMILIES)
    lines = [
        json.dumps(e) for e in sorted(entries, key=lambda e: (order.index(e["family"]), e["name"]))
    ]
    families = {each.name: each.title for each in FAMILIES.values()}
    text = (
        f'{{\n  "format": {json.dumps(INDEX_FORMAT)},\n  "version": {json.dumps(VERSION)},\n'
        f'  "families": {json.dumps(families, indent=2)},\n  "problems": [\n    '
        + ",\n    ".join(lines)
        + "\n  ]\n}\n"
    )
    write_text("index", folder / INDEX, text)


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--family", help="only this one; the others stay")
    parser.add_argument("--out", type=Path, default=DATA)
    given = parser.parse_args()
    wanted = list(FAMILIES)
    if given.family:
        wanted = [one_of("--family", given.family, wanted)]
    (given.out / "robots").mkdir(parents=True, exist_ok=True)
    write_robots(given.out)
    index = given.out / INDEX
    kept = json.loads(index.read_text(encoding="utf-8"))["problems"] if index.exists() else []
    for name in wanted:
        (given.out / "problems" / name).mkdir(parents=True, exist_ok=True)
        kept = [entry for entry in kept if entry["family"] != name]
        kept += write_family(FAMILIES[name], given.out)
        write_index(given.out, kept)


if __name__ == "__main__":
    main()
