"""What users give a study, checked: problems, planners, seeds and limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ffsr_plan.core.checks import number, one_of, text, truth, whole_number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.plans.planner_registry import PLANNERS
from ffsr_plan.problem.problem import Problem
from ffsr_plan.scenario_files.scenario import load_scenario
from ffsr_plan.studies.tasks.canonical import planner_description
from ffsr_plan.studies.tasks.grid import NamedPlanner
from ffsr_plan.studies.tasks.sources import GivenProblem

MOST_SEEDS = 10**7
LARGEST_SEED = 2**63 - 1
"""The largest integer that SQLite holds."""
BYTES_PER_GB = 10**9
Given = Problem | str
GivenProblems = Mapping[str, Given] | Sequence[Given] | Given
GivenAxes = Mapping[str, Mapping[str, Any]]
GivenPlanners = Mapping[str, Any] | Sequence[Any] | Any


def given_problems(problems: GivenProblems, axes: GivenAxes | None) -> tuple[GivenProblem, ...]:
    """The problems of a study.

    Args:
        problems: by name; or a list, in which scenarios have their own names and other problems
            are numbered from 1; or one.
        axes: values of axes by name, by the name of the problem; or None.

    Raises:
        InvalidInput: no problems, what is none, or axes of a problem that is not there.
    """
    if isinstance(problems, (str, Problem)):
        problems = [problems]
    if isinstance(problems, Mapping):
        named = dict(problems)
    elif isinstance(problems, (list, tuple)):
        pairs = [
            (each if isinstance(each, str) else f"problem {k}", each)
            for k, each in enumerate(problems, 1)
        ]
        named = _without_twins("problems", pairs)
    else:
        raise InvalidInput("problems", problems, "problems by name, or a list of problems")
    if not named:
        raise InvalidInput("problems", problems, "at least one problem")
    values = _axes(axes, list(named))
    found = []
    for name, each in named.items():
        what = f"problems.{_name('name of a problem', name)}"
        made = load_scenario(each) if isinstance(each, str) else each
        if not isinstance(made, Problem):
            raise InvalidInput(what, each, "a Problem, or the name or path of a scenario")
        found.append(GivenProblem(name, made, values.get(name, {})))
    return tuple(found)


def _axes(axes: object, names: Sequence[str]) -> Mapping[str, Mapping[str, Any]]:
    if axes is None:
        return {}
    allowed = "mappings of axis names to numbers and texts, by the name of the problem"
    if not isinstance(axes, Mapping):
        raise InvalidInput("axes", axes, allowed)
    for name, values in axes.items():
        one_of("axes, name of a problem", name, names)
        if not isinstance(values, Mapping):
            raise InvalidInput(f"axes.{name}", values, allowed)
        for axis, value in values.items():
            _name(f"axes.{name}, name of an axis", axis)
            if not isinstance(value, (str, bool, int, float)):
                raise InvalidInput(f"axes.{name}.{axis}", value, "a number or a text")
            if isinstance(value, (int, float)):
                number(f"axes.{name}.{axis}", float(min(max(value, -1e300), 1e300)))
    return axes


def given_planners(planners: GivenPlanners, refine: object) -> tuple[NamedPlanner, ...]:
    """The planners of a study.

    Args:
        planners: by name, or a list, in which each has its own name; settings of planners, their
            names, None for the default of the problem, or objects of other kinds.
        refine: whether to refine, for all planners or by the planner's name; None for the default.

    Raises:
        InvalidInput: no planners, two of one name, or what is no planner.
    """
    if isinstance(planners, Mapping):
        named = dict(planners)
    else:
        listed = list(planners) if isinstance(planners, (list, tuple)) else [planners]
        named = _without_twins("planners", [(planner_name(each), each) for each in listed])
    if not named:
        raise InvalidInput("planners", planners, "at least one planner")
    refined: Mapping[str, Any] = dict.fromkeys(named, refine)
    if isinstance(refine, Mapping):
        for name in refine:
            one_of("refine, name of a planner", name, list(named))
        refined = refine
    found = []
    for name, each in named.items():
        _name("name of a planner", name)
        wanted = refined.get(name)
        wanted = None if wanted is None else truth(f"refine of {name}", wanted)
        found.append(NamedPlanner(name, _planner(f"planners.{name}", each), wanted))
    return tuple(found)


def planner_name(planner: object) -> str:
    """The name of a planner that was given without one.

    Args:
        planner: settings, a name, None for the default, or an object of another kind.
    """
    if planner is None:
        return "default"
    if isinstance(planner, str):
        return planner
    found = getattr(planner, "name", None) or getattr(planner, "__name__", None)
    return found if isinstance(found, str) else type(planner).__name__


def _planner(what: str, planner: object) -> Any:  # noqa: ANN401 - also planners of others
    if planner is None or isinstance(planner, tuple(PLANNERS.values())):
        return planner
    if isinstance(planner, str):
        return PLANNERS[one_of(what, planner, list(PLANNERS))]()
    if isinstance(planner, type) or not callable(getattr(planner, "plan", planner)):
        allowed = "a planner, its name, None for the default, or an object with a method `plan` "
        raise InvalidInput(what, planner, f"{allowed}or a function of a problem and a seed")
    try:
        planner_description(planner)
    except Exception as error:  # a lambda and an open file, for example, cannot be pickled
        raise InvalidInput(what, planner, f"a planner that can be pickled ({error})") from None
    return planner


def given_seeds(seeds: object) -> tuple[int, ...] | range:
    """The seeds of a study.

    Args:
        seeds: a number of seeds, counted from 0; a range, or a list of different seeds.

    Raises:
        InvalidInput: none, two that are equal, or what is no seed.
    """
    if isinstance(seeds, range):
        seeds = tuple(seeds[:MOST_SEEDS]) if seeds.step < 0 else seeds
    if isinstance(seeds, range):
        if not seeds or seeds[0] < 0 or seeds[-1] > LARGEST_SEED:
            raise InvalidInput("seeds", seeds, "a range of at least one whole number >= 0")
        return seeds
    if isinstance(seeds, (list, tuple)):
        found = tuple(
            whole_number(f"seeds.{k}", each, at_least=0, at_most=LARGEST_SEED)
            for k, each in enumerate(seeds)
        )
        if not found or len(set(found)) < len(found):
            raise InvalidInput("seeds", seeds, "at least one seed, and no seed twice")
        return found
    return range(whole_number("seeds", seeds, at_least=1, at_most=MOST_SEEDS))


def given_time_limit(limit: object, names: Sequence[str]) -> Mapping[str, float] | float | None:
    """The time limit of a plan [s].

    Args:
        limit: for all problems, or by the name of the problem; None for no limit.
        names: of the problems.

    Raises:
        InvalidInput: what is no time, or the name of no problem.
    """
    if limit is None:
        return None
    if not isinstance(limit, Mapping):
        return number("time_limit", limit, above=0.0)
    for name in limit:
        one_of("time_limit, name of a problem", name, names)
    return {name: number(f"time_limit.{name}", each, above=0.0) for name, each in limit.items()}


def given_memory_limit(limit: object) -> int | None:
    """The memory limit of a plan [bytes].

    Args:
        limit: [GB], or None for no limit.

    Raises:
        InvalidInput: what is no amount of memory.
    """
    if limit is None:
        return None
    return int(number("memory_limit", limit, above=0.0, at_most=1e6) * BYTES_PER_GB)


def given_title(title: object) -> str:
    """The title of a study.

    Args:
        title: a text.

    Raises:
        InvalidInput: another type, or characters that are not printable.
    """
    given = text("title", title)
    if not given.isprintable():
        raise InvalidInput("title", title, "a text of printable characters")
    return given


def _without_twins(what: str, pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    names = [name for name, _ in pairs]
    for name in names:
        if names.count(name) > 1:
            raise InvalidInput(what, name, "each name once; a mapping gives other names")
    return dict(pairs)


def _name(what: str, name: object) -> str:
    given = text(what, name)
    if not given.strip() or not given.isprintable():
        raise InvalidInput(what, name, "a text of printable characters that is not empty")
    return given
