"""Numbers in the documentation are those of the tables, and a changed one is noticed."""

import re
import shutil
import sys

import pytest

from benchmarks import remake
from benchmarks.claim_check import ROOT, Cell, Claim, Phrase, check, same
from benchmarks.claims import CLAIMS

PAGE = """# Gap

Measured on 27 of 28 problems.

| planner | where | runs | above | deepest |
| --- | ---: | ---: | ---: | ---: |
| ants | a | 1008 | 25.49 % | 3 (6.3 mm) |
| ants, plain | b | 1008 | 0.04 % | 0 |
"""
SENTENCE = (
    "Over 1 008\nruns on 27 problems the ants are 25 % above, none at last; 3 times, 6 mm deep."
)
CLAIM = Claim(
    "text.md",
    "Over {runs} runs on {problems} problems the ants are {above} % above, {last} at last; "
    "{times} times, {deep} mm deep",
    {
        "runs": Cell("gap", "ants", "runs"),
        "problems": Phrase("gap", "Measured on {} of 28 problems"),
        "above": Cell("gap", "ants", "above"),
        "last": Cell("gap", None, "deepest", where=("where", "b")),
        "times": Cell("gap", None, "deepest"),
        "deep": Cell("gap", None, "deepest", part=1, take=max),
    },
)


def differing(root, sentence=SENTENCE, page=PAGE):
    """Names of the numbers that differ."""
    (root / "docs/benchmarks").mkdir(parents=True, exist_ok=True)
    (root / "docs/benchmarks/gap.md").write_text(page)
    (root / "text.md").write_text(f"Before.\n\n{sentence}\n")
    return [outcome.name for outcome in check([CLAIM], root) if not outcome.agree]


def test_every_claim_is_what_its_table_has():
    outcomes = check(CLAIMS)
    assert len(outcomes) > 40
    assert not [str(outcome) for outcome in outcomes if not outcome.agree]


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ("1 008", "1 009", "runs"), ("27", "28", "problems"), ("25 %", "26 %", "above"),
        ("none", "1", "last"), ("3 times", "2 times", "times"), ("6 mm", "7 mm", "deep"),
        ("25 %", "25.4 %", "above"), ("the ants", "all ants", ""),
        (SENTENCE, f"{SENTENCE} {SENTENCE}", ""),
    ],
)  # fmt: skip
def test_a_changed_number_of_a_sentence_is_found(tmp_path, old, new, name):
    assert differing(tmp_path) == []
    assert differing(tmp_path, SENTENCE.replace(old, new)) == [name]


@pytest.mark.parametrize(
    ("old", "new", "names"),
    [
        ("| ants | a | 1008", "| ants | a | 1007", ["runs"]), ("27 of", "26 of", ["problems"]),
        ("25.49", "25.51", ["above"]), ("6.3 mm", "6.6 mm", ["deep"]),
        ("| 0 |", "| 1 |", ["last", "times"]), ("| above |", "| below |", ["above"]),
        ("| ants |", "| bees |", ["runs", "above"]),
    ],
)  # fmt: skip
def test_a_changed_table_is_found(tmp_path, old, new, names):
    assert old in PAGE
    assert differing(tmp_path, page=PAGE.replace(old, new)) == names


def test_a_page_that_is_missing_is_found(tmp_path):
    differing(tmp_path)
    (tmp_path / "docs/benchmarks/gap.md").unlink()
    assert not any(outcome.agree for outcome in check([CLAIM], tmp_path))


@pytest.mark.parametrize(
    ("stated", "found", "digits", "agree"),
    [
        ("25", 25.49, None, True), ("25", 25.51, None, False), ("0.2", 0.186, None, True),
        ("20", 19.0, None, False), ("20", 19.0, 1, True), ("20", 26.0, 1, False),
        ("-0.1", 0.1, None, False), ("2 000", 2000.0, None, True), ("none", 0.4, None, True),
        ("0", 1.0, 1, False),
    ],
)  # fmt: skip
def test_a_number_is_rounded_as_its_sentence_rounds(stated, found, digits, agree):
    assert same(stated, found, digits) is agree


def test_a_claim_that_differs_ends_the_command_with_status_1(monkeypatch, tmp_path, capsys):
    for file in {claim.file for claim in CLAIMS}:
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / file, tmp_path / file)
    shutil.copytree(ROOT / "docs/benchmarks", tmp_path / "docs/benchmarks", dirs_exist_ok=True)
    monkeypatch.setattr(remake, "check", lambda claims: check(claims, tmp_path))
    monkeypatch.setattr(sys, "argv", ["remake", "--check"])
    with pytest.raises(SystemExit) as ended:
        remake.main()
    assert ended.value.code == 0
    text = (tmp_path / "docs/benchmarks/gap.md").read_text()
    changed = re.sub(r"(\| AntSystem \| \d+ \| )\d+", r"\g<1>77", text)
    (tmp_path / "docs/benchmarks/gap.md").write_text(changed)
    with pytest.raises(SystemExit) as ended:
        remake.main()
    assert ended.value.code == 1
    assert re.search(r"DIFFER docs/paper.md: median .*, found 77", capsys.readouterr().out)


@pytest.mark.parametrize("page", remake.PAGES)
def test_the_command_of_a_page_has_options_that_its_study_has(page):
    _, module, *options = remake.command_of(page)
    study = (ROOT / f"{module.replace('.', '/')}.py").read_text()
    for option in options:
        if option.startswith("--"):
            of_all = option == "--problems" and "add_problems_option(parser" in study
            assert f'"{option}"' in study or of_all, option


def test_every_study_of_the_family_is_made_again():
    known = {remake.command_of(page)[1] for page in remake.PAGES}
    scenes = re.compile(r"paper_scenes import (?:\([^)]*|.*)\b(?:paper_problem|cases)\b")
    studies = [
        ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for path in (ROOT / "benchmarks/studies").rglob("*.py")
        if scenes.search(path.read_text())
    ]
    assert len(studies) == len(known) - 1  # that of the whole set draws them by name
    assert set(studies) < known
