"""Pages of the documentation: code, output, scenarios, links and the list of public names."""

import ast
import contextlib
import io
import json
import re
import shlex
import webbrowser
from pathlib import Path

import pytest
from typer.testing import CliRunner

import ffsr_plan as fp
from ffsr_plan.cli import app
from ffsr_plan.display.web.page_server import PageServer
from tests.helpers.documentation_pages import PAGES, ROOT, blocks, title

SLOW_PAGES = ("command_line.md", "manipulator.md", "planning.md")
_LINK = re.compile(r"\]\((?!https?://|#)(?P<path>[^)#\s]+)(?:#[^)]*)?\)")


def with_blocks(*kinds):
    """Pages that have such blocks; the commands of one page plan all bundled scenarios."""
    return [
        pytest.param(page, id=title(page), marks=[pytest.mark.slow] * (page.name in SLOW_PAGES))
        for page in PAGES
        if blocks(page, *kinds)
    ]


@pytest.fixture(autouse=True)
def no_browser(monkeypatch):
    """No browser opens, and served pages stop at once."""

    def none():
        raise webbrowser.Error

    monkeypatch.setattr(webbrowser, "get", none)
    monkeypatch.setattr(PageServer, "wait", lambda server, _="": server.stop())


@pytest.mark.parametrize("page", with_blocks("python"))
def test_code_on_a_page_runs_and_prints_the_output_below_it(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in blocks(page, "python"):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block.text, title(page), "exec"), names)
        if block.shown is not None:
            assert printed.getvalue() == block.shown


def is_study(block):
    """Whether a file on a page describes a study; the commands below it run two scenes of it."""
    return "[scenario." in block.text


@pytest.mark.parametrize("page", with_blocks("sh"))
def test_the_commands_on_a_page_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for block in filter(is_study, blocks(page, "toml")):
        Path("scenes.toml").write_text(block.text.replace("count = 50", "count = 2"))
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
        if is_study(block):
            (tmp_path / "scenes.toml").write_text(block.text)
            assert len(fp.Study.load(tmp_path / "scenes.toml")) > 1
            continue
        file = tmp_path / "scenario.toml"
        file.write_text(block.text)
        assert fp.plan(fp.load_scenario(file), fp.LatticeOptimum()).verify(50).ok


def test_the_table_of_scenario_keys_has_all_of_them():
    text = (ROOT / "docs/howto/scene.md").read_text().split("### All keys")[1]
    rows = [line.split("|")[2] for line in text.splitlines() if line.startswith("|")]
    listed = {key for row in rows for key in re.findall(r"`(\w+)`", row)}
    schema = json.loads(CliRunner().invoke(app, ["schema"]).stdout)
    known = {"title", "name", "seed", "refine"}  # the settings of planners are listed elsewhere
    for key, value in schema["properties"].items():
        if key != "planner":
            known |= {name for table in tables(value, schema) for name in table["properties"]}
    assert listed == known


def tables(value, schema):
    """The tables that a value of a JSON schema may be, or that its items may be."""
    if "$ref" in value:
        return [schema["$defs"][value["$ref"].rpartition("/")[2]]]
    options = value.get("anyOf", []) + value.get("oneOf", []) + [value.get("items", {})]
    return [table for option in options if option for table in tables(option, schema)]


def test_every_public_name_is_in_the_reference_once():
    text = "".join(page.read_text() for page in (ROOT / "docs/api").glob("*.md"))
    entries = re.findall(r"^::: ffsr_plan\.(\w+)$", text, re.M)
    assert sorted(set(entries) & set(fp.__all__)) == sorted(fp.__all__)
    assert len(set(entries)) == len(entries)


def test_every_public_name_has_a_docstring():
    for name in fp.__all__:
        assert (getattr(fp, name).__doc__ or "").strip(), name


@pytest.mark.parametrize("page", [pytest.param(page, id=title(page)) for page in PAGES])
def test_links_between_files_exist_in_the_repository(page):
    for link in _LINK.finditer(page.read_text(encoding="utf-8")):
        target = (page.parent / link["path"]).resolve()
        assert target.is_relative_to(ROOT), link[0]
        assert target.exists(), link[0]


def test_python_that_is_not_run_can_be_parsed():
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


@pytest.mark.parametrize(("page", "lines"), [("README.md", 150), ("CONTRIBUTING.md", 80)])
def test_pages_for_newcomers_stay_short(page, lines):
    assert len((ROOT / page).read_text(encoding="utf-8").splitlines()) <= lines
