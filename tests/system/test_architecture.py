"""The floors of the package: imports lead down, modules form no circle, folders stay small."""

import ast
import sys
from pathlib import Path

import pytest

import ffsr_plan as fp
from tools.architecture import PACKAGE, floors, folder_of, imports, modules

MOST_FILES, MOST_LINES, MOST_LINES_OF_FUNCTION, MOST_CALLS = 12, 400, 60, 12


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


ARITHMETIC = (
    "core/", "time_limit/", "collision/", "robots/kinematics", "dynamics/momentum",
    "dynamics/reaction", "dynamics/actuation_mode", "proof/link_bounds", "proof/travel_bound",
)  # fmt: skip


def depth_of_calls(job):
    """Calls on the stack of `job` down to the first one into the arithmetic, at most."""
    deepest, stack, prefix = [], [], f"{PACKAGE}/"

    def look(frame, event, _):
        file, name = frame.f_code.co_filename, frame.f_code.co_name
        if event not in ("call", "return") or not file.startswith(prefix) or name[0] == "<":
            return
        if event == "return":
            stack.pop()
            return
        above_arithmetic = not stack or not stack[-1][0].startswith(ARITHMETIC)
        stack.append((file[len(prefix) :], name))
        if above_arithmetic and len(stack) > len(deepest):
            deepest[:] = stack

    sys.setprofile(look)
    try:
        job()
    finally:
        sys.setprofile(None)
    return deepest


@pytest.mark.parametrize(
    ("scenario", "planner"),
    [
        ("inspection", fp.MaxMinAntSystem(cycles=3)),
        ("inspection", fp.LatticeOptimum()),
        ("fig2a", fp.AntSystem(ants=3, cycles=2)),
        ("gate", fp.PostureAnnealing(ants=3, cycles=2, annealing_shifts=20)),
    ],
)
def test_a_plan_is_few_calls_away_from_its_arithmetic(scenario, planner):
    problem = fp.load_scenario(scenario)
    fp.plan(problem, planner)  # compile first
    stack = depth_of_calls(lambda: fp.plan(problem, planner))
    assert stack[0] == ("planning/plan_and_refine.py", "plan")
    assert len(stack) <= MOST_CALLS, " > ".join(name for _, name in stack)
