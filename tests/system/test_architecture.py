"""The floors of the package: imports lead down, modules form no circle, folders stay small."""

import ast
from pathlib import Path

import pytest

from tools.architecture import PACKAGE, floors, folder_of, imports, modules

MOST_FILES, MOST_LINES, MOST_LINES_OF_FUNCTION = 12, 400, 60


def test_every_folder_has_a_floor():
    assert {folder_of(name) for name in modules()} - {""} == {
        folder for floor in floors() for folder in floor
    }


def test_no_folder_imports_from_its_own_floor_or_above():
    height = {folder: k for k, floor in enumerate(floors()) for folder in floor}
    height[""] = len(height)  # the package's own `__init__`
    wrong = [
        f"{name} imports {target}"
        for name, targets in imports().items()
        for target in targets
        if folder_of(name) != folder_of(target)
        and height[folder_of(target)] >= height[folder_of(name)]
    ]
    assert not wrong


def test_modules_import_one_another_in_no_circle():
    left = {name: set(targets) for name, targets in imports().items()}
    while left:
        leaves = [name for name, targets in left.items() if not targets & left.keys()]
        assert leaves, f"circle among {sorted(left)}"
        for name in leaves:
            del left[name]


def test_an_upward_import_would_be_noticed(tmp_path):
    (tmp_path / "core").mkdir()
    text = "def f():\n    from ffsr_plan.cli import main\n    return main\n"
    (tmp_path / "core" / "low.py").write_text(text)
    assert imports(tmp_path)["core.low"] == {"cli"}


@pytest.mark.parametrize("folder", sorted({path.parent for path in PACKAGE.rglob("*.py")}))
def test_a_folder_holds_at_most_a_dozen_modules(folder):
    assert len(list(folder.glob("*.py"))) <= MOST_FILES


def test_modules_have_a_docstring_and_stay_short():
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert ast.get_docstring(ast.parse(text)), path
        assert len(text.splitlines()) <= MOST_LINES, path


def test_functions_stay_short():
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                lines = node.end_lineno - node.lineno + 1
                assert lines <= MOST_LINES_OF_FUNCTION, f"{path}: {node.name}, {lines} lines"


def test_the_picture_shows_the_floors():
    picture = Path(__file__).parents[2] / "docs" / "architecture.svg"
    text = picture.read_text(encoding="utf-8")
    for floor in floors():
        for folder, purpose in floor.items():
            assert f">{folder}<" in text
            assert purpose in text
