"""Where the robots and scenarios that come with the package are found."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent.parent


def folder(name: str) -> Path:
    """The bundled folder `urdf` or `scenarios`: inside an installed wheel, or beside a checkout."""
    inside = _PACKAGE / name
    return inside if inside.is_dir() else _PACKAGE.parent / name


def names(kind: str, suffix: str) -> list[str]:
    """Stems of the bundled files of one kind, sorted."""
    return sorted(path.stem for path in folder(kind).glob(f"*{suffix}"))


def find(kind: str, name: str, suffix: str) -> Path | None:
    """The bundled file called `name`, or None."""
    return folder(kind) / f"{name}{suffix}" if name in names(kind, suffix) else None
