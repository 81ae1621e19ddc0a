"""Numbers of sentences, compared with the tables that they were taken from.

A `Claim` is a sentence of a page with places for numbers, and for each of them where it is found: a
`Cell` of a table in docs/benchmarks, or a `Phrase` of the text there. A number agrees if the one
found, rounded as the sentence rounds, is the one stated.
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parent.parent
RESULTS = "docs/benchmarks"
_NUMBER = r"[-+]?(?:\d{1,3}(?: \d{3})+|\d+)(?:\.\d+)?"
_STATED = rf"{_NUMBER}|none"
_PLACE = re.compile(r"\{(\w+)\}")


class NotOnPageError(LookupError):
    """What is looked for is not there, or there more than once."""


@dataclass(frozen=True)
class Cell:
    """A number of a table.

    Attributes:
        page: name of the page in docs/benchmarks, without `.md`.
        row: text of the row's first cell, or None for all rows.
        column: heading of the column; the first table of the page that has row and column counts.
        part: which of the numbers of the cell, such as 1 for the second in `0 of 112`; cells with
            fewer are left out.
        where: heading and text of another cell of the row, such as `("family", "traps")`.
        take: makes one number of those of the rows.
        factor: from the table's unit to the sentence's.
        digits: significant digits to which the sentence rounds, if these are fewer than it shows.
    """

    page: str
    row: str | None
    column: str
    part: int = 0
    where: tuple[str, str] | None = None
    take: Callable[[list[float]], float] = sum
    factor: float = 1.0
    digits: int | None = None

    def value(self, root: Path) -> float:
        """The number that the page has.

        Args:
            root: of the repository.

        Raises:
            NotOnPageError: no such page, row, column or number.
        """
        for header, rows in tables(page_text(root, self.page)):
            needed = {self.column} if self.where is None else {self.column, self.where[0]}
            if not needed <= set(header):
                continue
            cells = [numbers(row[header.index(self.column)]) for row in self._chosen(header, rows)]
            found = [each[self.part] for each in cells if len(each) > self.part]
            if found:
                return self.factor * float(self.take(found))
        raise NotOnPageError(f"{self}: no such number")

    def _chosen(self, header: list[str], rows: list[list[str]]) -> list[list[str]]:
        """The rows that are meant."""
        chosen = [row for row in rows if self.row in (None, row[0])]
        if self.where is not None:
            heading, text = self.where
            chosen = [row for row in chosen if row[header.index(heading)] == text]
        return chosen

    def __str__(self) -> str:
        return f"{self.page}.md, {self.row or 'all rows'}, {self.column}"


@dataclass(frozen=True)
class Phrase:
    """A number in the text of a page.

    Attributes:
        page: name of the page in docs/benchmarks, without `.md`.
        words: text around it, `{}` where the number is; it occurs once.
        factor: from the page's unit to the sentence's.
        digits: as in `Cell`.
    """

    page: str
    words: str
    factor: float = 1.0
    digits: int | None = None

    def value(self, root: Path) -> float:
        """The number that the page has.

        Args:
            root: of the repository.

        Raises:
            NotOnPageError: no such page or words.
        """
        return self.factor * match(self.words.replace("{}", "{n}"), page_text(root, self.page))["n"]

    def __str__(self) -> str:
        return f"{self.page}.md, '{self.words}'"


@dataclass(frozen=True)
class Claim:
    """A sentence with numbers.

    Attributes:
        file: that states it, relative to the repository.
        sentence: as it stands there, `{name}` for each number; line breaks are blanks.
        found: by name, where the number comes from.
    """

    file: str
    sentence: str
    found: Mapping[str, Cell | Phrase]


@dataclass(frozen=True)
class Outcome:
    """A number of a claim.

    Attributes:
        claim: the claim.
        name: of the number in the sentence; empty if the sentence itself is missing.
        stated: number in the sentence; None if there is no such sentence.
        found: number on the page; None if there is none.
        source: where it comes from, or what is wrong.
        agree: whether both are the same, rounded as the sentence rounds.
    """

    claim: Claim
    name: str
    stated: str | None
    found: float | None
    source: str
    agree: bool

    def __str__(self) -> str:
        verdict = "ok    " if self.agree else "DIFFER"
        found = "-" if self.found is None else f"{self.found:.6g}"
        where = f"{self.claim.file}: {self.name} {self.stated or '-'}, found {found}"
        return f"{verdict} {where} ({self.source})"


def check(claims: list[Claim], root: Path = ROOT) -> list[Outcome]:
    """Compare every number of every claim.

    Args:
        claims: to be checked.
        root: of the repository.
    """
    return [outcome for claim in claims for outcome in _outcomes(claim, root)]


def _outcomes(claim: Claim, root: Path) -> Iterator[Outcome]:
    names = _PLACE.findall(claim.sentence)
    if sorted(names) != sorted(claim.found):
        raise ValueError(f"{claim.file}: names {names} in the sentence, {[*claim.found]} found")
    try:
        text = (root / claim.file).read_text(encoding="utf-8")
        stated = _texts(claim.sentence, text)
    except (OSError, NotOnPageError) as error:
        yield Outcome(claim, "", None, None, str(error), False)
        return
    for name in names:
        source = claim.found[name]
        try:
            value = source.value(root)
        except (OSError, NotOnPageError) as error:
            yield Outcome(claim, name, stated[name], None, str(error), False)
            continue
        agree = same(stated[name], value, source.digits)
        yield Outcome(claim, name, stated[name], value, str(source), agree)


def same(stated: str, found: float, digits: int | None = None) -> bool:
    """Whether a number as it is stated is another one, rounded.

    Args:
        stated: text of the number; its decimals tell how it is rounded.
        found: the other one.
        digits: significant digits of `stated`; None for all that it shows.
    """
    value = number(stated)
    unit = 10.0 ** -len(stated.partition(".")[2])
    if digits is not None and value:
        unit = max(unit, 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1))
    return abs(value - found) <= 0.5 * unit + 1e-9 * abs(value)


def match(sentence: str, text: str) -> dict[str, float]:
    """The numbers of a sentence in a text.

    Args:
        sentence: `{name}` where a number is.
        text: that has it once.

    Raises:
        NotOnPageError: it has not, or more than once.
    """
    return {name: number(value) for name, value in _texts(sentence, text).items()}


def _texts(sentence: str, text: str) -> dict[str, str]:
    """The same as they stand in the text."""
    parts = _PLACE.split(re.sub(r"\s+", " ", sentence))
    pattern = "".join(
        f"(?P<{part}>{_STATED})" if k % 2 else re.escape(part) for k, part in enumerate(parts)
    )
    found = list(re.finditer(rf"(?<![\d.]){pattern}", re.sub(r"\s+", " ", text)))
    if len(found) != 1:
        raise NotOnPageError(f"{len(found)} times instead of once: '{sentence}'")
    return found[0].groupdict()


def number(text: str) -> float:
    """A number whose thousands may be parted by blanks, or `none`."""
    return 0.0 if text == "none" else float(text.replace(" ", ""))


def numbers(text: str) -> list[float]:
    """All numbers of a text."""
    return [number(each) for each in re.findall(_NUMBER, text)]


def tables(text: str) -> Iterator[tuple[list[str], list[list[str]]]]:
    """Header and rows of each table of a markdown text."""
    for block in re.findall(r"(?:^\|.*\|[ ]*\n?)+", text, re.M):
        header, _, *rows = ([c.strip() for c in line[1:-1].split("|")] for line in _lines(block))
        yield header, rows


def _lines(block: str) -> list[str]:
    return [line.strip() for line in block.splitlines()]


def page_text(root: Path, page: str) -> str:
    """The text of a page in docs/benchmarks.

    Args:
        root: of the repository.
        page: its name without `.md`.
    """
    return (root / RESULTS / f"{page}.md").read_text(encoding="utf-8")
