"""`certify`: nothing that touches is free, contacts begin when they are said to, at true times."""

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline, CubicSpline

import ffsr_plan as fp
from ffsr_plan.certification import spans as spans_module
from ffsr_plan.core.rotations import angle_between, exp, multiply
from ffsr_plan.robots.loading import robot_from_urdf

BESIDE = fp.Scene([[-0.35, 1.1, 0.0]], [0.2])


def trajectory(robot, seed, interpolation="linear", count=5, reach=0.6, **more):
    rng = np.random.default_rng(seed)
    values = np.cumsum(rng.uniform(-reach, reach, (count, robot.nd)), axis=0)
    times = np.cumsum(rng.uniform(0.3, 1.5, count))
    return fp.Trajectory.of_array(
        times, values, robot.joint_names, interpolation=interpolation, **more
    )


def clearances(report, times):
    robot, scene = report.robot, report.scene
    pairs = zip(report.at(times), times, strict=True)
    return np.array([float(fp.clearance(robot, scene.at(t), q)) for q, t in pairs])


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_contacts_begin_at_their_time_and_free_is_free(robot, interpolation):
    kinds = set()
    for seed in range(12):
        given = trajectory(robot, seed, interpolation)
        mode = ["free-floating", "free-flying", "attitude-held"][seed % 3]
        angle = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi)
        scene = fp.Scene([[1.15 * np.cos(angle), 1.15 * np.sin(angle), 0.0]], [0.1])
        report = fp.certify(robot, scene, given, mode)
        begin, end = given.times[[0, -1]]
        if report.free:
            sampled = clearances(report, np.linspace(begin, end, 400)).min()
            assert 0.0 < report.proven_clearance <= sampled + 1e-12
        elif report.contact is not None and isinstance(report.contact.obstacle, int):
            time = report.contact.time
            assert clearances(report, [time])[0] <= 0.0
            if time > begin:
                assert clearances(report, np.linspace(begin, time - 2e-6, 300)).min() > 0.0
        kinds.add(report.free)
    assert kinds == {True, False}


def test_links_that_meet_are_named_with_the_time(robot):
    joints = {name: [0.0, 0.0] for name in robot.joint_names}
    joints |= {"left_1": [0.0, -1.8], "left_2": [0.0, -2.6], "left_3": [0.0, -2.4]}
    report = fp.certify(robot, fp.Scene(), fp.Trajectory([0.0, 2.0], joints))
    assert isinstance(report.contact.obstacle, str)
    just_before, then = report.at([report.contact.time - 3e-6, report.contact.time])
    assert not fp.self_collisions(robot, just_before)
    assert fp.self_collisions(robot, then)


def test_cubic_pieces_are_those_of_the_file(robot):
    given = trajectory(robot, 3, "cubic")
    names, times = robot.joint_names, np.linspace(*given.times[[0, -1]], 37)
    values = given.joint_array(names)
    rates = np.random.default_rng(5).normal(size=values.shape)
    with_rates = fp.Trajectory.of_array(
        given.times, values, names, velocities=rates, interpolation="cubic"
    )
    for each, law in (
        (given, CubicSpline(given.times, values, bc_type="clamped")),
        (with_rates, CubicHermiteSpline(given.times, values, rates)),
    ):
        joints = robot.joint_values(fp.certify(robot, fp.Scene(), each).at(times))
        assert np.abs(joints - law(times)).max() < 1e-12


def test_the_base_turns_as_momentum_demands(robot):
    given = trajectory(robot, 1, "cubic")
    report = fp.certify(robot, fp.Scene(), given)
    law = CubicSpline(given.times, given.joint_array(robot.joint_names), bc_type="clamped")
    begin, end = given.times[[0, -1]]
    steps = 2000
    middles = begin + (np.arange(steps) + 0.5) * (end - begin) / steps
    turned = np.array([0.0, 0.0, 0.0, 1.0])
    for middle in middles:  # by the midpoint rule
        q = robot.assemble(np.zeros(3), turned, law(middle))
        rate = fp.momentum.connection(robot, q) @ law(middle, 1)
        turned = multiply(turned, exp(rate * (end - begin) / steps))
    assert report.turn > 0.02
    assert angle_between(turned, report.at([end])[0, 3:7]) < 1e-6
    center = [robot.model, robot.model.createData()]
    import pinocchio as pin

    first, last = (pin.centerOfMass(*center, q).copy() for q in report.at([begin, end]))
    assert np.abs(first - last).max() < 1e-9


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_spans_change_neither_motion_nor_verdict(robot, monkeypatch, interpolation):
    given = trajectory(robot, 4, interpolation, count=9, reach=0.3)
    whole = fp.certify(robot, BESIDE, given)
    monkeypatch.setattr(spans_module, "_MOST_PIECES", 2)
    parts = fp.certify(robot, BESIDE, given)
    times = np.linspace(*given.times[[0, -1]], 50)
    assert np.abs(whole.at(times) - parts.at(times)).max() < 1e-9
    assert parts.free == whole.free
    assert parts.proven_clearance == pytest.approx(whole.proven_clearance, rel=0.06)


