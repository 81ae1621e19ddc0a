"""Inertias: rounded ones are taken, wrong ones are refused or balanced, wrong units are named."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.robots.plausibility import LEAST_INERTIA
from ffsr_plan.robots.urdf.inertias import balanced, principal_moments, tensor_fault
from tests.helpers.urdf_builders import box, inertial, joint, link, urdf

BASE = link("base", inertial(20.0, (2.0, 2.0, 2.0)), box((0.8, 0.8, 0.8)))


def plate(texts, mass="3.0", size=(1.0, 0.5, 0.02)):
    """A base with a panel whose moments are these texts."""
    moments = " ".join(f"{key}='{text}'" for key, text in zip(("ixx", "iyy", "izz"), texts))  # noqa: B905
    own = f"<inertial><mass value='{mass}'/><inertia {moments} ixy='0' ixz='0' iyz='0'/></inertial>"
    hinge = joint("j", "revolute", "base", "panel", (1, 0, 0))
    return urdf(BASE, link("panel", own, box(size)), hinge)


def read(text, **options):
    return robot_from_urdf(text, "made", **options)


@pytest.mark.parametrize("digits", [3, 4, 5, 6, 9])
def test_plates_printed_with_few_digits_are_taken_as_printed(digits):
    rng, broken = np.random.default_rng(digits), 0
    for _ in range(200):
        a, b, mass = rng.uniform(0.1, 3, 3)
        exact = np.array([b * b, a * a, a * a + b * b]) * mass / 12.0
        given = [float(f"{value:.{digits}g}") for value in exact]
        assert tensor_fault(full(given), [f"{v:.{digits}g}" for v in full(given)]) is None
        broken += given[0] + given[1] < given[2]
    assert broken > 20
    texts = ("0.0312", "1.406", "1.438")
    assert read(plate(texts)).model.inertias[2].inertia[2, 2] == 1.438


def full(diagonal):
    return [diagonal[0], 0.0, 0.0, diagonal[1], 0.0, diagonal[2]]


@pytest.mark.parametrize(
    "texts",
    [
        ("1", "1", "3"),
        ("0.0312", "1.4062", "1.4382"),
        ("0.100", "0.100", "0.203"),
        ("1", "1", "-1"),
    ],
)
def test_moments_off_by_more_than_their_last_digit_are_refused(texts):
    with pytest.raises(fp.InvalidInput, match=r"made, link 'panel', inertia: .*inertia='balance'"):
        read(plate(texts))


def test_balancing_takes_the_nearest_tensor_of_a_body_and_says_so(tmp_path):
    text = plate(("0.1", "0.2", "0.5"))
    robot = read(text, inertia="balance")
    (record,) = robot.balanced
    assert record.link == "panel"
    assert record.given == (0.1, 0.0, 0.0, 0.2, 0.0, 0.5)
    assert np.allclose(record.taken, full([0.2, 0.3, 0.5]))
    assert np.allclose(np.diag(robot.model.inertias[2].inertia), [0.2, 0.3, 0.5])
    robot.save(tmp_path / "made.urdf")
    assert fp.load_robot(tmp_path / "made.urdf").balanced == robot.balanced
    again = fp.compose(fp.Bus((1, 1, 1), 50.0), [fp.Mount(tmp_path / "made.urdf", prefix="a_")])
    assert [(each.link, each.given) for each in again.balanced] == [("a_panel", record.given)]
    (tmp_path / "raw.urdf").write_text(text)
    mount = fp.Mount(tmp_path / "raw.urdf", inertia="balance")
    assert fp.compose(fp.Bus((1, 1, 1), 50.0), [mount]).balanced[0].given == record.given
    assert read(plate(("0.1", "0.2", "0.3")), inertia="balance").balanced == ()


def test_balanced_tensors_are_valid_never_smaller_and_valid_ones_stay():
    rng = np.random.default_rng(0)
    for _ in range(200):
        given = rng.normal(size=6).tolist()
        taken = balanced(given)
        small, middle, large = principal_moments(taken)
        assert small >= -1e-12
        assert small + middle >= large - 1e-12
        assert principal_moments(np.subtract(taken, given).tolist())[0] >= -1e-12
        assert np.allclose(balanced(taken), taken)


def test_a_radius_of_gyration_of_kilometres_is_refused_for_its_units():
    with pytest.raises(
        fp.InvalidInput, match=r"'panel', inertia: got 'radius of gyration 2.*units"
    ):
        read(plate(("2.5e6", "1e7", "1.25e7")))
    read(plate(("1.0", "1.0", "1.9")))  # odd, but not beyond doubt


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_base_with_next_to_no_inertia_is_refused_by_the_floor(factor):
    """The arm's mass is 3 kg; the size is that of base and panel."""
    with pytest.raises(fp.InvalidInput, match="least moment: got 1e-20") as caught:
        read(with_base(1e-20))
    floor = float(str(caught.value).split("at least ")[1].split(" ")[0])
    assert floor == pytest.approx(LEAST_INERTIA * 3.0 * SIZE**2, rel=0.01)
    if factor > 1.0:
        assert read(with_base(factor * floor)).nd == 1
    else:
        with pytest.raises(fp.InvalidInput, match="link 'base', least moment"):
            read(with_base(factor * floor))


SIZE = 1.0 + 0.5 * np.sqrt(1.0**2 + 0.5**2 + 0.02**2)  # origin of the joint, corner of the panel


def with_base(moment):
    text = plate(("0.0625", "0.25", "0.3125"))
    old = "ixx='2.0' iyy='2.0' izz='2.0'"
    assert old in text
    return text.replace(old, f"ixx='{moment!r}' iyy='{moment!r}' izz='{moment!r}'")


def test_moving_bodies_of_less_than_a_milligram_are_refused():
    with pytest.raises(fp.InvalidInput, match=r"link 'panel': got '1e-07 kg'.*at least 1e-06 kg"):
        read(plate(("0", "0", "0"), mass="1e-7"))
