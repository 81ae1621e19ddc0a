"""Flights past bodies that move are free at their own times, or are not returned."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.proof.prover import Prover
from ffsr_plan.timed_proof.flown_proof import prove_flown, prove_waiting
from tests.helpers.moving_scenes import body_of, flown_clearances_by_hand, problem_past

LIMITS = {"joint_acceleration": 0.5, "thruster_acceleration": 0.1}
REST, PULSES = {"corners": "rest"}, {"corners": "rest", "velocity_jump": 0.05}
WAY = 4.0  # [m]
FASTEST = 2.0 * np.sqrt(WAY / LIMITS["thruster_acceleration"])  # [s]


def crossing(at, speed=1.0, **fields):
    """A straight way whose middle a ball crosses, at a time [s]."""
    ball = fp.MovingBody(
        [fp.Ball(0.3)], fp.Drift((0.0, speed, 0.0)), (0.5 * WAY, -speed * at, 0.0), name="debris"
    )
    problem = problem_past(ball, length=WAY, **fields)
    return replace(problem, lattice=fp.Lattice(6))


def times_of(flight):
    return np.linspace(0.0, flight.duration, 2001)


@pytest.fixture(scope="module")
def behind():
    """A plan of 40 s; the ball crosses the way when the fastest flight is in the middle."""
    return fp.plan(crossing(0.5 * FASTEST, duration=40.0), fp.LatticeOptimum())


@pytest.mark.parametrize("kind", ["drift", "spin", "track"])
@pytest.mark.parametrize("options", [REST, PULSES, {}], ids=["rest", "pulses", "smooth"])
def test_flights_keep_what_is_proven(kind, options):
    body = body_of(kind)
    if kind == "track":  # that of the helper ends early
        track = body.motion
        body = replace_motion(body, fp.Track(track.times * 4.0, track.positions, track.attitudes))
    plan = fp.plan(problem_past(body, ramp=0.2), fp.LatticeOptimum())
    flight = plan.timed(**LIMITS, **options)
    seen = flown_clearances_by_hand(flight, times_of(flight)).min()
    assert 0.0 < flight.least_clearance <= seen + 1e-9
    report = flight.verify()
    assert report.ok, report.problems
    assert report.clearance_bound - 1e-9 <= seen <= report.least_clearance + 1e-3


def replace_motion(body, motion):
    return fp.MovingBody(body.shapes, motion, name=body.name)


@pytest.fixture(scope="module")
def fastest(behind):
    """The flight that would be the fastest without the ball, past it."""
    alone = replace(behind, problem=replace(behind.problem, scene=fp.Scene(), duration=None))
    return replace(alone.timed(**LIMITS, **REST), problem=behind.problem, least_clearance=0.0)


def test_where_the_fastest_flight_is_hit_a_later_one_is_flown(behind, fastest):
    flight = behind.timed(**LIMITS, **REST)
    assert fastest.duration * 1.01 < flight.duration < behind.problem.duration
    seen = flown_clearances_by_hand(flight, times_of(flight)).min()
    assert 0.0 < flight.least_clearance <= seen + 1e-9
    assert flight.verify().ok
    assert flown_clearances_by_hand(fastest, times_of(fastest)).min() < 0.0
    report = fastest.verify()
    assert not report.ok
    assert any("moving body 'debris'" in each for each in report.problems)


def test_a_smooth_flight_that_is_hit_is_flown_later(behind):
    flight = behind.timed(**LIMITS)
    seen = flown_clearances_by_hand(flight, times_of(flight)).min()
    assert 0.0 < flight.least_clearance <= seen + 1e-9
    assert flight.duration > FASTEST * 1.01
    report = flight.verify()
    assert report.ok, report.problems
    assert report.clearance_bound - 1e-9 <= seen <= report.least_clearance + 1e-3
    again = behind.smooth().timed(**LIMITS)
    assert again.duration == pytest.approx(flight.duration)
    on_time = behind.timed(**LIMITS, duration=behind.problem.duration)
    assert on_time.duration == pytest.approx(behind.problem.duration, abs=1e-9)
    assert on_time.verify().ok


def test_a_smooth_plan_is_proven_for_the_times_of_the_plan(behind):
    smooth = behind.smooth()
    assert smooth.certificate.least_clearance > 0.0
    assert smooth.slip == pytest.approx(smooth.certificate.least_clearance)
    near = behind.problem.min_clearance + behind.certificate.least_clearance + 0.05
    grown = replace(behind, problem=replace(behind.problem, min_clearance=near))
    with pytest.raises(fp.UnprovenCurve, match=r"moving body 'debris' at [\d.]+ s"):
        grown.smooth()


def test_a_flight_that_is_hit_when_it_is_late_is_refused_then(behind, fastest):
    scene, motion = behind.problem.obstacles, behind.motion
    free = []
    for wait in (0.0, 2.0, 3.0, 4.0):
        late = fastest.after(wait)
        times = late.timetable
        proof = prove_flown(scene, Prover(motion, scene, 1e-7, pace=times), motion.edges, times)
        seen = flown_clearances_by_hand(late, times_of(late)).min()
        free.append(proof.refusal is None)
        assert free[-1] == (seen > 0.0) == late.verify().ok
        if proof.refusal is not None:
            assert proof.refusal.contact.source == "moving body 'debris'"
            assert abs(proof.refusal.time - 0.5 * FASTEST) < 3.0
    assert set(free) == {True, False}


def test_a_robot_waits_only_while_it_is_free(behind):
    start = replace(behind.problem, scene=fp.Scene(bodies=[arriving_at_start(8.0)]))
    early, late = (prove_waiting(start.obstacles, behind.motion, t, 1e-7) for t in (6.0, 8.0))
    assert early.refusal is None
    assert 0.0 < early.least_clearance < 2.0
    assert late.refusal is not None
    assert 6.0 < late.refusal.time <= 8.0


def arriving_at_start(at):
    return fp.MovingBody([fp.Ball(0.1)], fp.Drift((0.0, 1.0, 0.0)), (0.0, -at, 0.0))


def test_a_flight_may_be_early_or_late_by_its_slip(behind):
    flight = behind.timed(**LIMITS, **REST)
    assert flight.slip == pytest.approx(flight.least_clearance / 1.0)
    times = np.linspace(0.0, flight.duration + flight.slip, 2001)
    for late in (flight.slip, -flight.slip):
        assert flown_clearances_by_hand(flight, times, late).min() > -1e-9


def test_what_no_flight_passes_is_named(behind, fastest):
    ball = fp.MovingBody([fp.Ball(0.3)], fp.Drift((0.0, 1e-3, 0.0)), (WAY / 2, 0.0, 0.0), name="it")
    blocked = replace(behind, problem=replace(behind.problem, scene=fp.Scene(bodies=[ball])))
    with pytest.raises(fp.UnprovenFlight, match=r"moving body 'it' at [\d.]+ s") as caught:
        blocked.timed(**LIMITS, **REST)
    error = caught.value
    assert error.tries > 8
    assert error.arrivals[0] == pytest.approx(fastest.duration)
    q, scene = fastest.at([error.time]).configurations[0], blocked.problem.scene
    assert fp.clearance(blocked.problem.robot, scene.at(error.time), q) <= 1e-6


@pytest.mark.parametrize("options", [REST, {}], ids=["rest", "smooth"])
def test_debris_is_passed_as_a_drifting_ball_is(behind, options):
    ball = behind.problem.scene.bodies[0]
    cloud = fp.DebrisCloud([ball.position], [0.3], [ball.motion.velocity], name="cloud")
    among = replace(behind, problem=replace(behind.problem, scene=fp.Scene(debris=[cloud])))
    assert among.smooth().objective == pytest.approx(behind.smooth().objective, rel=1e-12)
    flight, same = among.timed(**LIMITS, **options), behind.timed(**LIMITS, **options)
    assert flight.duration == pytest.approx(same.duration, rel=1e-9)
    assert flight.least_clearance == pytest.approx(same.least_clearance, rel=0.06)
    assert flight.slip == pytest.approx(flight.least_clearance / ball.speed)
    assert flight.verify().ok


def test_a_flight_that_debris_hits_is_found(behind, fastest):
    ball = behind.problem.scene.bodies[0]
    cloud = fp.DebrisCloud([ball.position], [0.3], [ball.motion.velocity], name="cloud")
    scene = fp.Scene(debris=[cloud])
    report = replace(fastest, problem=replace(fastest.problem, scene=scene)).verify()
    assert not report.ok
    assert any("cloud" in each for each in report.problems)


@pytest.mark.parametrize("duration", [1.0, 0.0, -5.0, np.nan, "100"])
def test_a_duration_that_cannot_be_is_refused(behind, duration):
    for plan in (behind, behind.smooth()):
        with pytest.raises(fp.InvalidInput, match="duration: got"):
            plan.timed(**LIMITS, duration=duration)


def test_a_flight_that_outlasts_what_is_known_says_what_helps():
    plan = fp.plan(problem_past(body_of("track"), ramp=0.2), fp.LatticeOptimum())
    slow = {"joint_acceleration": 0.5, "thruster_acceleration": 1e-4}
    with pytest.raises(fp.InvalidInput, match=r"known; larger limits make the flight shorter$"):
        plan.timed(**slow)
    with pytest.raises(fp.InvalidInput, match=r"at most \S+ s, up to which .* known$"):
        plan.timed(**LIMITS, duration=1000.0)
