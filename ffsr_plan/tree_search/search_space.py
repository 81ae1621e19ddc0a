"""The configuration space of a problem: coordinates, bounds, and the arrays of the search."""

from __future__ import annotations

import heapq

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, Records, records
from ffsr_plan.dynamics.kernels.bodies import LINK_STATE, ROBOT_STATE, base_at_rest
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.problem import Problem
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.shape_arrays import BOX
from ffsr_plan.tree_search.kernels.clear_step import pair_gaps
from ffsr_plan.tree_search.kernels.flight import fly
from ffsr_plan.tree_search.kernels.path_cost import clearance_at
from ffsr_plan.tree_search.kernels.search_arrays import (
    JOINTS,
    SETUP,
    SHAPE,
    TURN,
    SearchArrays,
)

_STACK = 64  # entries of a stack for `nearest_obstacle`
_LEAST_STEP = 0.008  # [m] of travel between two checks
_LARGEST_TURN = 0.15  # [rad or m] of a joint in a step of the integration
_JOINT_WEIGHT = 0.6  # metres that a radian counts in distances of the search
_BEYOND = 0.5  # [rad] beyond both ways round that a continuous joint may go
_MISSED_WEIGHT = 400.0  # metres of length that a radian of a missed attitude counts
_MOST_GOALS = 8  # ways round of continuous joints, shortest first


