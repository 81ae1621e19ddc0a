"""Every example runs from nothing and writes the files that its docstring names."""

import ast
import re
import runpy
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "examples"
EXAMPLES = sorted(FOLDER.glob("[0-9]*.py"))


def written_files(path):
    """Names of the files in the paragraph of the docstring that begins with `Writes`."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    return re.findall(r"`([\w.]+\.\w+)`", text.split("Writes")[1])


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_writes_its_files(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = written_files(path)
    assert names
    runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out
    for name in names:
        assert (tmp_path / name).stat().st_size > 100


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_uses_public_names_only(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module.startswith("ffsr_plan"):
            assert node.module == "ffsr_plan.display"
        if isinstance(node, ast.Attribute):
            assert not node.attr.startswith("_") or node.attr == "__name__"
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 65


def test_a_study_resumes_where_it_ended(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    script = str(FOLDER / "11_parameter_study.py")
    runpy.run_path(script, run_name="__main__")
    lines, table = Path("study.jsonl").read_text().splitlines(), capsys.readouterr().out
    Path("study.jsonl").write_text("\n".join(lines[:20]) + "\n")
    runpy.run_path(script, run_name="__main__")
    assert Path("study.jsonl").read_text().splitlines() == lines
    assert capsys.readouterr().out == table
