"""Picture of the package's floors; `python -m tools.draw_architecture` writes it to docs/."""

from __future__ import annotations

from xml.sax.saxutils import escape

from tools.architecture import ROOT, floors

_WIDTH, _HEIGHT, _GAP = 860, 58, 12
_FILL, _EDGE, _TEXT, _FAINT = "#eef3f8", "#7a90a8", "#1d2a3a", "#52657a"
_FONT = "font-family='system-ui, sans-serif'"


def main() -> None:
    """Write the picture, the highest floor on top."""
    rows = floors()[::-1]
    height = len(rows) * (_HEIGHT + _GAP) + _GAP
    parts = [
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {_WIDTH} {height}' role='img'>",
        "<title>Folders of ffsr_plan; each imports only from those below it</title>",
        f"<rect width='{_WIDTH}' height='{height}' fill='white'/>",
    ]
    for k, floor in enumerate(rows):
        parts += _row(floor, _GAP + k * (_HEIGHT + _GAP))
    parts.append("</svg>\n")
    (ROOT / "docs" / "architecture.svg").write_text("\n".join(parts), encoding="utf-8")


def _row(floor: dict[str, str], y: int) -> list[str]:
    width = (_WIDTH - _GAP * (len(floor) + 1)) / len(floor)
    parts = []
    for k, (folder, purpose) in enumerate(floor.items()):
        x = _GAP + k * (width + _GAP)
        middle = x + width / 2
        parts += [
            f"<rect x='{x:.0f}' y='{y}' width='{width:.0f}' height='{_HEIGHT}' rx='6' "
            f"fill='{_FILL}' stroke='{_EDGE}'/>",
            f"<text x='{middle:.0f}' y='{y + 24}' text-anchor='middle' {_FONT} font-size='16' "
            f"font-weight='600' fill='{_TEXT}'>{escape(folder)}</text>",
            f"<text x='{middle:.0f}' y='{y + 44}' text-anchor='middle' {_FONT} font-size='12.5' "
            f"fill='{_FAINT}'>{escape(purpose)}</text>",
        ]
    return parts


if __name__ == "__main__":
    main()
