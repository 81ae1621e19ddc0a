"""Plans touch nothing when they are flown by a small integrator and sampled densely.

First plans of five kinds of problems, five hundred where long tests are wanted, and some improved
ones. Between two samples no joint moves by more than .02 rad and the base by no more than .01 m.
"""

from functools import cache

import numpy as np
import pytest

import ffsr_plan as fp
from benchmarks.studies.general.families import drawn, loaded
from benchmarks.studies.general.free_space import problems
from ffsr_plan.core.rotations import angle_between
from tests.helpers.dense_flight import flown, least_gap
from tests.helpers.free_scenes import cup, gap, held_turn, scattered
from tests.helpers.sample_sizes import sample

AGREEMENT = 1e-9  # [rad], [m]
COUNTS = {kind: sample(20, whole) for kind, whole in {1: 160, 2: 60, 3: 150, 4: 50, 5: 80}.items()}
AT_ONCE, STORED = 10, 20  # problems of a test; those of a kind that need not be drawn
BLOCKS = [(kind, k) for kind, count in COUNTS.items() for k in range(count // AT_ONCE)]


@cache
def stored(kind):
    return problems(kind, STORED)


def problem_of(kind, number):
    """Drawing one of kind 4 takes long, so that stored ones come first."""
    if kind == 4 and number < STORED:
        return stored(kind)[number]
    return drawn(kind, 100 + number)


def touches_nothing(plan):
    path, corners = flown(plan)
    planned = plan.configurations
    assert angle_between(path[corners, 3:7], planned[:, 3:7]).max() < AGREEMENT
    assert np.abs(path[corners, :3] - planned[:, :3]).max() < AGREEMENT
    least, touching = least_gap(plan, path)
    assert not touching
    assert least > 0.0
    assert plan.certificate.least_clearance <= least + 1e-6


@pytest.mark.parametrize(("kind", "block"), BLOCKS)
def test_first_plans_touch_nothing_when_flown(kind, block):
    for number in range(AT_ONCE * block, AT_ONCE * (block + 1)):
        planner = fp.TreePlanner(checks=5_000_000 if kind == 2 else None)  # some gaps take more
        touches_nothing(fp.plan(problem_of(kind, number), planner, number, until="first"))


@pytest.mark.parametrize("kind", COUNTS)
def test_improved_plans_touch_nothing_when_flown(kind):
    for number in range(2):
        planner = fp.TreePlanner(checks=None if kind == 2 else 400_000)  # a gap takes more to find
        touches_nothing(fp.plan(problem_of(kind, number), planner, number))


@pytest.mark.parametrize("until", ["first", "end"])
def test_plans_with_wheels_touch_nothing_when_flown(until):
    planar, uneven = loaded("planar_dual_arm"), 0
    for seed, angle in enumerate([0.0, 0.5, -0.8, 1.5]):
        problem = held_turn(scattered(planar, 20 + seed, "attitude-held"), angle)
        plan = fp.plan(problem, fp.TreePlanner(checks=200_000), seed, until=until)
        touches_nothing(plan)
        shares = plan.motion.turn_shares
        uneven += shares is not None and np.ptp(np.diff(shares)) > 0.01
    assert uneven


def test_a_base_that_did_not_react_would_be_noticed():
    planar, missed, caught = loaded("planar_dual_arm"), 0.0, 0
    for seed, problem in enumerate([gap(planar, 10), gap(planar, 11), cup(planar), drawn(1, 102)]):
        plan = fp.plan(problem, fp.TreePlanner(), seed, until="first")
        touches_nothing(plan)
        path, corners = flown(plan, reacts=False)
        apart = angle_between(path[corners, 3:7], plan.configurations[:, 3:7])
        missed, caught = max(missed, apart.max()), caught + (least_gap(plan, path)[0] < 0.0)
    assert missed > 0.05
    assert caught
