"""Settings check, convert and describe their fields, from arguments and from tables alike."""

from __future__ import annotations

import dataclasses
import inspect
import pickle
import subprocess
import sys
from typing import Annotated

import numpy as np
import pytest
from pydantic import TypeAdapter

import ffsr_plan as fp
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import (
    ByKey,
    NamedNumbers,
    NoneMeans,
    Number,
    Numbers,
    OneOf,
    Text,
    Truth,
    Vector,
    WholeNumber,
)
from ffsr_plan.core.settings import Given, field_descriptions, part_of, setting, settings


@settings
class Step:
    """A step.

    Attributes:
        count: number of
            repetitions.
        size: [m].
    """

    count: Annotated[int, WholeNumber(at_least=1, at_most=9)]
    size: Annotated[float, Number(above=0.0, at_most=10.0)] = 2.0


@settings
class Pause:
    """A pause."""

    seconds: Annotated[float, Number(at_least=0.0)]


@settings(of="the walk")
class Walk:
    """A walk."""

    begin: Annotated[Vector, Numbers(3)]
    steps: tuple[Annotated[Step | Pause, ByKey(count=Step, seconds=Pause)], ...] = ()
    first: Annotated[Given[Step, Step | None], NoneMeans(lambda: Step(5))] = setting(default=None)
    pace: Annotated[str, OneOf(("slow", "fast"))] = "slow"
    backwards: Annotated[bool, Truth()] = False
    title: Annotated[str, Text("a title", empty=False)] = "untitled"
    loads: Annotated[dict[str, float], NamedNumbers()] = dataclasses.field(default_factory=dict)
    limit: Annotated[float, Number(below=1.0)] | None = None

    def __post_init__(self):
        if self.backwards and self.pace == "fast":
            raise InvalidInput("backwards", True, "False at a fast pace")


def test_arguments_are_converted():
    walk = Walk((1, 2, 3), [Step(1), {"seconds": 2}], first=None)
    assert walk.begin.dtype == np.float64
    assert not walk.begin.flags.writeable
    assert walk.steps == (Step(1), Pause(2.0))
    assert walk.first == Step(5)
    assert isinstance(Step(np.int64(3), np.float32(1)).count, int)


REFUSED = [
    (lambda: Step(True), "count: got True; allowed: a whole number of at least 1 and at most 9"),
    (lambda: Step(1, "2"), "size: got '2'; allowed: a finite number and greater than 0"),
    (lambda: Step(1, size=np.nan), "size: got nan"),
    (lambda: Step(), "count: got None; allowed: a value: it is required"),
    (lambda: Step(1, 2, 3), r"arguments: got \(1, 2, 3\); allowed: at most 2: count, size"),
    (lambda: Step(1, count=2), "count: got 2; allowed: one value, not two"),
    (lambda: Step(1, sise=2), r"unknown key: got 'sise'; .*\(did you mean 'size'\?\)"),
    (lambda: Step(sise=2), "unknown key: got 'sise'"),
    (lambda: Walk((1, 2)), r"begin of the walk \(shape \(2,\)\): got \(1, 2\)"),
    (lambda: Walk(["1", "2", "3"]), r"begin of the walk: .*shape \(3\)"),
    (lambda: Walk((1, 2, 3), 5), "steps of the walk: got 5; allowed: a list"),
    (lambda: Walk((1, 2, 3), [5]), r"steps\.0 of the walk: got 5; .*Step or Pause"),
    (lambda: Walk((1, 2, 3), [{"count": 0}]), r"steps\.0\.count of the walk: got 0"),
    (lambda: Walk((1, 2, 3), [{"cont": 1}]), r"'steps\.0\.cont'.*did you mean 'steps\.0\.count'"),
    (lambda: Walk((1, 2, 3), [{"count": 1, "siz": 1}]), r"did you mean 'steps\.0\.size'"),
    (lambda: Walk((1, 2, 3), [{"size": 1}]), r"steps\.0\.count of the walk: .*required"),
    (lambda: Walk((1, 2, 3), [{}]), r"steps\.0 of the walk: got 'no key'; .*one of count, sec"),
    (lambda: Walk((1, 2, 3), [{"count": 1, "seconds": 1}]), "got 'count, seconds'"),
    (lambda: Walk((1, 2, 3), first=3), r"first of the walk: got 3; allowed: Step\(count, size\)"),
    (lambda: Walk((1, 2, 3), pace="fasst"), "pace of the walk: .*did you mean 'fast'"),
    (lambda: Walk((1, 2, 3), title=""), "title of the walk: got ''; allowed: a title"),
    (lambda: Walk((1, 2, 3), loads=[1]), "loads of the walk: .*joint names with their values"),
    (lambda: Walk((1, 2, 3), loads={"a": "b"}), r"loads\.a of the walk: got 'b'"),
    (lambda: Walk((1, 2, 3), limit=1), "limit of the walk: got 1; .*less than 1"),
    (lambda: Walk((1, 2, 3), pace="fast", backwards=True), "backwards of the walk: got True"),
    (lambda: dataclasses.replace(Step(1), size=-1), "size: got -1"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED, ids=range(len(REFUSED)))
def test_a_refused_argument_is_named(make, message):
    with pytest.raises(InvalidInput, match=message) as caught:
        make()
    assert caught.value.__context__ is None
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)