def test_errors_of_earlier_spans_count_in_later_proofs(robot, monkeypatch):
    monkeypatch.setattr(spans_module, "_MOST_PIECES", 2)
    given = trajectory(robot, 4, count=9, reach=0.3)
    run = spans_module.RobotTrajectory(
        robot, fp.Mode.FREE_FLOATING, given, np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])
    )
    errors = [span.motion.attitude_error for span in run.spans()]
    assert np.all(np.diff(errors) > 0.0)


def test_what_is_free_with_the_base_held_may_collide(robot):
    joints = {name: [0.0, 0.0] for name in robot.joint_names} | {"left_1": [0.0, 1.5]}
    given = fp.Trajectory([0.0, 1.0], joints)
    drifted = fp.certify(robot, fp.Scene(), given, frame="left_link_3")
    tip = drifted.samples.drifts
    assert tip[0] == 0.0
    assert tip[-1] == drifted.drift > 0.05
    held = fp.certify(robot, fp.Scene(), given, "attitude-held", frame="left_link_3")
    assert held.largest_drift == held.largest_turn == 0.0


def test_bodies_are_met_where_they_are_at_true_times(robot):
    body = fp.MovingBody([fp.Ball(0.1)], fp.Drift([0.0, -1.0, 0.0]), position=[0.0, 3.0, 0.0])
    scene = fp.Scene(bodies=[body])
    joints = {name: [0.0, 0.0, 0.0] for name in robot.joint_names}
    joints["left_1"] = [0.0, 0.01, 0.02]
    early, late = (
        fp.certify(robot, scene, fp.Trajectory(times, joints), "attitude-held")
        for times in ([0.0, 0.1, 4.0], [10.0, 10.5, 14.0])
    )
    assert late.free
    time = early.contact.time
    assert 1.0 < time < 3.0
    before, at = clearances(early, [time - 3e-6, time])
    assert at <= 0.0 < before


def test_attitudes_that_wheels_hold_are_those_given(robot):
    joints = {name: [0.0, 0.1, 0.2] for name in robot.joint_names}
    turned = np.array([[0.0, 0.0, np.sin(a / 2), np.cos(a / 2)] for a in (0.0, 0.5, 0.8)])
    places = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]])
    given = fp.Trajectory([0.0, 1.0, 2.0], joints, base_attitudes=turned, base_positions=places)
    report = fp.certify(robot, BESIDE, given, "attitude-held")
    q = report.at([0.0, 0.5, 1.0, 1.5, 2.0])
    angles = 2.0 * np.arctan2(q[:, 5], q[:, 6])
    assert np.abs(angles - [0.0, 0.25, 0.5, 0.65, 0.8]).max() < 1e-12
    assert np.abs(q[:, 0] - [0.0, 0.25, 0.5, 0.75, 1.0]).max() < 1e-12


def test_plans_are_judged_as_they_were_proven(fig2a_plan):
    problem = fig2a_plan.problem
    report = fp.certify(problem.robot, problem.scene, fig2a_plan, problem.mode)
    assert report.free
    least = fig2a_plan.certificate.least_clearance
    assert report.proven_clearance == pytest.approx(least, rel=0.06)
    at = report.at(np.linspace(0.0, 1.0, 50))
    assert np.abs(at - fig2a_plan.at(np.linspace(0.0, 1.0, 50))).max() < 1e-9


def test_a_page_says_what_was_found(robot, tmp_path):
    given = fp.Trajectory([0, 2], {n: [0.0, 1.4 * (n == "left_1")] for n in robot.joint_names})
    report = fp.certify(robot, BESIDE, given)
    report.write_html(tmp_path / "t.html")
    text = (tmp_path / "t.html").read_text()
    assert "rotation of the base" in text
    assert f"at {report.contact.time:.6f} s" in text
    assert '"limits": [0.0]' not in text  # no clearance is proven of what collides


