"""The public API: names, documented fields, exported types, short representations."""

import ast
import dataclasses
import inspect
import subprocess
import sys
import typing

import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from typing_extensions import Self

import ffsr_plan as fp

RECORDS = [
    name
    for name in fp.__all__
    if dataclasses.is_dataclass(getattr(fp, name)) or hasattr(getattr(fp, name), "_fields")
]


def fields_of(record):
    if hasattr(record, "_fields"):
        return record._fields
    return [f.name for f in dataclasses.fields(record) if not f.name.startswith("_")]


def test_dir_lists_public_names_only():
    assert set(dir(fp)) == {*fp.__all__, "__version__"}


def test_type_checkers_see_the_names_that_are_loaded():
    source = ast.parse(inspect.getsource(fp))
    (typed,) = (node for node in source.body if isinstance(node, ast.If))
    seen = {each.name: node.module for node in typed.body for each in node.names}
    homes = {name: f"ffsr_plan.{module}" for name, module in fp._HOME.items()}
    modules = {name: f"ffsr_plan.{m}".rpartition(".")[0] for name, m in fp._MODULES.items()}
    assert seen == homes | modules
    assert set(seen) == set(fp.__all__)


@pytest.mark.parametrize("program", ["import ffsr_plan", "import ffsr_plan.cli"])
def test_an_import_alone_loads_no_library_that_takes_long(program):
    heavy = {"numpy", "pinocchio", "coal", "numba", "matplotlib", "scipy"}
    check = f"import sys; {program}; print(*sorted({heavy} & set(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True)
    assert (run.stdout, run.stderr) == ("\n", "")


@pytest.mark.parametrize("name", RECORDS)
def test_every_field_of_a_public_record_has_its_text(name):
    record = getattr(fp, name)
    text = "\n".join(inspect.getdoc(kind) or "" for kind in record.__mro__[:-1])
    for field in fields_of(record):
        assert f"{field}: " in text, field


def public_methods():
    for name in fp.__all__:
        thing = getattr(fp, name)
        if inspect.isfunction(thing):
            yield name, thing
        elif inspect.isclass(thing):
            for member, function in inspect.getmembers(thing, inspect.isfunction):
                if not member.startswith("_"):
                    yield f"{name}.{member}", function


def own_types(annotation):
    if inspect.isclass(annotation) and annotation.__module__.startswith("ffsr_plan"):
        yield annotation
    for part in typing.get_args(annotation):
        yield from own_types(part)


def test_types_that_public_functions_return_are_public():
    named = {name: getattr(fp, name) for name in fp.__all__}
    public = set(named.values())
    # what modules name for type checkers only
    foreign = {"Axes": Axes, "Figure": Figure, "Self": Self, "Client": object}
    for name, function in public_methods():
        namespace = vars(inspect.getmodule(function)) | foreign | named
        hints = typing.get_type_hints(function, namespace)
        for kind in own_types(hints.get("return")):
            assert kind in public, f"{name} returns {kind.__name__}"


def test_objects_show_themselves_in_one_line(fig2a_plan):
    problem = fig2a_plan.problem
    for thing in (fig2a_plan, problem, problem.robot, problem.scene):
        text = repr(thing)
        assert "\n" not in text
        assert len(text) < 200, text
        html = thing._repr_html_()
        assert "<table" in html
        assert len(html) < 5_000
