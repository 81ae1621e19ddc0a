"""Every argument of the public interface, given wrong values: refused by an error of ffsr-plan.

Each call takes good arguments but for one. It may succeed, because some of the values are right for
some arguments; what it may raise is `FfsrPlanError` alone.
"""

import itertools
import webbrowser
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
import trimesh

import ffsr_plan as fp
from tests.helpers.small_studies import small_problem

ODD_VALUES = [
    None, 3, -1, 0, "x", "", "a\0b", "n" * 5000, float("nan"), float("inf"), 1e308, 10**400, 10**30,
    [], {}, (), object(), True, b"x", [None], [[]], ["1", "2", "3"], [True] * 3, {"x": "y"},
    {3: 4}, np.zeros(3), np.zeros((2, 2)), np.array("x"), np.array([1e400]), 1j, lambda: None, int,
    Path("a\0b"), "\ud800",
]  # fmt: skip
FIELDS = {"joint_acceleration": 1.0, "thruster_acceleration": 1.0}


@pytest.fixture(scope="module")
def plan(robot):
    problem = fp.Problem(
        robot,
        fp.Scene([[1.0, 2.0, 0.0]], [0.3]),
        robot.neutral(),
        robot.configuration((2.0, 0.0, 0.0), joints={"left_1": 0.2}),
        mode="attitude-held",
        lattice=fp.Lattice(3, fp.Axis(1, 0.2)),
    )
    return fp.plan(problem, "lattice-optimum")