WRONG = [
    ({"joints": {"left_1": [0, 1]}}, "missing joints", "left_2"),
    ({"joints": "all", "extra": "lefty"}, "unknown joints", "lefty"),
    ({"joints": "all", "left_1": [0.0, 90.0]}, "left_1", "not in degrees"),
    ({"joints": "all", "left_1": [0.0, np.nan]}, "'left_1', row 1", "finite"),
    ({"joints": "all", "times": [0.0, 0.0]}, "times, row 1", "increase"),
]


@pytest.mark.parametrize(("change", "field", "allowed"), WRONG)
def test_errors_name_field_value_and_what_is_allowed(robot, change, field, allowed):
    joints = change["joints"]
    if joints == "all":
        joints = {name: [0.0, 0.1] for name in robot.joint_names}
        joints |= {k: v for k, v in change.items() if k == "left_1"}
        joints |= {change["extra"]: [0.0, 0.1]} if "extra" in change else {}
    times = change.get("times", [0.0, 1.0])
    with pytest.raises(fp.InvalidInput) as error:
        fp.certify(robot, fp.Scene(), fp.Trajectory(times, joints))
    assert field in error.value.what
    assert allowed in str(error.value)


def test_continuous_joints_take_the_shorter_way():
    limit = '<limit effort="1" velocity="1"/>'
    parts = "".join(
        f'<link name="{name}"><inertial><mass value="2"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        '<collision><geometry><sphere radius="0.1"/></geometry></collision></link>'
        for name in ("base", "arm")
    )
    joint = '<parent link="base"/><child link="arm"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>'
    urdf = (
        f'<robot name="r">{parts}<joint name="j" type="continuous">{joint}{limit}</joint></robot>'
    )
    robot = robot_from_urdf(urdf, "r")
    given = fp.Trajectory([0.0, 1.0], {"j": [3.1, -3.1]})
    (middle,) = robot.joint_values(fp.certify(robot, fp.Scene(), given).at([0.5]))
    assert abs(abs(middle[0]) - np.pi) < 1e-9


@pytest.mark.parametrize("tolerance", [1e-3, 1e-7])
def test_what_is_undecided_before_a_contact_lies_within_the_tolerance_and_is_said(robot, tolerance):
    joints = {name: [0.0, 0.0] for name in robot.joint_names} | {"left_1": [0.0, 1.4]}
    given = fp.Trajectory([3.0, 5.0], joints)
    report = fp.certify(robot, BESIDE, given, tolerance=tolerance)
    until, time = report.proven_until, report.contact.time
    assert 3.0 < until < time < 5.0
    undecided = clearances(report, np.linspace(until, time - 1e-6, 50))
    assert 0.0 < undecided.min() <= undecided.max() <= 3.0 * tolerance + 1e-7
    assert clearances(report, np.linspace(3.0, until, 200)).min() > 0.0
    assert ("undecided" in report.verdict()) == (tolerance == 1e-3)
    assert f"proven free before {until - 5e-7:.6f} s" in report.verdict()


def test_times_until_which_all_is_proven_free_are_those_of_the_case(robot):
    joints = {name: [0.0, 0.0] for name in robot.joint_names}
    given, touching = fp.Trajectory([3.0, 5.0], joints), fp.Scene([[0.0, 0.0, 0.0]], [0.2])
    free, met = (fp.certify(robot, scene, given) for scene in (BESIDE, touching))
    assert free.proven_until == 5.0
    assert free.unproven_time is None
    assert met.proven_until == met.contact.time == 3.0
    assert "proven" not in met.verdict()
    swing = fp.Trajectory([3.0, 5.0], {**joints, "left_1": [0.0, 1.4]})
    aside = fp.Scene([[-1.1, 1.5, 0.0]], [0.1])
    times = np.linspace(3.0, 5.0, 801)
    gaps = clearances(fp.certify(robot, aside, swing), times)
    grazed = fp.Scene(aside.centers, aside.radii + gaps.min() - 1e-5)
    near = fp.certify(robot, grazed, swing, tolerance=1e-3)
    assert near.contact is None
    assert 3.0 < near.proven_until == near.unproven_time < times[gaps.argmin()]
    assert clearances(near, [near.proven_until])[0] < 3e-3
