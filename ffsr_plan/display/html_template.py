"""Pages out of a template, with meshcat's script, the style and the data inside."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

_FOLDER = Path(__file__).parent / "web"


def filled(name: str, data: dict[str, Any]) -> str:
    """The text of a page that loads nothing from elsewhere.

    Args:
        name: of the template.
        data: what its script finds under `data`.
    """
    import meshcat

    bundle = Path(meshcat.__file__).parent / "viewer" / "dist" / "main.min.js"
    parts = {
        "/*STYLE*/": _read(_FOLDER / "style.css"),
        "/*STAGE*/": _read(_FOLDER / "stage.js"),
        "/*MESHCAT*/": _read(bundle).replace("</script", "<\\/script"),
        "/*DATA*/": json.dumps(data, ensure_ascii=False).replace("</", "<\\/"),
    }  # data last: whatever stands in a title stays as it is
    text = _read(_FOLDER / name)
    for place, part in parts.items():
        text = text.replace(place, part)
    return text


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")
