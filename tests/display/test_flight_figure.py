"""The figure of a flight shows what it names, in units, over the true time."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import ffsr_plan as fp
from ffsr_plan.display.flights.flight_samples import continuous

TITLES = {
    "speed": "speed of the base\n[m/s]",
    "thrust": "thrust / mass\n[mm/s²]",
    "joints": "joint rates\n[rad/s]",
    "attitude": "rotation of the base\n[°]",
}


@pytest.fixture(scope="module")
def figure(flight):
    return flight.figure()


def panel(figure, name):
    return next(ax for ax in figure.axes if ax.get_ylabel() == TITLES[name])


def legend(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def test_panels_share_the_time_from_start_to_end(figure, flight):
    panels = [panel(figure, name) for name in TITLES]
    for ax in panels:
        assert ax.get_xlim() == (0.0, pytest.approx(flight.duration))
    assert [ax.get_xlabel() for ax in panels] == ["", "", "", "time [s]"]
    assert figure.axes[0].get_ylabel() == "lateral x' [m]"


def test_curves_are_those_of_the_flight(figure, flight):
    times = np.linspace(0.0, flight.duration, 57)
    states = flight.at(times)
    mass = sum(body.mass for body in list(flight.motion.robot.model.inertias)[1:])
    thrust = states.thrust / mass + flight.pulse_accelerations(times)
    expected = {
        "speed": np.linalg.norm(states.base_velocity, axis=1),
        "thrust": 1e3 * np.linalg.norm(thrust, axis=1),
        "joints": states.joint_velocities[:, 0],
    }
    for name, values in expected.items():
        line = next(k for k in panel(figure, name).lines if len(k.get_xdata()) > 100)
        drawn = np.interp(times, line.get_xdata(), line.get_ydata())
        assert np.median(np.abs(drawn - values)) < 1e-3 * np.max(np.abs(values))


def test_limits_are_drawn_where_they_are_near_and_written_where_they_are_far(figure):
    thrust, joints = panel(figure, "thrust"), panel(figure, "joints")
    assert legend(thrust) == ["limit 10 mm/s²"]
    assert [10.0, 10.0] in [list(line.get_ydata()) for line in thrust.lines]
    assert legend(joints)[-1] == "limit 0.5 rad/s"
    assert joints.get_ylim()[1] < 0.1


def test_thrust_keeps_its_limit_in_the_picture(figure):
    for line in panel(figure, "thrust").lines:
        assert np.all(np.asarray(line.get_ydata(), dtype=float) <= 10.0 * (1.0 + 1e-6))


def test_silhouettes_carry_their_times_and_the_panels_mark_them(figure, flight):
    texts = [t.get_text() for t in figure.axes[0].texts if t.get_text().endswith(" s")]
    steps = np.linspace(0.0, flight.duration, 7)
    assert texts == [f"{step:.3g} s" for step in steps]
    marks = [line.get_xdata()[0] for line in panel(figure, "speed").lines[:5]]
    assert marks == pytest.approx(steps[1:-1])


def test_two_flights_can_be_compared_on_given_axes(flight, fig2a_plan):
    smooth = fig2a_plan.timed(joint_acceleration=0.05, thruster_acceleration=0.01)
    figure = Figure()
    speed = figure.add_subplot()
    for each, colour, label in ((smooth, "tab:red", "smooth"), (flight, "tab:blue", "pulses")):
        drawn = each.figure({"speed": speed}, colours={"speed": colour}, labels={"speed": label})
        assert drawn is figure
    assert legend(speed) == ["smooth", "pulses"]
    assert speed.get_xlim()[1] == pytest.approx(max(smooth.duration, flight.duration))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"axes": {"sped": None}}, "did you mean 'speed'"),
        ({"axes": {"speed": 3}}, "axes.speed"),
        ({"axes": {}}, "axes by name"),
        ({"axes": {"wheels": None}}, "path, speed, thrust, joints, attitude, clearance"),
        ({"labels": {"left_9": "arm"}}, "did you mean 'left_"),
        ({"silhouettes": 1}, "silhouettes"),
    ],
)
def test_what_a_flight_does_not_have_is_refused_by_name(flight, given, message):
    with pytest.raises(fp.InvalidInput, match=message):
        flight.figure(**given)


@pytest.mark.parametrize("suffix", ["pdf", "svg", "png"])
def test_the_figure_is_written_as_vectors_or_pixels(flight, tmp_path, suffix):
    flight.write_figure(tmp_path / f"flight.{suffix}")
    content = (tmp_path / f"flight.{suffix}").read_bytes()
    assert content.startswith({"pdf": b"%PDF", "svg": b"<?xml", "png": b"\x89PNG"}[suffix])
    if suffix == "svg":
        assert b"joint rates" in content


def test_another_kind_of_file_is_refused_before_anything_is_drawn(flight, tmp_path):
    with pytest.raises(fp.InvalidInput, match="path"):
        flight.write_figure(tmp_path / "flight.bmp")


def test_rotations_do_not_jump_after_half_a_turn():
    angles = np.linspace(0.0, 9.0, 200)
    wrapped = (angles + np.pi) % (2.0 * np.pi) - np.pi
    axis = np.array([0.6, 0.0, 0.8])
    assert np.allclose(continuous(wrapped[:, None] * axis), angles[:, None] * axis)


def test_thrust_is_left_out_where_there_are_no_thrusters_and_wheels_shown_where_there_are(robot):
    start = robot.configuration(joints={"left_1": -0.6})
    goal = robot.configuration(joints={"left_1": 0.7})
    for mode, shown in (("free-floating", False), ("attitude-held", True)):
        problem = fp.Problem(robot, fp.Scene(), start, goal, mode=mode)
        flight = fp.plan(problem, seed=0).timed(
            joint_acceleration=0.05,
            thruster_acceleration=0.01 if shown else None,
            turn_acceleration=0.01 if shown else None,
        )
        titles = [ax.get_ylabel().split("\n")[0] for ax in flight.figure().axes]
        assert ("thrust / mass" in titles) == shown
        assert ("momentum of the wheels" in titles) == shown
