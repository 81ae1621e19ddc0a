"""Self-contained HTML pages made from the files of this folder."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

_FOLDER = Path(__file__).parent
_SCRIPTS = {
    "plan": ("stage.js", "views.js", "charts.js", "plan.js"),
    "live": ("stage.js", "live.js"),
}
_UNSAFE = re.compile("[<>&\u2028\u2029\ud800-\udfff]")


def html_page(name: str, data: dict[str, Any]) -> str:
    """Text of a page that loads nothing from elsewhere.

    `frame.html` is common to all pages. It receives the panels in `<name>.html`, the scripts of
    the page, the style sheet, meshcat's script and the data.

    Args:
        name: of the page, `plan` or `live`.
        data: JSON values that the script finds in the constant `data`.

    Returns:
        The HTML text. Equal data give equal text.
    """
    import meshcat

    bundle = Path(meshcat.__file__).parent / "viewer" / "dist" / "main.min.js"
    parts = {
        "/*STYLE*/": _read(_FOLDER / "style.css"),
        "<!--PANELS-->": _read(_FOLDER / f"{name}.html"),
        "/*SCRIPT*/": "".join(_read(_FOLDER / script) for script in _SCRIPTS[name]),
        "/*MESHCAT*/": _read(bundle).replace("</script", "<\\/script").replace("<!--", "<\\!--"),
        "/*DATA*/": script_literal(data),
    }  # data last, so that a title that contains a placeholder stays as it is
    text = _read(_FOLDER / "frame.html")
    for placeholder, part in parts.items():
        text = text.replace(placeholder, part)
    return text


def script_literal(data: object) -> str:
    """JSON text of data that may stand in a script of a page, whatever texts it holds.

    The characters by which a script could end, a comment of HTML begin or end, or a line of a
    script break are written as escapes, and so are halves of surrogate pairs.

    Args:
        data: JSON values.
    """
    text = json.dumps(data, ensure_ascii=False)
    return _UNSAFE.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")
