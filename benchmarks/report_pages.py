"""Report pages of the benchmark commands: where they lie, their tables, and writing them."""

from collections.abc import Iterable
from pathlib import Path

RESULTS = Path(__file__).parent.parent / "docs" / "benchmarks"


def table(header: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A markdown table, its first column aligned left and all others right."""
    names = list(header)
    lines = [names, ["---", *["---:"] * (len(names) - 1)], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def publish(text: str, out: Path) -> None:
    """Write a report and print it."""
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(text, encoding="utf-8")
    print(text)