@pytest.fixture(scope="module")
def calls(plan, tmp_path_factory):
    """Public functions and methods with good arguments for them, by name."""
    folder = tmp_path_factory.mktemp("wrong")
    problem = plan.problem
    robot, scene, q = problem.robot, problem.scene, problem.start
    flight = plan.timed(**FIELDS)
    view = {"port": 0, "open_browser": False}
    ball = {"low": [0, 0, 0], "high": [1, 1, 1], "radii": [0.1, 0.2]}
    placed = {"position": [0, 0, 0], "attitude": [0, 0, 0], "name": "s"}
    trimesh.creation.box((1.0, 1.0, 1.0)).export(folder / "box.stl")
    scene.to_csv(folder / "s.csv")
    (folder / "track.csv").write_text("t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,0,0,0,0,1\n")
    plan.save(folder / "plan.json")
    np.save(folder / "s.npy", [[0.0, 0.0, 0.0, 1.0]])

    motion = fp.formats.trajectory_of(plan)
    judged = fp.certify(robot, scene, motion)
    fp.formats.write_csv(folder / "motion.csv", motion)
    motion_fields = {name: getattr(motion, name) for name in fp.Trajectory.__annotations__}

    (folder / "study.toml").write_text("[scenario]\nfile = 'fig2a'\n")
    small = small_problem()
    problems = fp.ProblemSet()
    study = fp.Study({"p": small}, "lattice-optimum")
    result = study.run(folder / "study")

    def show_and_go_on(**given):
        return plan.show(**given, block=False)

    settings = {
        fp.Axis: {"half_count": 1, "spacing": 0.1},
        fp.Lattice: {"divisions": 3, "lateral": None, "normal": None, "postures": (),
                     "progress": None},
        fp.Progress: {"steps": 3, "most": 1, "aside": 1, "before": 0, "beyond": 0},
        fp.PostureAxis: {"joints": {"left_1": 1.0}, "half_count": 1, "spacing": 0.1},
        fp.PostureTarget: {"towards": "stowed", "levels": 2},
        fp.PostureAxis.towards: {"posture": "stowed", "levels": 2},
        fp.Departure: vars(fp.Departure([0.0], [0.0])),
        fp.Meeting: vars(fp.Meeting("left_3", 100.0)),
        fp.AntSystem: vars(fp.AntSystem()),
        fp.LeastFuel: vars(fp.LeastFuel(spacing=0.1)),
        fp.MaxMinAntSystem: vars(fp.MaxMinAntSystem()),
        fp.PostureAnnealing: vars(fp.PostureAnnealing()),
        fp.TreePlanner: vars(fp.TreePlanner()),
        fp.Portfolio: vars(fp.Portfolio()),
        fp.Problem: {each.name: getattr(problem, each.name) for each in fields(problem)},
        fp.Bus: {"size": [1, 1, 1], "mass": 3.0, "inertia": None, "center_of_mass": [0, 0, 0],
                 "panels": ()},
        fp.Panel: {"size": [1, 1, 1], "position": [1, 0, 0], "mass": 1.0, "attitude": [0, 0, 0],
                   "name": "p"},
        fp.Mount: {"arm": "ur3", "position": [0, 0, 0], "attitude": [0, 0, 0], "prefix": "a_",
                   "locked": {}, "srdf": None},
        fp.Scene: {"centers": [[0, 0, 0]], "radii": [1.0], "excess": 0.0, "sources": (),
                   "shapes": (), "keep_in": (), "growth": 0.0, "bodies": (),
                   "debris": ()},
        fp.DebrisCloud: {"centers": [[0, 0, 0]], "radii": [1.0], "velocities": [[0, 0, 0]],
                         "name": "d"},
        fp.MovingBody: {"shapes": [fp.Ball(1.0)], "motion": fp.Drift(), **placed},
        fp.Drift: {"velocity": [0, 0, 0]},
        fp.Spin: {"rate": [0, 0, 1], "velocity": [0, 0, 0]},
        fp.Tumble: {"inertia": [1, 1, 1], "rate": [0, 0, 1], "velocity": [0, 0, 0],
                    "known_until": 10.0},
        fp.Track: {"times": [0, 1], "positions": np.zeros((2, 3)),
                   "attitudes": [[0, 0, 0, 1]] * 2},
        fp.PoseFunction: {"function": lambda t: (np.zeros(3), [0, 0, 0, 1]), "speed": 1.0,
                          "turn_rate": 0.0, "known_until": 9.0},
        fp.Box: {"size": [1, 1, 1], **placed},
        fp.Ball: {"radius": 1.0, "position": [0, 0, 0], "name": "b"},
        fp.Capsule: {"radius": 1.0, "length": 1.0, **placed},
        fp.Cylinder: {"radius": 1.0, "length": 1.0, **placed},
        fp.Ellipsoid: {"semi_axes": [1, 1, 1], **placed},
        fp.Hull: {"points": np.vstack([np.zeros(3), np.eye(3)]), **placed},
        fp.HalfSpace: {"direction": [1, 0, 0], "position": [0, 0, 0], "name": "h"},
    }  # fmt: skip
    return {
        **settings,
        fp.Scene.from_csv: {"path": folder / "s.csv"},
        fp.Scene.from_numpy: {"path": folder / "s.npy"},
        fp.Scene.from_mesh: {"mesh": _Box(), "excess": 0.3, "scale": 1.0, "position": [0, 0, 0],
                             "attitude": [0, 0, 0], "inside": True},
        fp.Track.from_csv: {"path": folder / "track.csv"},
        fp.Hull.from_mesh: {"mesh": folder / "box.stl", "scale": 1.0, **placed},
        fp.Scene.from_urdf: {"source": "point", "position": [0, 0, 0], "attitude": [0, 0, 0],
                             "joints": None, "name": "t"},
        fp.mesh_hulls: {"mesh": _Box(), "pieces": 2, "scale": 1.0, **placed},
        scene.to_csv: {"path": folder / "t.csv"},
        fp.generators.cloud: {"seed": 1, "count": 2, **ball, "spared": ()},
        fp.generators.belt: {"seed": 1, "count": 2, "radius": 3.0, "thickness": 1.0,
                             "radii": [0.1, 0.2], "center": [0, 0, 0], "attitude": [0, 0, 0],
                             "arc": [0, 1], "spared": ()},
        fp.generators.scatter: {"seed": 1, "counts": [1, 2], "low": [0, 0], "high": [1, 1],
                                "radii": [0.1, 0.2]},
        fp.generators.truss: {"begin": [0, 0, 0], "end": [1, 0, 0], "width": 0.3, "bays": 1,
                              "radius": 0.1, "roll": 0.0},
        fp.generators.gate: {"along": 1.0, "aside": 0.0, "opening": 1.0, "radius": 0.1},
        fp.load_robot: {"source": "point", "package_dirs": (), "srdf": None, "meshes": "hull",
                        "cylinders": "hull", "collision": "collision", "inertia": "exact",
                        "locked": None},
        fp.load_scenario: {"source": "fig2a"},
        fp.Scenario.load: {"source": "fig2a"},
        fp.compose: {"bus": fp.Bus([1, 1, 1], 9.0), "arms": [], "name": "s", "shapes": "boxes",
                     "postures": None, "may_touch": ()},
        fp.plan: {"problem": problem, "planner": "lattice-optimum", "seed": 0, "refine": False,
                  "colonies": 1, "workers": 1, "scheduler": None, "time_limit": None,
                  "on_cycle": None,
                  "on_interrupt": "return"},
        fp.refine: {"plan": plan},
        fp.clearance: {"robot": robot, "scene": scene, "q": q},
        fp.self_collisions: {"robot": robot, "q": q},
        fp.self_collisions(robot, q).write_srdf: {"path": folder / "s.srdf"},
        fp.certify_edge: {"robot": robot, "scene": scene, "start": q, "goal": problem.goal,
                          "mode": "free-flying", "tolerance": 1e-3},
        fp.certify: {"robot": robot, "scene": scene, "trajectory": motion, "mode": "free-flying",
                     "base_position": [0, 0, 0], "base_attitude": [0, 0, 0], "frame": None,
                     "tolerance": 1e-4},
        fp.Trajectory: motion_fields,
        fp.Trajectory.of_array: {"times": [0, 1], "values": [[0.0], [1.0]], "names": ["a"],
                                 "velocities": None},
        judged.at: {"times": [0.5]},
        judged.write_html: {"path": folder / "j.html", "title": "t"},
        fp.on_bus: {"robot": robot, "mass": 5.0, "inertia": None, "center_of_mass": [0, 0, 0]},
        fp.formats.trajectory_of: {"source": plan, "duration": 3.0, "rate": 5.0},
        fp.formats.messages_of: {"trajectory": motion, "frame_id": "w", "base_joint": "b"},
        fp.formats.read_trajectory: {"path": folder / "motion.csv", "interpolation": "cubic"},
        fp.formats.write_trajectory: {"path": folder / "t.json", "trajectory": motion},
        fp.formats.write_aem: {"path": folder / "t.aem", "trajectory": motion, "frames": None},
        fp.formats.write_oem: {"path": folder / "t.oem", "trajectory": motion, "frames": None},
        fp.formats.read_aem: {"path": folder / "t.aem"},
        fp.formats.read_scene: {"path": folder / "s.csv"},
        fp.formats.write_moveit_scene: {"path": folder / "s.scene", "scene": scene},
        fp.formats.write_primitives: {"path": folder / "s.json", "scene": scene},
        fp.formats.read_primitives: {"path": folder / "s.json", "problem": 0},
        fp.ProblemSet: {"folder": None},
        problems.names: {"family": "traps"},
        problems.entry: {"name": "traps/00"},
        problems.best.get: {"name": "traps/00"},
        problems.best.trajectory: {"name": "traps/00"},
        fp.judge: {"given": problems["paper/00"], "trajectory": motion},
        fp.Study: {"problems": {"p": small}, "planners": None, "seeds": 1, "title": "t",
                   "axes": None, "refine": None, "time_limit": None, "memory_limit": None,
                   "plans": True},
        fp.Study.load: {"path": folder / "study.toml"},
        study.run: {"directory": folder / "study", "workers": 1, "scheduler": None,
                    "engine": "in-process", "retry_failed": False, "progress": False},
        fp.StudyResult: {"directory": folder / "study"},
        result.plan: {"row": result.rows()[0]},
        result.to_csv: {"path": folder / "rows.csv"},
        result.to_parquet: {"path": folder / "rows.parquet"},
        result.write_report: {"directory": folder / "report"},
        fp.formats.write_mjcf: {"path": folder / "m.xml", "robot": robot, "scene": scene,
                                "trajectory": motion},
        fp.inverse_kinematics: {"robot": robot, "scene": None, "frame": "left_3",
                                "position": [0.4, 0.5, 0.0], "attitude": None, "start": q,
                                "mode": "attitude-held", "base_position": None,
                                "base_attitude": None, "seed": 0},
        problem.reaching: {"frame": "left_3", "position": [2.0, 1.0, 0], "attitude": None,
                           "seed": 0, "tries": 2},
        problem.ending_at: {"q": q},
        fp.momentum.connection: {"robot": robot, "q": q},
        fp.momentum.attitude_rate_map: {"robot": robot, "q": q},
        fp.momentum.generalized_jacobian: {"robot": robot, "q": q, "frame": "left_3"},
        fp.least_singular_value: {"robot": robot, "q": q, "frame": "left_3", "attitude": True},
        fp.LayeredLattice: {"problem": problem},
        fp.Motion: {"robot": robot, "mode": "free-flying", "start": q, "goal": problem.goal,
                    "positions": np.zeros((3, 3)), "joint_values": np.zeros((3, robot.nd))},
        fp.Roadmap: {"problem": problem},
        fp.LiveView: {"problem": problem, **view, "pace": 0.0, "title": "t"},
        robot.configuration: {"position": [0, 0, 0], "attitude": [0, 0, 0], "joints": {}},
        robot.components: {"q": q},
        robot.paper_vector: {"q": q},
        robot.from_paper_vector: {"vector": np.zeros(robot.nd + 6)},
        robot.save: {"path": folder / "r.urdf"},
        plan.at: {"s": 0.5},
        plan.wheel_momentum: {"duration": 3.0, "times": None},
        plan.verify: {"samples": 5},
        plan.save: {"path": folder / "p.json"},
        fp.Plan.load: {"path": folder / "plan.json"},
        fp.Plan.from_dict: {"data": plan.to_dict()},
        plan.to_csv: {"path": folder / "p.csv", "samples": 3},
        plan.write_html: {"path": folder / "p.html", "title": "t"},
        plan.write_gif: {"path": folder / "p.gif", "frames": 2, "width": 300, "view": "path"},
        show_and_go_on: {**view, "title": "t"},
        plan.timed: FIELDS | dict.fromkeys(
            ("joint_velocity", "base_velocity", "joint_torque", "joint_jerk", "thruster_jerk",
             "turn_velocity", "turn_acceleration", "duration")
        ) | {"velocity_jump": 0.0, "corners": "smooth", "meeting": None},
        flight.at: {"times": [0.0]},
        flight.clock: {"rate": 1.0},
        flight.to_csv: {"path": folder / "f.csv", "rate": 1.0},
    }  # fmt: skip


