"""Every bad input ends in an error that names it, and never in a guess."""

import numpy as np
import pytest

import ffsr_plan as fp


def arguments(robot, **changes):
    base = {
        "robot": robot,
        "scene": fp.Scene([[5, 3, 0]], [0.5]),
        "start": robot.neutral(),
        "goal": robot.configuration((10, 0, 0), joints={"left_1": 0.5}),
        "lattice": fp.Lattice(10, fp.Axis(3, 0.3)),
    }
    return base | changes


ARMS_THROUGH_EACH_OTHER = {"left_1": -1.6, "left_2": -1.5, "right_1": 1.6, "right_2": 1.5}


def changed(q, index, value):
    q = np.array(q)
    q[index] = value
    return q


def test_an_unknown_robot_is_named_with_the_nearest_one():
    with pytest.raises(fp.InvalidInput, match="did you mean 'planar_dual_arm'"):
        fp.load_robot("planar_dualarm")


def test_a_missing_urdf_file_is_named():
    with pytest.raises(fp.InvalidInput, match=r"nowhere/robot\.urdf.*existing"):
        fp.load_robot("nowhere/robot.urdf")


def test_an_unknown_joint_is_named_with_the_nearest_one(robot):
    with pytest.raises(fp.InvalidInput, match="did you mean 'left_1'"):
        robot.configuration(joints={"left1": 0.2})


def test_an_unknown_mode_is_named_with_the_nearest_one(robot):
    with pytest.raises(fp.InvalidInput, match=r"mode.*did you mean 'free-flying'"):
        fp.Problem(**arguments(robot, mode="free_flying"))


@pytest.mark.parametrize("which", ["start", "goal"])
@pytest.mark.parametrize("q", [[0.0] * 12, [[0.0] * 13], "home", None, [0.0] * 14])
def test_a_q_of_wrong_length_or_type_is_refused(robot, which, q):
    with pytest.raises(fp.InvalidInput, match=f"{which}.*shape"):
        fp.Problem(**arguments(robot, **{which: q}))


@pytest.mark.parametrize("w", [0.0, 0.99, 1.01, -1.001])
def test_a_quaternion_that_is_not_of_norm_one_is_refused(robot, w):
    with pytest.raises(fp.InvalidInput, match=r"quaternion.*norm"):
        fp.Problem(**arguments(robot, start=changed(robot.neutral(), 6, w)))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_refused_everywhere(robot, bad):
    cases = [
        lambda: fp.Problem(**arguments(robot, start=changed(robot.neutral(), 1, bad))),
        lambda: fp.Problem(**arguments(robot, goal=changed(robot.neutral(), 8, bad))),
        lambda: fp.Scene([[0, bad, 0]], [1.0]),
        lambda: fp.Scene([[0, 0, 0]], [bad]),
        lambda: fp.Axis(2, bad),
        lambda: fp.Problem(**arguments(robot, delta=bad)),
        lambda: fp.Problem(**arguments(robot, length_unit=bad)),
        lambda: fp.Problem(**arguments(robot, clearance_cap=bad)),
        lambda: fp.AntSystem(C=bad),
        lambda: fp.AntSystem(Q=bad),
        lambda: robot.configuration((0, bad, 0)),
        lambda: robot.configuration(attitude=(bad, 0, 0)),
        lambda: robot.configuration(joints={"left_1": bad}),
        lambda: fp.momentum.connection(robot, changed(robot.neutral(), 9, bad)),
        lambda: fp.clearance(robot, fp.Scene(), changed(robot.neutral(), 0, bad)),
    ]
    for case in cases:
        with pytest.raises(fp.InvalidInput, match="finite"):
            case()


@pytest.mark.parametrize("radius", [0.0, -0.1])
def test_a_radius_of_zero_or_less_is_refused_with_its_index(radius):
    with pytest.raises(fp.InvalidInput, match=r"radii, sphere 1: got .*greater than 0"):
        fp.Scene([[0, 0, 0], [1, 0, 0]], [0.5, radius])


