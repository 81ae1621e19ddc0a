"""The package's folders, their floors and the imports between its modules."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "ffsr_plan"


def floors() -> list[dict[str, str]]:
    """The floors, lowest first: folders with what they are for."""
    text = (ROOT / "tests" / "architecture.toml").read_text(encoding="utf-8")
    listed: list[dict[str, str]] = tomllib.loads(text)["floors"]
    return listed


def modules(package: Path = PACKAGE) -> dict[str, Path]:
    """Dotted names below the package, without its own, and their files."""
    found = {}
    for path in sorted(package.rglob("*.py")):
        parts = path.relative_to(package).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def folder_of(module: str, package: Path = PACKAGE) -> str:
    """The folder that a module lies in, dotted; empty for the package's own `__init__`."""
    if (package / Path(*module.split("."))).is_dir():
        return module
    return module.rpartition(".")[0]


def imports(package: Path = PACKAGE) -> dict[str, set[str]]:
    """Modules of the package that each module imports, anywhere in it, type checking included."""
    names = modules(package)
    return {name: _imported(path, name, set(names)) for name, path in names.items()}


def _imported(path: Path, name: str, known: set[str]) -> set[str]:
    targets = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            targets |= {_below(alias.name) for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            if node.level:
                raise ValueError(f"{path}: relative import")
            base = _below(node.module or "")
            for alias in node.names:
                inner = f"{base}.{alias.name}" if base else alias.name
                is_module = base is not None and inner in known
                targets.add(inner if is_module else base)
    return {target for target in targets if target is not None and target != name}


def _below(module: str) -> str | None:
    """The dotted name below the package; None for other packages, empty for the package itself."""
    if module == PACKAGE.name:
        return ""
    prefix = f"{PACKAGE.name}."
    return module[len(prefix) :] if module.startswith(prefix) else None
