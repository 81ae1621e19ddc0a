"""Pages of the documentation, and their code blocks."""

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
_BLOCK = re.compile(
    r"^```(?P<kind>\w*)\n(?P<text>.*?)^```\n(?:\s*^```text\n(?P<shown>.*?)^```\n)?", re.S | re.M
)


class Block(NamedTuple):
    """A code block, and the `text` block below it with its output."""

    kind: str
    text: str
    shown: str | None


def blocks(page, *kinds):
    """The blocks of these kinds in a page, in order."""
    matches = _BLOCK.finditer(page.read_text(encoding="utf-8"))
    return [Block(m["kind"], m["text"], m["shown"]) for m in matches if m["kind"] in kinds]


def title(page):
    return page.relative_to(ROOT).as_posix()