@pytest.mark.parametrize("bad", [np.nan, -np.inf, 1e6])
def test_a_wrong_coordinate_is_refused_with_the_index_of_its_sphere(bad):
    for count, at in ((1, 0), (5000, 3000)):
        centers = np.zeros((count, 3))
        centers[at, 1] = bad
        message = rf"^scene centers, sphere {at}: got {bad}; allowed: a finite number of at most 1"
        with pytest.raises(fp.InvalidInput, match=message):
            fp.Scene(centers, np.ones(count))


def test_masked_numbers_are_refused_wherever_arrays_are_taken(robot, fig2a_plan):
    flight = fig2a_plan.timed(joint_acceleration=0.05, thruster_acceleration=0.01)
    masked = np.ma.masked_array([0.1, 0.2, 0.3], mask=[0, 1, 0])
    rows = np.ma.masked_array(np.tile(robot.neutral(), (2, 1)))
    rows[1, 0] = np.ma.masked
    cases = {
        "scene centers": lambda: fp.Scene(masked[None], [1.0]),
        "s:": lambda: fig2a_plan.at(masked),
        "times": lambda: flight.at(masked),
        "position": lambda: robot.configuration(masked),
        r"q\[1\]": lambda: robot.components(rows),
        "start": lambda: fp.Problem(**arguments(robot, start=rows[1])),
    }
    for what, case in cases.items():
        with pytest.raises(fp.InvalidInput, match=rf"^{what}.*none of them masked$"):
            case()


def test_centers_and_radii_must_match():
    with pytest.raises(fp.InvalidInput, match="one for each of 2 centers"):
        fp.Scene([[0, 0, 0], [1, 0, 0]], [0.5])
    with pytest.raises(fp.InvalidInput, match="shape"):
        fp.Scene([[0, 0], [1, 0]], [0.5, 0.5])


def test_joints_outside_their_limits_are_refused_by_name(robot):
    with pytest.raises(fp.InvalidInput, match=r"left_1.*-1\.8 to 1\.8"):
        robot.configuration(joints={"left_1": 1.9})
    with pytest.raises(fp.InvalidInput, match=r"goal \(joint right_3\)"):
        fp.Problem(**arguments(robot, goal=changed(robot.neutral(), -1, 3.0)))


@pytest.mark.parametrize("divisions", [1, 0, -3, 2.5, "40", True])
def test_fewer_than_two_divisions_are_refused(divisions):
    with pytest.raises(fp.InvalidInput, match=r"divisions.*at least 2"):
        fp.Lattice(divisions)


@pytest.mark.parametrize("half_count", [0, -1, 1.5])
def test_a_half_count_below_one_is_refused(half_count):
    with pytest.raises(fp.InvalidInput, match=r"half_count.*at least 1"):
        fp.Axis(half_count, 0.1)


@pytest.mark.parametrize("spacing", [0.0, -0.1])
def test_a_spacing_of_zero_is_refused(spacing):
    with pytest.raises(fp.InvalidInput, match=r"spacing.*at least 1e-09"):
        fp.Axis(2, spacing)


def test_a_negative_delta_is_refused(robot):
    with pytest.raises(fp.InvalidInput, match=r"delta.*at least 0"):
        fp.Problem(**arguments(robot, delta=-1e-9))


@pytest.mark.parametrize("rho", [0.0, 1.0, -0.1, 1.1])
def test_rho_outside_zero_and_one_is_refused(rho):
    with pytest.raises(fp.InvalidInput, match=r"rho.*greater than 0 and less than 1"):
        fp.AntSystem(rho=rho)


