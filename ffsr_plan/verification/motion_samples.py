"""Samples of a plan's motion: base poses, and link poses relative to the base.

Places are taken relative to the base, and base positions relative to the start, so that rounding
does not grow with the distance from the world's origin.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.verification.momentum_map import MomentumMap, momentum_map
from ffsr_plan.verification.moving_bodies.scene_bodies import (
    NO_BODIES,
    BodyPoses,
    SceneBodies,
)
from ffsr_plan.verification.moving_bodies.trapezoid_time import times_at
from ffsr_plan.verification.rate_bounds import RateBounds
from ffsr_plan.verification.urdf_reading import Bodies, pose

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData
    from ffsr_plan.problem.problem import Problem


class _OfProblem(Protocol):
    @property
    def problem(self) -> Problem: ...


_NEVER: Array = np.zeros(0)


class Samples(NamedTuple):
    """Configurations of a motion.

    Attributes:
        base_turns: (N, 3, 3) rotations of the base, world axes.
        base_places: (N, 3) base origins from the start's, world axes [m].
        turns: (N, s, 3, 3) rotations of the shapes, base axes.
        places: (N, s, 3) origins of the shapes from the base origin, base axes [m].
        momentum: what base and joints contribute to the momentum.
        centers_of_mass: (N, 3) of the robot from the start's base origin, world axes [m].
        deviation: (N,) distance of joints and base from straight lines between corners [m, rad].
        rates: (N, nd) of the joints [rad or m per edge].
        instants: (N,) times [s]; zeros for a plan without a duration.
        moving: poses of the bodies that move, at these times.
    """

    base_turns: Array
    base_places: Array
    turns: Array
    places: Array
    momentum: MomentumMap
    centers_of_mass: Array
    deviation: Array
    rates: Array
    instants: Array = _NEVER
    moving: BodyPoses = NO_BODIES

    def with_turns_of(self, other: Samples) -> Samples:
        """The same with turns of base and bodies, momenta and times of more samples behind."""
        momentum = self.momentum.followed_by(other.momentum)
        turns = np.concatenate([self.base_turns, other.base_turns])
        rates = np.concatenate([self.rates, other.rates])
        instants = np.concatenate([self.instants, other.instants])
        moving = self.moving.followed_by(other.moving)
        return self._replace(
            base_turns=turns, momentum=momentum, rates=rates, instants=instants, moving=moving
        )


class MayTouch(NamedTuple):
    """Links that may touch a moving body at the end or at the begin of a motion.

    Attributes:
        links: their names.
        body: number of the body, from 1 on.
        since: after this time they may, which is that of an even sample [s].
        until: before this time they may, alike [s].
    """

    links: tuple[str, ...]
    body: int
    since: float
    until: float


class Course(Protocol):
    """A motion in m edges, and bounds on its speeds; what `sweep` measures along.

    Attributes:
        problem: robot, obstacles, mode and start.
        edges: m, their number.
        clearance: the clearance to confirm [m].
        rates: bounds on speeds by joints.
        base_speeds: (m,) bound on the speed of a base that thrusters move [m per edge].
        held_turns: (m,) bound on the angular velocity by wheels [rad per edge]; None without.
        moving: the bodies that move.
        touching: links that may touch one of them; None for none.
    """

    problem: Problem
    edges: int
    clearance: float
    rates: RateBounds
    base_speeds: Array
    held_turns: Array | None
    moving: SceneBodies
    touching: MayTouch | None

    def at(self, edge: IntArray, time: Array) -> Samples:
        """Configurations at times (N,) from 0 to 1 on edges (N,)."""


class Sampler:
    """Samples a plan's motion; a `Course`.

    Attributes:
        positions: (m + 1, 3) base origins at the corners, from the start's [m].
        joint_values: (m + 1, nd) at the corners, unwrapped [rad or m].
    """

    def __init__(self, plan: PlanData, bodies: Bodies) -> None:
        """Prepare sampling.

        Args:
            plan: the plan.
            bodies: the robot, from its URDF.
        """
        self._plan, self._bodies = plan, bodies
        self.edges = plan.edges
        self._origin = plan.problem.start[:3]
        self._corners = plan.at(np.arange(self.edges + 1) / self.edges)
        self.positions: Array = self._corners[:, :3] - self._origin
        self.joint_values: Array = plan.motion.joint_values
        self._wraps = np.isinf(plan.problem.robot.upper)
        self.problem, mode = plan.problem, plan.problem.mode
        self.clearance = plan.certificate.least_clearance
        self._steps = np.diff(self.joint_values, axis=0)
        self.rates = RateBounds(bodies, plan.problem.robot.joint_names, self.joint_values)
        moved = np.linalg.norm(np.diff(self.positions, axis=0), axis=1)
        self.base_speeds = np.zeros(self.edges) if mode.floats else moved
        self.held_turns = None if mode.attitude_reacts else _held_turns(plan)
        self._duration = self.problem.duration or 0.0
        moving = self.problem.scene.bodies
        self.moving = SceneBodies(moving, self._origin, self._duration)
        self.touching: MayTouch | None = None

    def at(self, edge: IntArray, time: Array) -> Samples:
        """Configurations at times (N,) from 0 to 1 on edges (N,)."""
        shares = np.minimum((edge + time) / self.edges, 1.0)
        instants = times_at(shares, self._duration, self.problem.ramp)
        q = self._plan.at(shares)
        samples = samples_of(
            self._plan, self._bodies, q, self._deviation(edge, time, q), self._steps[edge], instants
        )
        return samples._replace(moving=self.moving.poses(instants))

    def _deviation(self, edge: IntArray, time: Array, q: Array) -> Array:
        """(N,) largest difference from straight lines between the corners."""
        t = time[:, None]
        joints = (1.0 - t) * self.joint_values[edge] + t * self.joint_values[edge + 1]
        apart = self._plan.problem.robot.joint_values(q) - joints
        apart = np.where(self._wraps, (apart + np.pi) % (2.0 * np.pi) - np.pi, apart)
        if not self._plan.problem.mode.floats:
            straight = (1.0 - t) * self.positions[edge] + t * self.positions[edge + 1]
            apart = np.hstack([apart, q[:, :3] - self._origin - straight])
        return np.max(np.abs(apart), axis=1, initial=0.0)


def samples_of(
    motion: _OfProblem,
    bodies: Bodies,
    q: Array,
    deviation: Array,
    rates: Array,
    instants: Array = _NEVER,
) -> Samples:
    """Samples of configurations, without bodies that move.

    Args:
        motion: a plan or a flight.
        bodies: the robot, from its URDF.
        q: (N, nq) configurations.
        deviation: (N,) see `Samples`.
        rates: (N, nd) see `Samples`.
        instants: (N,) see `Samples`.
    """
    poses = base_frame_poses(motion, bodies, q)
    placed = [poses[shape.link] @ shape.placement for shape in bodies.shapes]
    frames = np.stack(placed, axis=1) if placed else np.zeros((len(q), 0, 4, 4))
    momentum = momentum_map(bodies, motion.problem.robot.joint_names, poses)
    turns = base_turns(q)
    places = q[:, :3] - motion.problem.start[:3]
    return Samples(
        base_turns=turns,
        base_places=places,
        turns=np.ascontiguousarray(frames[..., :3, :3]),
        places=np.ascontiguousarray(frames[..., :3, 3]),
        momentum=momentum,
        centers_of_mass=places + np.einsum("nij,nj->ni", turns, momentum.centers),
        deviation=deviation,
        rates=rates,
        instants=instants,
    )


def base_turns(q: Array) -> Array:
    """(N, 3, 3) rotations of the base of configurations (N, nq)."""
    return pose(np.zeros((len(q), 3)), q[:, 3:7])[:, :3, :3]


def base_frame_poses(motion: _OfProblem, bodies: Bodies, q: Array) -> dict[str, Array]:
    """Poses of all links relative to the base.

    Args:
        motion: a plan or a flight, for the names of the joints.
        bodies: the robot, from its URDF.
        q: (N, nq) configurations.

    Returns:
        (N, 4, 4) for each link by name, link axes to base axes.
    """
    robot = motion.problem.robot
    values = robot.joint_values(q)
    joints = {name: values[:, k] for k, name in enumerate(robot.joint_names)}
    return bodies.link_poses(np.broadcast_to(np.eye(4), (len(q), 4, 4)), joints)


def _held_turns(plan: PlanData) -> Array:
    """(m,) angle [rad] that wheels turn the base by on each edge; the same on all of a lattice."""
    if plan.problem.lattice is not None:
        whole = _angles(plan.problem.start[3:7], plan.problem.goal[3:7])
        return np.full(plan.edges, whole / plan.edges)
    attitudes = plan.configurations[:, 3:7]
    return _angles(attitudes[:-1], attitudes[1:])


def _angles(a: Array, b: Array) -> Array:
    """Angles between attitudes (..., 4) [rad]."""
    ends = np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1)
    return np.asarray(4.0 * np.arctan2(np.minimum(*ends), np.maximum(*ends)))