class _Box:
    """A cube, as an object with triangles."""

    def __init__(self):
        self.triangles = trimesh.creation.box((1.0, 1.0, 1.0)).triangles


def no_browser():
    raise webbrowser.Error


def finish(result):
    """Stop servers."""
    if hasattr(result, "stop"):
        result.stop()


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_wrong_arguments_are_refused_by_errors_of_the_package(calls, tmp_path, monkeypatch):
    monkeypatch.setattr(webbrowser, "get", no_browser)
    monkeypatch.chdir(tmp_path)  # some of the values are names of files that can be written
    tried, escaped, sentences = 0, [], []
    for function, arguments in calls.items():
        finish(function(**arguments))
        for name, value in itertools.product(arguments, ODD_VALUES):
            tried += 1
            try:
                finish(function(**arguments | {name: value}))
            except fp.FfsrPlanError as error:
                sentences.append(str(error))
            except Exception as error:
                shown = f"{type(value).__name__} {str(value)[:20]!r}"
                escaped.append(f"{function.__qualname__}({name}={shown}): {error!r:.120}")
    assert not escaped, f"{len(escaped)}: " + "\n".join(escaped[:40])
    assert all(sentence.isprintable() for sentence in sentences)
    assert tried > 5000


def test_the_interface_is_covered(calls):
    """Every public function, and every public class that users make, is among the calls."""
    made_by_the_package = {
        "Branches", "Certificate", "Clearance", "Components", "Counts", "CurvePoints",
        "CurvedMotion", "Cycle", "EdgeProof",
        "FlightReport", "FuelFigures", "History", "LatticeOptimum", "Mode", "Motion", "PageServer",
        "Plan",
        "Replacement", "Report", "ArmReach", "JointBeyond",
        "Balanced", "Contact", "HeldBase", "RateLimits", "SelfCollision", "SelfCollisions",
        "UncheckedLinks", "RobotSummary", "Scenario",
        "RecomputedNumber", "SearchResult", "SlowestPlace",
        "SmoothCurve", "SmoothFlight", "SmoothPlan", "Solution", "SpaceRobot",
        "States", "StudyProgress", "TimedPlan", "Trails", "TreeCycle", "Verdict", "WheelMomentum",
        "Pace", "Poses",
        "TrajectoryContact", "TrajectoryReport", "BenchProblem", "Judgement",
    }  # fmt: skip
    without_arguments = {
        "arm_names",
        "literature",
        "robot_names",
        "robot_summaries",
        "warm_up",
    }  # or callbacks
    errors = {name for name in fp.__all__ if isinstance(getattr(fp, name), type)
              and issubclass(getattr(fp, name), Exception)}  # fmt: skip
    covered = {function.__name__ for function in calls}
    modules = {"errors", "formats", "generators", "momentum"}
    missing = set(fp.__all__) - covered - made_by_the_package - without_arguments - errors - modules
    assert not missing