@pytest.mark.parametrize(
    "wrong", [{"ants": 0}, {"cycles": 0}, {"alpha": -1}, {"beta": -1}, {"Q": 0}, {"C": 0}]
)
def test_other_parameters_of_the_ants_are_checked_too(wrong):
    with pytest.raises(fp.InvalidInput, match=next(iter(wrong))):
        fp.AntSystem(**wrong)


def test_a_start_that_is_the_goal_is_nothing_to_reach(robot):
    with pytest.raises(fp.InvalidInput, match="differs from the start"):
        fp.Problem(**arguments(robot, goal=robot.neutral()))
    turned = robot.configuration(attitude=(0.5, 0, 0))  # not demanded in this mode
    with pytest.raises(fp.InvalidInput, match="differs from the start"):
        fp.Problem(**arguments(robot, goal=turned, lattice=fp.Lattice(4)))


def test_an_opposite_quaternion_is_the_same_attitude(robot):
    opposite = np.array(robot.neutral())
    opposite[3:7] *= -1
    with pytest.raises(fp.InvalidInput, match="differs from the start"):
        fp.Problem(**arguments(robot, goal=opposite, mode="attitude-held", lattice=fp.Lattice(4)))


def test_a_lateral_axis_needs_a_direction_of_travel(robot):
    with pytest.raises(fp.InvalidInput, match="no direction of travel"):
        fp.Problem(**arguments(robot, goal=robot.configuration(joints={"left_1": 1.0})))


@pytest.mark.parametrize(
    ("behind", "error"), [(-0.5, fp.StartInCollision), (9.5, fp.GoalInCollision)]
)
def test_start_or_goal_in_collision_names_link_and_obstacle(robot, behind, error):
    scene = fp.Scene([[5, 3, 0], [behind, 0, 0]], [0.5, 0.3])
    with pytest.raises(error, match=r"link 'base' is 0\.05\d* m inside obstacle 1") as caught:
        fp.plan(fp.Problem(**arguments(robot, scene=scene)))
    assert (caught.value.link, caught.value.obstacle) == ("base", 1)
    assert caught.value.depth == pytest.approx(0.05, abs=0.01)  # the goal's base has turned


def test_a_start_in_self_collision_names_both_links(robot):
    folded = robot.configuration(joints=ARMS_THROUGH_EACH_OTHER)
    with pytest.raises(fp.StartInCollision, match=r"link '\w+' is .* inside link '\w+'"):
        fp.plan(fp.Problem(**arguments(robot, start=folded)))


def test_a_goal_in_self_collision_names_both_links(robot):
    folded = robot.configuration((10, 0, 0), joints=ARMS_THROUGH_EACH_OTHER)
    with pytest.raises(fp.GoalInCollision, match=r"link '\w+' is .* inside link '\w+'"):
        fp.plan(fp.Problem(**arguments(robot, goal=folded)))


def test_obstacles_that_close_every_way_are_named(robot):
    scene = fp.Scene([[5, y, 0] for y in np.arange(-6, 7)], [0.8] * 13)
    with pytest.raises(fp.NoPath, match=r"layer \d of 10 .*closed by obstacles") as caught:
        fp.plan(fp.Problem(**arguments(robot, scene=scene)))
    assert 3 <= caught.value.layer <= 5
    assert caught.value.obstacles


def test_an_unknown_planner_or_a_wrong_seed_is_refused(robot):
    problem = fp.Problem(**arguments(robot))
    with pytest.raises(fp.InvalidInput, match="planner"):
        fp.plan(problem, planner="ants")
    for seed in (-1, 1.5, "0"):
        with pytest.raises(fp.InvalidInput, match="seed"):
            fp.plan(problem, seed=seed)


def test_a_path_parameter_outside_zero_and_one_is_refused(fig2a_plan):
    for s in (-1e-9, 1.0001, [0.5, 2.0], np.nan):
        with pytest.raises(fp.InvalidInput, match=r"\bs\b"):
            fig2a_plan.at(s)


