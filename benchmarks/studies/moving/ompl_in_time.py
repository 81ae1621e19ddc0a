"""OMPL on the scenes of `waiting.py`: place and time as coordinates, at the default resolution.

`control.RRT` plans x, y and the time, the base's velocities being its controls; joints and attitude
follow from the progress, as in a lattice with progress. Its states are checked for free placement
at their times, with the code of `flight_check.py`, which then looks at the path every millisecond.
"""

import time
from typing import NamedTuple

import numpy as np
import ompl.base as ob
import ompl.control as oc
import ompl.util as ou
from scipy.spatial.transform import Rotation

from benchmarks.studies.moving.flight_check import FAR, MILLISECOND, Obstacles, UrdfRobot
from benchmarks.studies.moving.separation_kernels import least_separation
from benchmarks.studies.moving.waiting_scenes import DURATION, FAMILIES, drawn

SPEED, SIDE, NEAR = 0.2, 3.0, 0.1  # [m/s], [m] and [m]
MOST_CHECKS = 60_000  # of states in a run, so that runs are the same on every machine


class Sampled(NamedTuple):
    """A run of OMPL on a scene: time [s], infinite without a path, and least separation [m]."""

    family: str
    seed: int
    run: int
    seconds: float
    least: float = FAR


class Placements:
    """Configurations at places of the base in the plane, and separations at times."""

    def __init__(self, problem, step=MILLISECOND):
        """The robot and the obstacles of a problem, known every `step` [s]."""
        robot, nq = problem.robot, problem.robot.nd
        self.way = float(problem.goal[0])
        self.robot = UrdfRobot(robot.urdf, robot.joint_names)
        self.begin = np.array(problem.start[-nq:])
        self.change = np.array(problem.goal[-nq:]) - self.begin
        start = np.array(problem.start[3:7])
        self.attitudes = self.robot.attitudes(start, self.begin, self.change)
        self.obstacles = Obstacles(problem.scene, problem.duration, step)

    def at(self, x, y):
        """Base and joints at places (n,) of the base."""
        share = np.clip(x / self.way, 0.0, 1.0)
        turns = Rotation.from_quat(self.attitudes(share)).as_matrix()
        base = np.ascontiguousarray(turns), np.column_stack([x, y, np.zeros_like(x)])
        return base, self.begin + share[:, None] * self.change

    def is_free(self, state):
        """Whether nothing is touched at a state of x, y and time."""
        x, y, moment = (state[k] for k in range(3))
        if not 0.0 <= moment <= DURATION:
            return False
        base, joints = self.at(np.array([x]), np.array([y]))
        n, angles = round(moment / self.obstacles.step), self.robot.angles(joints)
        for shapes, (turns, places) in self.obstacles.groups:
            here = turns[n : n + 1], places[n : n + 1]
            found = least_separation(
                self.robot.tree, self.robot.boxes, base, angles, here, shapes, FAR
            )
            if found[0] <= 0.0:
                return False
        return True

    def least(self, states):
        """The least separation on a path (k, 3) of x, y and time, until its end [m]."""
        times = np.arange(0.0, states[-1, 2] + 1e-9, self.obstacles.step)
        x, y = (np.interp(times, states[:, 2], states[:, k]) for k in (0, 1))
        base, joints = self.at(x, y)
        angles, best, n = self.robot.angles(joints), FAR, len(times)
        for shapes, (turns, places) in self.obstacles.groups:
            body = turns[:n], places[:n]
            best, _ = least_separation(
                self.robot.tree, self.robot.boxes, base, angles, body, shapes, best
            )
        return best


class AtGoal(ob.GoalRegion):
    """The goal's place, at any time."""

    def __init__(self, information, way):
        super().__init__(information)
        self._way = way
        self.setThreshold(NEAR)

    def distanceGoal(self, state):  # noqa: N802 - OMPL's name
        """Distance from the goal's place [m]; OMPL calls it."""
        return float(np.hypot(state[0] - self._way, state[1]))


def _box(space, bounds):
    """Set the bounds (k, 2) of a real vector space."""
    limits = ob.RealVectorBounds(len(bounds))
    for k, (low, high) in enumerate(bounds):
        limits.setLow(k, low)
        limits.setHigh(k, high)
    space.setBounds(limits)


def solve(placements, most=MOST_CHECKS):
    """(k, 3) states of x, y and time of a path, or None after `most` checks of states."""
    way, checks = placements.way, [0]
    space = ob.RealVectorStateSpace(3)
    _box(space, ((-0.2 * way, 1.2 * way), (-SIDE, SIDE), (0.0, DURATION)))
    controls = oc.RealVectorControlSpace(space, 2)
    _box(controls, ((-SPEED, SPEED), (-SPEED, SPEED)))
    setup = oc.SimpleSetup(controls)
    information = setup.getSpaceInformation()

    def onwards(state, control, span, result):
        for k in range(2):
            result[k] = state[k] + span * control[k]
        result[2] = state[2] + span

    def valid(state):
        checks[0] += 1
        return information.satisfiesBounds(state) and placements.is_free(state)

    setup.setStatePropagator(onwards)
    setup.setStateValidityChecker(valid)
    start = space.allocState()
    for k in range(3):
        start[k] = 0.0
    setup.setStartState(start)
    setup.setGoal(AtGoal(information, way))
    setup.setPlanner(oc.RRT(information))
    setup.setup()
    setup.solve(ob.PlannerTerminationCondition(lambda: checks[0] >= most))
    if not setup.haveExactSolutionPath():
        return None
    return np.array([[s[k] for k in range(3)] for s in setup.getSolutionPath().getStates()])


def sampled_runs(scenes, count=3):
    """Runs of OMPL on scenes (family, seed), `count` each."""
    ou.setLogLevel(ou.LogLevel.LOG_ERROR)
    ou.RNG.setSeed(1)
    for family, seed in scenes:
        placements = Placements(drawn(seed, FAMILIES.index(family)))
        for run in range(count):
            begin = time.process_time()
            states = solve(placements)
            spent = time.process_time() - begin
            if states is None:
                yield Sampled(family, seed, run, np.inf)
            else:
                yield Sampled(family, seed, run, spent, placements.least(states))
