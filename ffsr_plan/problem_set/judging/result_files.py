"""Files of results: what a planner found for problems of the set, and what was judged of it.

A folder of results has a file `results.json` that names a trajectory for each problem. The judge
writes `judged.json` beside it.
"""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ffsr_plan.core.checks import number, text, whole_number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text, write_text

RESULTS, RESULTS_FORMAT = "results.json", "ffsr-plan results 1"
JUDGED, JUDGED_FORMAT = "judged.json", "ffsr-plan judged 1"
_NEEDED, _MORE = ("problem", "trajectory", "seconds"), ("seed", "curve", "reason")


@dataclass(frozen=True)
class Result:
    """What a planner found for a problem.

    Attributes:
        problem: name of the problem.
        trajectory: path of a trajectory file, relative to the folder; None where none was found.
        seconds: that the planner took [s].
        seed: of its random numbers.
        curve: pairs of seconds and the cost of the best path by then, in any unit of cost.
        reason: why there is no trajectory.
    """

    problem: str
    trajectory: str | None
    seconds: float
    seed: int = 0
    curve: tuple[tuple[float, float], ...] = ()
    reason: str = ""


@dataclass(frozen=True)
class Results:
    """What a planner found for problems of the set.

    Attributes:
        planner: its name.
        set_version: of the problem set.
        rows: one for each problem and seed.
    """

    planner: str
    set_version: str
    rows: tuple[Result, ...]


@dataclass(frozen=True)
class JudgedRow:
    """A row of `judged.json`.

    Attributes:
        problem: name of the problem.
        family: its family.
        seed: of the planner's random numbers.
        accepted: whether the trajectory solves the problem.
        reason: why not.
        seconds: that the planner took, as it says [s].
        time_limit: in which the problem was to be solved [s].
        length: L [m], and so on as in `Judgement`.
        objective: F of the whole motion [length units].
        delta_v: change of velocity [m/s].
        clearance: least sampled clearance [m].
        curve: pairs of seconds and F of the best path by then.
    """

    problem: str
    family: str
    seed: int
    accepted: bool
    reason: str
    seconds: float
    time_limit: float
    length: float | None = None
    objective: float | None = None
    delta_v: float | None = None
    clearance: float | None = None
    curve: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Judged:
    """All rows of a planner, judged.

    Attributes:
        planner: its name.
        set_version: of the problem set.
        rows: one for each problem and seed.
    """

    planner: str
    set_version: str
    rows: tuple[JudgedRow, ...]


def read_results(folder: Path) -> Results:
    """Read `results.json`.

    Args:
        folder: of the results.

    Raises:
        InvalidInput: naming the file, the row, the key and what is allowed.
    """
    what = f"results '{folder / RESULTS}'"
    data = _object(what, folder / RESULTS, RESULTS_FORMAT)
    for key in ("planner", "set_version", "results"):
        if key not in data:
            raise InvalidInput(f"{what}, keys", ", ".join(data), f"'{key}' as well")
    rows = data["results"]
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise InvalidInput(f"{what}, results", type(rows).__name__, "a list of objects")
    made = tuple(_result(f"{what}, results.{k}", row) for k, row in enumerate(rows))
    tasks = Counter((row.problem, row.seed) for row in made)
    for (problem, seed), count in tasks.items():
        if count > 1:
            given, allowed = f"{count} for {problem}, seed {seed}", "one for each problem and seed"
            raise InvalidInput(f"{what}, results", given, allowed)
    planner = text(f"{what}, planner", data["planner"])
    return Results(planner, text(f"{what}, set_version", data["set_version"]), made)


def write_results(folder: Path, results: Results) -> None:
    """Write `results.json`.

    Args:
        folder: of the results, made if it is not there.
        results: what was found; trajectories are there already.
    """
    rows = [asdict(row) for row in results.rows]
    _write(folder / RESULTS, RESULTS_FORMAT, results.planner, results.set_version, "results", rows)


def read_judged(folder: Path) -> Judged:
    """Read `judged.json`.

    Args:
        folder: of the results.

    Raises:
        InvalidInput: no such file, or one of another format.
    """
    what = f"judged results '{folder / JUDGED}'"
    if not (folder / JUDGED).exists():
        allowed = "a folder with judged.json: that of `bench run`, or what `bench judge` has judged"
        raise InvalidInput("results", str(folder), allowed)
    data = _object(what, folder / JUDGED, JUDGED_FORMAT)
    try:
        rows = tuple(JudgedRow(**row | {"curve": _curve(row["curve"])}) for row in data["rows"])
        return Judged(data["planner"], data["set_version"], rows)
    except (KeyError, TypeError) as error:
        raise InvalidInput(what, str(error), "what `bench judge` writes") from None


def write_judged(folder: Path, judged: Judged) -> None:
    """Write `judged.json`.

    Args:
        folder: of the results.
        judged: the rows.
    """
    rows = [asdict(row) for row in judged.rows]
    _write(folder / JUDGED, JUDGED_FORMAT, judged.planner, judged.set_version, "rows", rows)


def _result(what: str, row: dict[str, Any]) -> Result:
    for key in _NEEDED:
        if key not in row:
            raise InvalidInput(f"{what}, keys", ", ".join(row), f"'{key}' as well")
    for key in row:
        if key not in _NEEDED + _MORE:
            allowed = f"keys {', '.join(_NEEDED + _MORE)}"
            raise InvalidInput(f"{what}, keys", key, allowed)
    path = row["trajectory"]
    return Result(
        text(f"{what}, problem", row["problem"]),
        None if path is None else text(f"{what}, trajectory", path),
        number(f"{what}, seconds", row["seconds"], at_least=0.0),
        whole_number(f"{what}, seed", row.get("seed", 0), at_least=0),
        _curve(row.get("curve", ())),
        text(f"{what}, reason", row.get("reason", "")),
    )


def _curve(given: object) -> tuple[tuple[float, float], ...]:
    allowed = "pairs of seconds and cost"
    if not isinstance(given, (list, tuple)):
        raise InvalidInput("curve", given, allowed)
    pairs = []
    for pair in given:
        if not isinstance(pair, (list, tuple)) or len(pair) != 2:
            raise InvalidInput("curve", pair, allowed)
        pairs.append((number("curve, seconds", pair[0]), number("curve, cost", pair[1])))
    return tuple(pairs)


def _object(what: str, path: Path, wanted: str) -> dict[str, Any]:
    try:
        data = json.loads(read_text("file", path))
    except json.JSONDecodeError as error:
        raise InvalidInput(what, f"broken JSON at line {error.lineno}", "a JSON file") from None
    if not isinstance(data, dict) or data.get("format") != wanted:
        found = data.get("format") if isinstance(data, dict) else type(data).__name__
        raise InvalidInput(what, found, f"format '{wanted}'")
    return data


def _write(
    path: Path, wanted: str, planner: str, version: str, key: str, rows: list[dict[str, Any]]
) -> None:
    head = [
        f'  "format": {json.dumps(wanted)}',
        f'  "planner": {json.dumps(planner)}',
        f'  "set_version": {json.dumps(version)}',
    ]
    body = ",\n    ".join(json.dumps(row, allow_nan=False) for row in rows)
    head.append(f"  {json.dumps(key)}: [\n    {body}\n  ]")
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text("file", path, "{\n" + ",\n".join(head) + "\n}\n")