def test_every_error_has_one_root_and_survives_pickling():
    import pickle

    errors = [
        fp.InvalidInput("delta", -1, "at least 0"),
        fp.StartInCollision("base", 3, 0.1),
        fp.GoalInCollision("base", "arm", 0.1),
        fp.NoPath(3, (1, "arm"), 40),
    ]
    for error in errors:
        assert isinstance(error, fp.FfsrPlanError)
        again = pickle.loads(pickle.dumps(error))
        assert str(again) == str(error)
        assert again.__dict__ == error.__dict__


def test_huge_numbers_are_refused_before_they_reach_coal(robot):
    """Far from the origin a coordinate has no digits left for the margins of the proofs."""
    with pytest.raises(fp.InvalidInput, match=r"scene centers.*at most 100000"):
        fp.Scene([[2e5, 0, 0]], [1.0])
    with pytest.raises(fp.InvalidInput, match=r"scene radii.*1e\+09"):
        fp.Scene([[0, 0, 0]], [1e200])
    with pytest.raises(fp.InvalidInput, match=r"position.*at most 100000"):
        robot.configuration((1e12, 0, 0))
    q = robot.neutral()
    q[0] = 2e5
    with pytest.raises(fp.InvalidInput, match=r"start \(base position\).*at most 100000"):
        fp.Problem(**arguments(robot, start=q))
    with pytest.raises(fp.InvalidInput, match=r"spacing.*at most 1e\+06"):
        fp.Axis(2, 1e200)
    with pytest.raises(fp.InvalidInput, match=r"beta.*at most 40"):
        fp.MaxMinAntSystem(beta=1e6)


def test_a_lattice_too_large_for_memory_is_refused_with_its_size(robot):
    huge = fp.Lattice(40, fp.Axis(100_000, 1e-4))
    with pytest.raises(fp.InvalidInput, match=r"layers 41 x nodes 200001 .*at most 2 GB"):
        fp.plan(fp.Problem(**arguments(robot, lattice=huge)))
    with pytest.raises(fp.InvalidInput, match="at most 100000"):
        fp.AntSystem(ants=10**9)


def test_things_of_another_kind_are_refused_by_name(robot):
    scenario = fp.Scenario.load("fig2a")
    cases = {
        "problem": [lambda: fp.plan(scenario), lambda: fp.plan(None), lambda: fp.plan("fig2a")],
        "joints": [lambda: robot.configuration(joints=[1, 2])],
        "robot": [lambda: fp.load_robot(None), lambda: fp.clearance(3, fp.Scene(), [0.0])],
        "scene": [lambda: fp.clearance(robot, 4, robot.neutral())],
        "scenario": [lambda: fp.load_scenario(None)],
        "lattice": [lambda: fp.Problem(**arguments(robot, lattice=0))],
        "refine": [lambda: fp.plan(scenario.problem, refine="no")],
        "on_cycle": [lambda: fp.plan(scenario.problem, on_cycle=3)],
        "cost_aware": [lambda: fp.MaxMinAntSystem(cost_aware="no")],
        "pheromone": [lambda: fp.MaxMinAntSystem(pheromone=3)],
    }
    for name, calls in cases.items():
        for call in calls:
            with pytest.raises(fp.InvalidInput, match=name):
                call()


def test_an_unwritable_file_is_named_and_leaves_nothing_behind(fig2a_plan, tmp_path):
    with pytest.raises(fp.InvalidInput, match="nowhere"):
        fig2a_plan.save(tmp_path / "nowhere" / "plan.json")
    with pytest.raises(fp.InvalidInput, match=str(tmp_path)):
        fig2a_plan.save(tmp_path)
    with pytest.raises(fp.InvalidInput, match="page"):
        fig2a_plan.write_html(tmp_path / "nowhere" / "plan.html")
    assert list(tmp_path.iterdir()) == []
    assert not tmp_path.with_name(tmp_path.name + ".part").exists()
