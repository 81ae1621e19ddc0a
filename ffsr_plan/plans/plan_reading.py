"""Plans made from the tables of a file, whose parts have to agree with one another."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import finite_array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.settings import UnknownKey, from_mapping
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.lattice.certificate import Certificate
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.plans.fuel_reading import fuel_of
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.plans.plan_tables import PlanTable, ProblemTable, RobotTable
from ffsr_plan.plans.robot_table import robot_table
from ffsr_plan.plans.search_figures import check_search
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.problem.problem import Problem
from ffsr_plan.robots.collision_shapes import Containers
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.search.records import Branches, History, Trails

PLAIN = (
    "delta", "length_unit", "clearance_cap", "position_weight", "rotation_weight",
    "tolerance", "min_clearance", "reach_attitude",
)  # fmt: skip
"""Fields of a problem that a file holds as they are."""
_AGREEMENT = 1e-9  # [m, rad] between the motion and the configurations beside it
_LARGEST_STEP = 1000.0  # [rad or m] of a joint over an edge: the reaction to more takes too long

T = TypeVar("T")


def plan_of(what: str, data: Mapping[str, Any]) -> PlanData:
    """The plan of a table; `what` names the table in errors.

    Raises:
        InvalidInput: with the path of the field in the table.
    """
    table = _within(what, "", lambda: from_mapping(PlanTable, data))
    _check_sizes(what, table)
    problem = _problem(what, table.problem)
    lattice = None
    if problem.lattice is not None:
        _check_nodes(what, table, problem.lattice)
        if problem.lattice.progress is None:
            lattice = _within(what, "problem.lattice", lambda: LayeredLattice(problem))
    _within(what, "planner", lambda: table.planner.refuse(problem))
    check_search(what, table, problem)
    least = table.certificate.least_clearance
    counts = table.certificate
    return PlanData(
        problem=problem,
        planner=table.planner,
        seed=table.seed,
        lattice=lattice,
        motion=_motion(what, table, problem),
        nodes=table.nodes,
        length=table.length,
        objective=table.objective,
        lattice_objective=table.lattice_objective,
        optimum=table.optimum,
        optimum_is_exact=table.optimum_is_exact,
        clearances=table.clearances,
        history=History(*(getattr(table.history, name) for name in History._fields)),
        trails=_search_edges(what, table),
        certificate=Certificate(
            counts.edges_free, counts.edges_refused, counts.node_queries, counts.edge_queries,
            np.inf if least is None else least, problem.robot.unchecked_links,
        ),
        interrupted=table.interrupted,
        seconds=table.seconds,
        fuel=fuel_of(what, table, problem),
    )  # fmt: skip


def _within(what: str, path: str, make: Callable[[], T]) -> T:
    """What a function makes; its errors name the file and the table's path."""
    try:
        return make()
    except InvalidInput as error:
        inner = error.what.removeprefix(".")
        if path and (isinstance(error, UnknownKey) or path.endswith("robot")):
            inner = f"{path}: {inner}"  # errors of a robot begin with its name
        elif path:
            inner = f"{path}.{inner}" if re.match(r"[a-z_]+\b", inner) else path + inner
        where = f"{what}, {inner}" if inner else what
        raise InvalidInput(where, error.value, error.allowed) from None
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError) as error:
        where = f"{what}, {path}" if path else what
        raise InvalidInput(where, str(error), "what a plan file holds") from None


def _check_sizes(what: str, table: PlanTable) -> None:
    """Raise `InvalidInput` where lists do not fit the number of divisions, or one another."""
    lattice = table.problem.lattice
    if lattice is None:
        corners = len(table.motion.positions)
        nodes: tuple[int, ...] = (0,)
    else:
        corners, axes = lattice.divisions + 1, len(lattice.axes) + len(lattice.postures)
        axes += lattice.progress is not None
        nodes = (corners, axes) if axes > 1 else (corners,)
    rows = {
        "nodes": (table.nodes, nodes),
        "clearances": (table.clearances, (corners,)),
        "motion.positions": (table.motion.positions, (corners, 3)),
        "configurations": (table.configurations, (corners, len(table.problem.start))),
    }
    for name, (array, wanted) in rows.items():
        if array.shape != wanted:
            raise InvalidInput(f"{what}, {name}", array.shape, f"the shape {wanted}")
    for name in ("history", "trails"):
        columns = {key: len(column) for key, column in vars(getattr(table, name)).items()}
        if len(set(columns.values())) > 1:
            raise InvalidInput(f"{what}, {name}", columns, "columns of one length")


def _problem(what: str, table: ProblemTable) -> Problem:
    scene = table.scene
    robot = _robot(what, table.robot)
    made = _within(
        what,
        "problem.scene",
        lambda: Scene(
            scene.centers,
            scene.radii,
            scene.excess,
            scene.sources,
            scene.shapes,
            scene.keep_in,
            scene.growth,
            [body.body() for body in scene.bodies],
            [cloud.cloud() for cloud in scene.debris],
        ),
    )
    return _within(
        what,
        "problem",
        lambda: Problem(
            robot,
            made,
            start=table.start,
            goal=table.goal,
            lattice=table.lattice,
            mode=table.mode,
            window=table.window,
            duration=table.duration,
            ramp=table.ramp,
            **{name: getattr(table, name) for name in PLAIN},
        ),
    )


