"""Plan files that were changed at random, one change each."""

import copy
import math
from typing import Any

import numpy as np

Path = tuple[str | int, ...]
_TEXTS = ("urdf", "srdf", "name", "format", "package_dirs")


def leaves(value: object, path: Path = ()) -> list[Path]:
    """Paths of all that is neither a table nor a list; of long lists, of few entries."""
    if isinstance(value, dict):
        return [p for key, each in value.items() for p in leaves(each, (*path, key))]
    if isinstance(value, list):
        some = sorted({0, 1, len(value) // 2, len(value) - 1} & set(range(len(value))))
        return [p for k in some for p in leaves(value[k], (*path, k))]
    return [path]


def tables(value: object, path: Path = ()) -> list[Path]:
    """Paths of all tables and lists that hold something."""
    if isinstance(value, dict) and value:
        return [path, *(p for key, each in value.items() for p in tables(each, (*path, key)))]
    if isinstance(value, list) and value:
        return [path, *tables(value[0], (*path, 0))]
    return []


def at(value: Any, path: Path) -> Any:
    """What a path leads to."""
    for step in path:
        value = value[step]
    return value


def mutated(data: dict[str, Any], rng: np.random.Generator) -> tuple[dict[str, Any], Path, str]:
    """A changed copy of a plan's dictionary, where it was changed, and how."""
    changed = copy.deepcopy(data)
    kind = str(rng.choice(["value", "type", "key", "length"], p=[0.5, 0.2, 0.15, 0.15]))
    if kind in ("value", "type"):
        places = [p for p in leaves(changed) if not set(p) & set(_TEXTS)]
        path = places[int(rng.integers(len(places)))]
        table, key = at(changed, path[:-1]), path[-1]
        change = _other_value if kind == "value" else _other_type
        table[key] = change(table[key], rng)
        return changed, path, kind
    places = [p for p in tables(changed) if not set(p) & set(_TEXTS)]
    path = places[int(rng.integers(len(places)))]
    table = at(changed, path)
    if isinstance(table, dict):
        return changed, path, _other_keys(table, rng)
    return changed, path, _other_length(table, rng)


def _other_value(value: object, rng: np.random.Generator) -> object:
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + int(rng.choice([-1, 1, 2, 1000, 10**9, 10**400]))
    if isinstance(value, float):
        factor = float(rng.choice([0.0, -1.0, 0.9, 1.1, 1.0 + 1e-6, 10.0, 1e9, 1e300]))
        changed = value * factor if value else factor
        return changed if math.isfinite(changed) else 1e308
    if value is None:
        return float(rng.choice([0.0, 1.0, -1.0]))
    return f"{value}x"


def _other_type(value: object, rng: np.random.Generator) -> object:
    others = ["1", True, None, [], {}, [value], {"value": value}, "", 10**400]
    choice = others[int(rng.integers(len(others)))]
    return "other" if type(choice) is type(value) and choice == value else choice


def _other_keys(table: dict[str, Any], rng: np.random.Generator) -> str:
    key = str(rng.choice(list(table)))
    how = str(rng.choice(["dropped", "added", "renamed"]))
    if how == "added":
        table["zz"] = table[key]
    else:
        value = table.pop(key)
        if how == "renamed":
            table[f"{key}s"] = value
    return f"key {how}"


def _other_length(values: list[Any], rng: np.random.Generator) -> str:
    how = str(rng.choice(["cut", "doubled", "longer", "turned round"]))
    if how == "cut":
        del values[int(rng.integers(len(values))) :]
    elif how == "doubled":
        values.extend(copy.deepcopy(values))
    elif how == "longer":
        values.append(copy.deepcopy(values[-1]))
    else:
        values.reverse()
    return f"list {how}"
