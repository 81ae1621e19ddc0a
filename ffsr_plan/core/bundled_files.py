"""Robots and scenarios that come with the package."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent.parent


def folder(name: str) -> Path:
    """The bundled folder `urdf` or `scenarios`.

    In the repository both folders lie beside the package, where users expect them; the wheel
    contains them inside the package, because an installed package may not own other folders. This
    is the only function that knows both places.

    Args:
        name: `urdf` or `scenarios`.
    """
    inside = _PACKAGE / name
    return inside if inside.is_dir() else _PACKAGE.parent / name


def names(kind: str, suffix: str) -> list[str]:
    """Stems of the files with a suffix in a bundled folder, sorted.

    Args:
        kind: `urdf` or `scenarios`.
        suffix: suffix of the files, such as `.urdf`.
    """
    return sorted(path.stem for path in folder(kind).glob(f"*{suffix}"))


def find(kind: str, name: str, suffix: str) -> Path | None:
    """Path of a bundled file, or None.

    Args:
        kind: `urdf` or `scenarios`.
        name: stem of the file.
        suffix: its suffix, such as `.urdf`.
    """
    return folder(kind) / f"{name}{suffix}" if name in names(kind, suffix) else None
