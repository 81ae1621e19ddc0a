"""Numbers from publications: each within its tolerance, and agreement of independent programs."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import ffsr_plan as fp
from ffsr_plan.cli import app
from ffsr_plan.core import rotations
from ffsr_plan.dynamics import momentum
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.published_numbers import double_bridge, literature, planar_manipulator
from ffsr_plan.published_numbers.air_bearing_robot import air_bearing_robot
from ffsr_plan.published_numbers.dual_arm_satellite import BEGIN, CHANGE, dual_arm_satellite
from ffsr_plan.published_numbers.ets_vii import ets_vii
from ffsr_plan.published_numbers.free_panda import free_panda
from ffsr_plan.published_numbers.models import summed_momentum
from ffsr_plan.published_numbers.recomputed_number import FORMULA, OWN, PUBLISHED, RecomputedNumber

TREES = (dual_arm_satellite, free_panda, planar_manipulator.planar_manipulator, air_bearing_robot)
NAMES = [source.__module__.rpartition(".")[2] for source in literature.SOURCES]


@pytest.mark.parametrize("recomputed", literature.SOURCES, ids=NAMES)
def test_every_number_agrees_within_its_tolerance(recomputed):
    numbers = recomputed()
    assert numbers
    off = [(each.quantity, each.expected, each.computed) for each in numbers if not each.ok]
    assert not off


def test_a_tolerance_is_no_wider_than_what_is_printed():
    """Published numbers are compared to a few units of their last digit, others far closer."""
    for each in fp.literature():
        assert each.basis in (PUBLISHED, FORMULA, OWN)
        scale = max(abs(each.expected), 1e-3)
        if each.basis == PUBLISHED and "about" not in each.differs:
            assert each.tolerance <= 0.02 * scale or each.expected == 0.006  # three digits
        elif "trials" in each.differs:  # four standard deviations of a share
            share = each.expected / 100.0
            deviation = 100.0 * np.sqrt(share * (1.0 - share) / double_bridge.TRIALS)
            assert each.tolerance == pytest.approx(4.0 * deviation)
        elif each.basis != PUBLISHED:
            assert each.tolerance <= 2e-3 * scale


def test_more_than_ten_of_them_are_printed_in_their_source():
    assert sum(each.basis == PUBLISHED for each in fp.literature()) > 10


def test_a_number_off_its_tolerance_does_not_agree():
    good = RecomputedNumber("a", "m", PUBLISHED, 1.0, 1.01, 0.02, "s")
    assert good.ok
    assert good.difference == pytest.approx(0.01)
    assert not RecomputedNumber("a", "m", PUBLISHED, 1.0, 0.97, 0.02, "s").ok
    assert not RecomputedNumber("a", "m", PUBLISHED, 1.0, float("nan"), 0.02, "s").ok


@pytest.mark.parametrize("tree_of", TREES, ids=lambda each: each.__name__)
def test_sums_over_the_bodies_give_the_same_generalized_jacobian(tree_of):
    tree, rng = tree_of(), np.random.default_rng(1)
    robot, frame = tree.robot(), tree.bodies[-1].name
    for _ in range(3):
        values = rng.uniform(-1.0, 1.0, robot.nd)
        q = robot.assemble(np.zeros(3), rotations.IDENTITY, values)
        expected = summed_momentum.generalized_jacobian(tree, values, frame)
        assert np.allclose(momentum.generalized_jacobian(robot, q, frame), expected, atol=1e-12)


def test_sums_over_the_bodies_give_the_yaw_of_the_dual_arm():
    """The published number again, by the second program."""
    tree = dual_arm_satellite()
    path = summed_momentum.straight(BEGIN, BEGIN + CHANGE)
    turned = summed_momentum.base_rotation(tree, path, 40)
    assert np.arctan2(turned[1, 0], turned[0, 0]) == pytest.approx(-0.206117, abs=1e-6)


def test_a_loop_run_backwards_undoes_the_rotation_of_the_free_panda():
    from ffsr_plan.published_numbers.free_panda import loop

    robot, values = free_panda().robot(), loop(0.6, 100)
    there = Reaction.along(robot, values).attitudes(rotations.IDENTITY)[-1]
    back = Reaction.along(robot, values[::-1]).attitudes(there)[-1]
    assert rotations.angle_between(there, rotations.IDENTITY) > 0.3
    assert rotations.angle_between(back, rotations.IDENTITY) < 1e-9


def test_the_arm_of_ets_vii_is_two_metres_long_and_rests_on_a_heavy_base():
    tree = ets_vii()
    robot = tree.robot(inertia="balance")
    assert robot.nd == 6
    assert robot.mass == pytest.approx(tree.mass) == pytest.approx(2695.38)
    arm = tree.bodies[2:7]
    assert 1.9 < sum(float(np.abs(body.place).max()) for body in arm) < 2.5


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(app, ["literature", *arguments])


def one_number(computed):
    return (RecomputedNumber("yaw of [x]", "rad", PUBLISHED, -0.2, computed, 0.01, "book", "all"),)


def test_the_command_prints_numbers_sources_and_what_differs(run, monkeypatch):
    monkeypatch.setattr(literature, "literature", lambda: one_number(-0.2005))
    result = run()
    assert result.exit_code == 0
    for word in ("yaw of [x] [rad]", "-0.2005", "yes, published", "book", "all"):
        assert word in result.stdout
    (number,) = json.loads(run("--json").stdout)["numbers"]
    assert number["ok"]
    assert number["computed"] == -0.2005


def test_the_command_ends_with_status_1_if_a_number_is_off(run, monkeypatch):
    monkeypatch.setattr(literature, "literature", lambda: one_number(-0.3))
    result = run()
    assert result.exit_code == 1
    assert "NO, published" in result.stdout
    assert run("--json").exit_code == 1


def test_branches_of_one_length_are_taken_equally_often_and_more_ants_find_the_short_one():
    assert double_bridge.share_by_chain(4, double_bridge._SHORT) == pytest.approx(0.5, abs=1e-3)
    shares = [double_bridge.share_by_chain(ants) for ants in (1, 2, 4, 8)]
    assert shares[0] == 0.5  # one ant is unanimous at once
    assert np.all(np.diff(shares) < 0.0)
    assert shares[3] < 0.05