def test_errors_are_pickled_with_all_that_dask_adds_to_them():
    pytest.importorskip("distributed.utils")  # pickles an error's context and traceback from now on
    for make, _ in REFUSED:
        with pytest.raises(InvalidInput) as caught:
            make()
        assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_settings_are_frozen_dataclasses():
    step = Step(1)
    with pytest.raises(dataclasses.FrozenInstanceError):
        step.count = 2
    assert dataclasses.replace(step, count=2) == Step(2)
    assert dataclasses.asdict(step) == {"count": 1, "size": 2.0}
    assert pickle.loads(pickle.dumps(step)) == step
    assert hash(step) == hash(Step(1))
    assert list(inspect.signature(Step).parameters) == ["count", "size"]


def test_settings_that_hold_arrays_are_equal_by_content():
    walk, same, other = Walk((1, 2, 3)), Walk((1.0, 2.0, 3.0)), Walk((1, 2, 4))
    assert walk == same
    assert hash(walk) == hash(same)
    assert walk != other
    assert walk != Step(1)


def test_a_field_that_may_be_none_says_so():
    with pytest.raises(InvalidInput, match=r"limit of the walk: .*less than 1, or None"):
        Walk((1, 2, 3), limit=1)


def test_the_entry_of_a_list_is_named_by_its_field():
    with pytest.raises(InvalidInput, match=r"^temperatures\.0\.1: got 0; "):
        fp.PostureAnnealing(temperatures=[(1.0, 0)])


def test_a_nearest_name_may_differ_in_the_case_of_its_letters():
    with pytest.raises(InvalidInput, match="did you mean 'Q'"):
        fp.AntSystem(q=3.0)


def test_the_json_schema_holds_ranges_and_descriptions():
    schema = TypeAdapter(Step).json_schema()
    assert schema["required"] == ["count"]
    assert schema["additionalProperties"] is False
    count, size = schema["properties"]["count"], schema["properties"]["size"]
    assert (count["type"], count["minimum"], count["maximum"]) == ("integer", 1, 9)
    assert (size["type"], size["exclusiveMinimum"], size["maximum"]) == ("number", 0.0, 10.0)
    assert size["default"] == 2.0
    assert count["description"] == "number of repetitions."
    assert schema["description"] == "A step."
    assert field_descriptions(Step) == {"count": "number of repetitions.", "size": "[m]."}


def test_a_part_has_the_rules_and_descriptions_of_the_whole():
    part = part_of(Step, "Part", "A part.", ["size"])
    assert part().size == 2.0
    assert field_descriptions(part) == {"size": "[m]."}
    with pytest.raises(InvalidInput, match="size: got 0"):
        part(size=0)
    with pytest.raises(InvalidInput, match="unknown key: got 'count'"):
        part(count=1)


def test_settings_import_pydantic_when_the_first_object_is_made():
    code = (
        "import sys, ffsr_plan as fp; assert 'pydantic' not in sys.modules;"
        "fp.Axis(1, 0.1); assert 'pydantic' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_an_unknown_key_of_a_nested_setting_names_its_table():
    problem = fp.load_scenario("fig2a")
    with pytest.raises(fp.InvalidInput, match=r"did you mean 'lattice\.divisions'"):
        dataclasses.replace(problem, lattice={"divisons": 10})
    with pytest.raises(fp.InvalidInput, match=r"lattice\.latral.*did you mean 'lattice.lateral'"):
        dataclasses.replace(problem, lattice={"latral": {"half_count": 1, "spacing": 1.0}})