def _robot(what: str, table: RobotTable) -> SpaceRobot:
    """The robot; collision meshes come from the plan, not from their files.

    Raises:
        InvalidInput: what the plan says of replacements and exempt pairs is not what its URDF, SRDF
            and meshes give.
    """
    path = f"{what}, problem.robot"
    robot = _within(
        what,
        "problem.robot",
        lambda: robot_from_urdf(
            table.urdf,
            table.name,
            table.package_dirs,
            srdf=table.srdf,
            containers=Containers(table.containers.meshes, table.containers.cylinders),
            meshes=table.meshes,
            collision="ignore",  # the URDF of a plan was accepted when the plan was made
        ),
    )
    remade = robot_table(robot)
    if table.disabled_pairs != remade["disabled_pairs"]:
        allowed = f"those of its SRDF: {remade['disabled_pairs']}"
        raise InvalidInput(f"{path}.disabled_pairs", table.disabled_pairs, allowed)
    if unused := table.meshes.keys() - remade["meshes"].keys():
        raise InvalidInput(f"{path}.meshes", sorted(unused), "meshes that the URDF names")
    stated = [vars(each) for each in table.replacements]
    expected = remade["replacements"]
    if len(stated) != len(expected) or not all(map(_same_replacement, stated, expected)):
        allowed = f"those of its URDF and meshes: {expected}"
        raise InvalidInput(f"{path}.replacements", stated, allowed)
    return robot


def _same_replacement(stated: dict[str, Any], expected: dict[str, Any]) -> bool:
    """Whether two records agree but for rounding, which may also change a number of vertices."""
    if any(stated[k] != expected[k] for k in ("link", "number", "shape")):
        return False
    kinds = [re.sub(r"\d+", "n", record["by"]) for record in (stated, expected)]
    difference = abs(stated["excess"] - expected["excess"])
    return kinds[0] == kinds[1] and bool(difference <= 1e-9 + 1e-6 * expected["excess"])


def _motion(what: str, table: PlanTable, problem: Problem) -> Motion:
    """The motion; the configurations beside it are for other readers, and have to agree with it."""
    robot, values = problem.robot, table.motion.joint_values
    if values is not None:
        shape, name = (len(table.motion.positions), robot.nd), f"{what}, motion.joint_values"
        if values.shape != shape:
            raise InvalidInput(name, values.shape, f"the shape {shape}")
        values = finite_array(name, values, shape)
        _check_joint_values(name, values, robot)
    positions = finite_array(f"{what}, motion.positions", table.motion.positions, (-1, 3))
    motion = _within(
        what,
        "motion",
        lambda: Motion(
            robot,
            problem.mode,
            problem.start,
            problem.goal,
            positions,
            values,
            table.motion.turn_shares,
        ),
    )
    stored, made = table.configurations, motion.configurations()
    if stored.shape != made.shape or not np.max(np.abs(stored - made)) <= _AGREEMENT:
        raise InvalidInput(f"{what}, configurations", "others", "those of its motion")
    apart = np.max(np.abs(positions - motion.positions))
    if not apart <= _AGREEMENT:  # where the robot floats, they follow from the joints
        raise InvalidInput(f"{what}, motion.positions", "others", "those of its joint values")
    return motion


def _search_edges(what: str, table: PlanTable) -> Trails | Branches:
    """Trails of ants, or branches of trees without a lattice."""
    branches, free = table.branches, table.problem.lattice is None
    if (branches is None) == free:
        allowed = "branches of the trees" if free else "none on a lattice"
        raise InvalidInput(f"{what}, branches", branches, allowed)
    if branches is None:
        return Trails(*(getattr(table.trails, name) for name in Trails._fields))
    rows = len(branches.tree)
    for name in ("begin", "end"):
        shape = getattr(branches, name).shape
        if shape != (rows, 3) and not (rows == 0 and shape[0] == 0):
            raise InvalidInput(f"{what}, branches.{name}", shape, f"the shape {(rows, 3)}")
    if np.any(branches.tree > 1):
        raise InvalidInput(f"{what}, branches.tree", int(branches.tree.max()), "0 or 1")
    begin, end = (getattr(branches, name).reshape(rows, 3) for name in ("begin", "end"))
    return Branches(begin, end, branches.tree)


def _check_joint_values(what: str, values: Array, robot: SpaceRobot) -> None:
    """Raise `InvalidInput` for values outside the limits, and steps too long to follow."""
    for k, name in enumerate(robot.joint_names):
        lower, upper = robot.lower[k] - _AGREEMENT, robot.upper[k] + _AGREEMENT
        outside = values[:, k][(values[:, k] < lower) | (values[:, k] > upper)]
        if len(outside):
            allowed = f"{robot.lower[k]:g} to {robot.upper[k]:g}"
            raise InvalidInput(f"{what}, {name}", float(outside[0]), allowed)
        step = float(np.max(np.abs(np.diff(values[:, k]))))
        if step > _LARGEST_STEP:
            raise InvalidInput(f"{what}, {name}", step, f"steps of at most {_LARGEST_STEP:g}")


def _check_nodes(what: str, table: PlanTable, lattice: Lattice) -> None:
    """Raise `InvalidInput` for nodes that the lattice does not have."""
    counts = {name: getattr(lattice, name).half_count for name in lattice.axes}
    known = {name: range(-n, n + 1) for name, n in counts.items()}
    known |= {f"postures.{k}": axis.indices for k, axis in enumerate(lattice.postures)}
    if (given := lattice.progress) is not None:
        known["progress"] = range(-given.before, given.steps + given.beyond + 1)
    known = known or {"no axis": range(1)}
    nodes = table.nodes.reshape(len(table.nodes), -1)
    for (axis, inside), column in zip(known.items(), nodes.T, strict=True):
        for node in column.tolist():
            if node not in inside:
                allowed = f"{inside[0]} to {inside[-1]}"
                raise InvalidInput(f"{what}, nodes, {axis}", node, allowed)
