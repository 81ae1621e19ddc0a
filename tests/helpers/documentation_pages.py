"""The pages of the documentation, and the blocks in them."""

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
_BLOCK = re.compile(
    r"^```(?P<kind>\w*)\n(?P<text>.*?)^```\n(?:\s*^```text\n(?P<shown>.*?)^```\n)?", re.S | re.M
)


class Block(NamedTuple):
    """A block of code, and the `text` block right under it, which shows what it prints."""

    kind: str
    text: str
    shown: str | None


def blocks(page, *kinds):
    """The blocks of these kinds in a page, from the top."""
    found = _BLOCK.finditer(page.read_text(encoding="utf-8"))
    return [Block(m["kind"], m["text"], m["shown"]) for m in found if m["kind"] in kinds]


def title(page):
    return page.relative_to(ROOT).as_posix()
