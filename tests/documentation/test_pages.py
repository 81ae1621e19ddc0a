"""The documentation says what is so: its code runs, prints what it shows, and has every name."""

import ast
import contextlib
import io
import re
import shlex
import webbrowser

import pytest
from typer.testing import CliRunner

import ffsr_plan as fp
from ffsr_plan.cli import app
from ffsr_plan.display.page_server import PageServer
from ffsr_plan.scenario_files.scenario_tables import schema
from tests.helpers.documentation_pages import PAGES, ROOT, blocks, title

_LINK = re.compile(r"\]\((?!https?://|#)(?P<path>[^)#\s]+)(?:#[^)]*)?\)")


def with_blocks(*kinds):
    """Pages that have such blocks; those of the README plan the longest."""
    return [
        pytest.param(page, id=title(page), marks=[pytest.mark.slow] * (page.name == "README.md"))
        for page in PAGES
        if blocks(page, *kinds)
    ]


@pytest.fixture(autouse=True)
def nobody_looks(monkeypatch):
    """No browser opens, and pages are not waited for."""

    def none():
        raise webbrowser.Error

    monkeypatch.setattr(webbrowser, "get", none)
    monkeypatch.setattr(PageServer, "wait", PageServer.stop)


@pytest.mark.parametrize("page", with_blocks("python"))
def test_the_code_on_a_page_runs_and_prints_what_stands_under_it(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in blocks(page, "python"):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block.text, title(page), "exec"), names)
        if block.shown is not None:
            assert printed.getvalue() == block.shown


@pytest.mark.parametrize("page", with_blocks("sh"))
def test_the_commands_on_a_page_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for block in blocks(page, "sh"):
        for line in block.text.splitlines():
            words = shlex.split(line.split(" > ")[0], comments=True)
            if words[:1] == ["ffsr-plan"]:
                force = ["--force"] if "--out" in words else []
                result = CliRunner().invoke(app, [*words[1:], *force])
                assert result.exit_code == 0, (line, result.output)


@pytest.mark.parametrize("page", with_blocks("toml"))
def test_the_scenarios_on_a_page_can_be_planned(page, tmp_path):
    for block in blocks(page, "toml"):
        file = tmp_path / "scenario.toml"
        file.write_text(block.text)
        assert fp.plan(fp.load_scenario(file), fp.LatticeOptimum()).verify(50).ok


def test_the_table_of_scenario_keys_has_all_of_them():
    text = (ROOT / "docs/howto/scene.md").read_text().split("### All keys")[1]
    rows = [line.split("|")[2] for line in text.splitlines() if line.startswith("|")]
    listed = {key for row in rows for key in re.findall(r"`(\w+)`", row)}
    scenario = schema()
    tables = {name: entry for name, entry in scenario["properties"].items() if name != "planner"}
    known = {key for entry in tables.values() for key in keys_of(entry, scenario["$defs"])}
    assert listed == known | {"title", "name", "seed", "refine"}  # a planner's own are listed there


def keys_of(entry, definitions):
    """Keys of the tables that an entry of a JSON Schema refers to, not of those within them."""
    inner = [*entry.get("anyOf", []), *([entry["items"]] if "items" in entry else [])]
    keys = {key for each in inner for key in keys_of(each, definitions)}
    if "$ref" in entry:
        keys |= set(definitions[entry["$ref"].rpartition("/")[2]]["properties"])
    return keys


def test_every_public_name_stands_in_the_reference_once():
    text = "".join(page.read_text() for page in (ROOT / "docs/api").glob("*.md"))
    entries = re.findall(r"^::: ffsr_plan\.(\w+)$", text, re.M)
    assert sorted(set(entries) & set(fp.__all__)) == sorted(fp.__all__)
    assert len(set(entries)) == len(entries)


def test_every_public_name_says_what_it_is():
    for name in fp.__all__:
        assert (getattr(fp, name).__doc__ or "").strip(), name


@pytest.mark.parametrize("page", [pytest.param(page, id=title(page)) for page in PAGES])
def test_links_between_files_lead_somewhere_in_the_repository_too(page):
    for link in _LINK.finditer(page.read_text(encoding="utf-8")):
        target = (page.parent / link["path"]).resolve()
        assert target.is_relative_to(ROOT), link[0]
        assert target.exists(), link[0]


def test_python_that_is_shown_but_not_run_is_at_least_python():
    for page in PAGES:
        for block in blocks(page, "py"):
            ast.parse(block.text)


def test_every_benchmark_table_is_listed_with_its_command():
    index = (ROOT / "docs/benchmarks/README.md").read_text()
    for table in (ROOT / "docs/benchmarks").glob("*.md"):
        if table.name != "README.md":
            assert re.search(rf"`python -m benchmarks\.[\w.]+`.*\]\({table.name}\)", index), (
                table.name
            )
