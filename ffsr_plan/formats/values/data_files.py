"""JSON and YAML files as plain values, and packages that only some formats need."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path
from typing import Any

from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text, write_text

SUFFIXES = (".json", ".yaml", ".yml")


def extra(module: str) -> Any:  # noqa: ANN401 - a module without types
    """A module of a package that comes with the extra `formats`.

    Args:
        module: its name.

    Raises:
        InvalidInput: it is not installed.
    """
    try:
        return import_module(module)
    except ImportError:
        allowed = "a format whose package is installed: pip install 'ffsr-plan[formats]'"
        raise InvalidInput(
            "format", f"package {module.split('.')[0]} is missing", allowed
        ) from None


def read_data(what: str, path: str | Path) -> Any:  # noqa: ANN401 - what JSON and YAML hold
    """The value in a JSON or YAML file; YAML documents without content are skipped.

    Args:
        what: name of the argument in errors.
        path: the file; it ends in .json, .yaml or .yml.

    Raises:
        InvalidInput: a file that cannot be read, that is no JSON or YAML, or has several documents.
    """
    target = checked_path(what, path, *SUFFIXES)
    text = read_text(what, target, "utf-8-sig")
    try:
        if target.suffix == ".json":
            return json.loads(text)
        yaml = extra("yaml")
        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
        found = [each for each in yaml.load_all(text, loader) if each is not None]
        if len(found) > 1:  # such as several messages that were recorded one after the other
            raise InvalidInput(f"{what} '{path}'", f"{len(found)} YAML documents", "one document")
        return found[0] if found else None
    except InvalidInput:
        raise
    except (ValueError, RecursionError) as error:
        raise InvalidInput(f"{what} '{path}'", str(error), "a JSON file") from None
    except Exception as error:  # of the YAML package
        raise InvalidInput(f"{what} '{path}'", str(error), "a YAML file") from None


def write_data(path: str | Path, value: object) -> None:
    """Write a value as JSON or YAML, numbers with all their digits.

    Args:
        path: the file, replaced if it exists; it ends in .json, .yaml or .yml.
        value: plain values.

    Raises:
        InvalidInput: a file that cannot be written.
    """
    target = checked_path("path", path, *SUFFIXES)
    if target.suffix == ".json":
        text = json.dumps(value, indent=1) + "\n"
    else:
        text = extra("yaml").safe_dump(value, sort_keys=False, default_flow_style=None)
    write_text("path", target, text)


def field_of(what: str, table: object, name: str, kind: type, default: Any = None) -> Any:  # noqa: ANN401
    """An entry of a mapping, of one kind.

    Args:
        what: name of the mapping in errors.
        table: the mapping.
        name: the key.
        kind: what the entry has to be.
        default: of an entry that is missing; None where it must not be.

    Raises:
        InvalidInput: no mapping, no such entry, or one of another kind.
    """
    if not isinstance(table, dict):
        raise InvalidInput(what, table, "a mapping")
    if table.get(name) is None:
        if default is None:
            raise InvalidInput(what, ", ".join(map(str, table)) or "nothing", f"an entry {name}")
        return default
    if not isinstance(table[name], kind):
        word = "a mapping" if kind is dict else "a list" if kind is list else kind.__name__
        raise InvalidInput(f"{what}, {name}", table[name], word)
    return table[name]