class SearchSpace:
    """Coordinates of a problem's states and what kernels need to fly between them.

    Attributes:
        problem: the problem.
        start: (D,) state at the start.
        goals: (G, D) states at the goals, one for each way round of the continuous joints, the
            nearest first.
        problems: (G) the problem with the one goal of each of them.
        turn: (3,) rotation vector from the start's attitude to the goal's, base axes [rad]; zero
            where the attitude reacts.
        arrays: robot, scene and settings for kernels.
    """

    def __init__(self, problem: Problem, margin: float) -> None:
        """Set up the search.

        Args:
            problem: a problem without a lattice.
            margin: clearance that is kept from obstacles and between links [m].
        """
        self.problem = problem
        robot, held = problem.robot, problem.mode.has_wheels
        self.turn: Array = np.zeros(3)
        if held:
            self.turn = rotations.rotation_vector(problem.start[3:7], problem.goal[3:7])
        self.start: Array = np.zeros(JOINTS + robot.nd)
        self.start[:3] = problem.start[:3]
        self.start[JOINTS:] = robot.joint_values(problem.start)
        self.goals, self.problems = self._goals()
        self.arrays = SearchArrays(
            bodies=robot.bodies,
            links=base_at_rest(records(LINK_STATE, len(robot.bodies))),
            robot=records(ROBOT_STATE, 1),
            joints=np.zeros((2, robot.nd)),
            shapes=_shapes(robot),
            pairs=np.array(
                [(p.first, p.second) for p in robot.collision_model.collisionPairs], dtype=np.int64
            ).reshape(-1, 2),
            tree=problem.obstacles.tree,
            setup=self._setup(margin),
            box=self._box(),
            weights=self._weights(),
            bars=np.zeros((0, len(self.start) + 2)),
            stack=np.zeros(_STACK, dtype=np.int32),
            bounds=np.zeros(_STACK),
            frame=np.zeros(15),
            still=np.zeros(3),
        )
        self._settle()

    def _settle(self) -> None:
        """Leave to the proof what the search would refuse at start and goal already.

        Distances of hulls are lower bounds, those of the boxes around them. Pairs of links that are
        nearer than the margin at an end are not looked at by the search, and where an end is nearer
        to an obstacle than twice the margin, the margin is smaller.
        """
        setup, arrays = self.arrays.setup[0], self.arrays
        arrival, near = np.zeros(4), np.zeros(len(arrays.pairs), dtype=np.bool_)
        attitude, margin = np.array(self.problem.start[3:7]), float(setup["margin"])
        for state in (self.start, *self.goals):
            fly(arrays, self.start, attitude, state, arrival, False)
            clearance = float(clearance_at(arrays, state, arrival))
            near |= pair_gaps(arrays) <= setup["self_margin"]
            if state is self.start or clearance > 0.0:
                margin = min(margin, clearance - 0.5 * abs(clearance))
        setup["margin"] = margin
        setup["checks"] = 0
        self.arrays = arrays._replace(pairs=arrays.pairs[~near])

    def goal_at(self, state: Array) -> int:
        """The number of the goal at a state (D,)."""
        return int(np.argmin(np.sum((self.goals - state) ** 2, axis=1)))

    def states_along(self, motion: Motion) -> Array:
        """The states at the corners of a motion.

        Args:
            motion: from the start to one of the goals.

        Returns:
            (m + 1, D) states.
        """
        states = np.tile(self.start, (motion.edges + 1, 1))
        if not motion.mode.floats:
            states[:, :3] = motion.positions
        shares = motion.turn_shares
        if shares is None:
            shares = np.arange(motion.edges + 1) / motion.edges
        states[:, TURN] = shares * self.goals[0, TURN]
        states[:, JOINTS:] = motion.joint_values
        states[-1] = self.goals[self.goal_at(states[-1])]
        return states

    def aim_at(self, goal: int) -> None:
        """Have paths arrive at the attitude of a goal, where that is demanded.

        Args:
            goal: its number.
        """
        self.arrays.setup[0]["goal"] = self.problems[goal].goal[3:7]

    def _goals(self) -> tuple[Array, tuple[Problem, ...]]:
        """States at the goals, and their problems: at least one state for each goal."""
        firsts, others = [], []
        for each in self.problem.goals:
            problem = self.problem.ending_at(each)
            ways = [(self._length(state), state, problem) for state in self._ways_to(problem)]
            ways.sort(key=lambda way: way[0])
            firsts.append(ways[0])
            others += ways[1:]
        others.sort(key=lambda way: way[0])
        chosen = firsts + others[: max(0, _MOST_GOALS - len(firsts))]
        chosen.sort(key=lambda way: way[0])
        return (
            np.array([way[1] for way in chosen]),
            tuple(self._ending_in(way[2], way[1]) for way in chosen),
        )

    def _ending_in(self, problem: Problem, state: Array) -> Problem:
        """A problem whose goal has the joint values of a state (D,)."""
        goal = problem.goal
        return problem.ending_at(problem.robot.assemble(goal[:3], goal[3:7], state[JOINTS:]))

    def _length(self, state: Array) -> float:
        """Squared change of the joints from the start to a state (D,)."""
        return float(np.sum((state - self.start)[JOINTS:] ** 2))

    def _ways_to(self, problem: Problem) -> list[Array]:
        """(D,) states at the goal of a problem, for each way round of its revolute joints."""
        goal, begin = self.start.copy(), self.start[JOINTS:]
        goal[:3] += problem.base_displacement
        goal[TURN] = float(np.linalg.norm(self.turn))
        shortest: list[tuple[float, tuple[float, ...]]] = [(0.0, ())]
        for joint, change in enumerate(problem.joint_displacement.tolist()):
            ends = self._changes(joint, float(begin[joint]), change)
            longer = [(square + end**2, (*way, end)) for square, way in shortest for end in ends]
            shortest = heapq.nsmallest(_MOST_GOALS, longer)
        return [goal + np.append(np.zeros(JOINTS), way) for _, way in shortest]

    def _changes(self, joint: int, begin: float, change: float) -> list[float]:
        """The change of a joint, and those that are a whole turn more or less and allowed."""
        robot, found = self.problem.robot, [change]
        if robot.prismatic[joint]:
            return found
        for turn in (-2.0 * np.pi, 2.0 * np.pi):
            allowed = robot.lower[joint] <= begin + change + turn <= robot.upper[joint]
            if np.isinf(robot.upper[joint]):
                allowed = (turn < 0.0) == (change > 0.0)  # the other way round
            if allowed:
                found.append(change + turn)
        return found

    def _box(self) -> Array:
        problem, robot = self.problem, self.problem.robot
        ends = np.vstack([self.start, self.goals])
        box = np.stack([ends.min(axis=0), ends.max(axis=0)])
        if not problem.mode.floats:
            box[:, :3] = problem.base_window
        free = np.isinf(robot.upper)
        box[0, JOINTS:] = np.where(free, box[0, JOINTS:] - _BEYOND, robot.lower)
        box[1, JOINTS:] = np.where(free, box[1, JOINTS:] + _BEYOND, robot.upper)
        return box

    def _weights(self) -> Array:
        problem, robot = self.problem, self.problem.robot
        weights = np.ones((2, len(self.start)))
        weights[0, TURN:] = _JOINT_WEIGHT
        weights[0, JOINTS:][robot.prismatic] = 1.0
        weights[1, :TURN] = problem.position_weight
        weights[1, TURN:] = problem.rotation_weight
        weights[1, JOINTS:][robot.prismatic] = problem.position_weight
        if problem.mode.floats:
            weights[:, :3] = 0.0
        return weights

    def _setup(self, margin: float) -> Records:
        problem = self.problem
        setup = records(SETUP, 1)
        setup["reacts"], setup["floats"] = problem.mode.attitude_reacts, problem.mode.floats
        angle = float(np.linalg.norm(self.turn))
        setup["axis"] = self.turn / angle if angle > 0.0 else 0.0
        center = centers_of_mass(problem.robot, self.start[None, JOINTS:])
        setup["anchor"] = problem.start[:3] + rotations.rotate(problem.start[None, 3:7], center)[0]
        setup["margin"] = setup["self_margin"] = margin
        unit = problem.length_unit
        setup["nearness_weight"] = problem.delta * unit**2
        setup["cap"] = np.inf if problem.clearance_cap is None else problem.clearance_cap
        if problem.reach_attitude:
            setup["goal"], setup["missed_weight"] = problem.goal[3:7], _MISSED_WEIGHT
        setup["least_step"], setup["largest_turn"] = _LEAST_STEP, _LARGEST_TURN
        return setup


def _shapes(robot: SpaceRobot) -> Records:
    """(g,) of `SHAPE`."""
    given, box = robot.primitives, robot.primitives.kinds == BOX
    shapes = records(SHAPE, len(given.kinds))
    shapes["link"], shapes["kind"] = given.links, given.kinds
    shapes["rotation"], shapes["position"] = given.rotations, given.positions
    shapes["frame"][:, 12:] = given.sizes
    shapes["skin"][~box] = given.sizes[~box, 0]
    shapes["reach"] = np.where(box, np.linalg.norm(given.sizes, axis=1), given.sizes[:, 1])
    return shapes
