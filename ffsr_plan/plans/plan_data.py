"""`PlanData`: a plan's motion, figures of merit and certificate."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.bodies.pace import slip
from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.checks import finite_array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.rotations import angle_between, to_angles
from ffsr_plan.dynamics.dynamic_singularity import SlowestPlace, slowest_place
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.wheel_momentum import WheelMomentum, wheel_momentum
from ffsr_plan.lattice.certificate import Certificate
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.plans.planner_registry import Planner
from ffsr_plan.problem.free_objective import whole_objective
from ffsr_plan.problem.objective import motion_objective
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.prover import Prover
from ffsr_plan.refinement.edge_clearances import EdgeClearances
from ffsr_plan.search.fuel_figures import FuelFigures
from ffsr_plan.search.records import Branches, History, Trails


@dataclass(frozen=True, eq=False, repr=False)
class PlanData:
    """A certified whole-body motion, and how it was found.

    Attributes:
        problem: what was planned.
        planner: the planner's settings.
        seed: the seed, or None if a generator was handed over.
        lattice: the lattice that was searched, of base offsets; None without one.
        motion: the motion that was proven free; `at` evaluates it.
        nodes: offset indices along the path, 0 = no offset: (m + 1,), or (m + 1, axes) where the
            lattice has several axes (lateral, normal, postures in this order); (0,) without a
            lattice.
        length: L of Eq. 6 [m]; without a lattice, the length in base position, wheels' turn and
            joint values with the same weights.
        objective: F of Eq. 8 [length units], which contains the clearances at the nodes, or without
            a lattice at 39 stations at equal steps of L; `motion_objective` contains those between
            them too.
        lattice_objective: F of the path on the lattice, before refinement; F without a lattice.
        optimum: F of the exact lattice optimum, or a lower bound on it; without a lattice, F of the
            straight way past obstacles that are `clearance_cap` away.
        optimum_is_exact: whether `optimum` is exact. With posture axes it is a bound, as the cost
            of a node depends on the path that leads to it, and also where the time limit or Ctrl-C
            ended the search for it; no path of the lattice falls below a bound. Without a lattice
            no path at all does.
        clearances: (m + 1,) least link-to-sphere distance at each node [m].
        history: per cycle, best F, best and mean F of the cycle, number of different paths.
        trails: the edges that ants walked, with ants and pheromone; without a lattice, the
            branches of the trees.
        certificate: edges proven, Coal queries spent, proven clearance along the whole motion.
        interrupted: whether Ctrl-C or the time limit ended the search early.
        seconds: computing time [s], without that for compiling kernels at their first use.
        fuel: change of velocity that the motion needs, of plans by `LeastFuel`; None of others.
    """

    problem: Problem
    planner: Planner
    seed: int | None
    lattice: LayeredLattice | None
    motion: Motion
    nodes: IntArray
    length: float
    objective: float
    lattice_objective: float
    optimum: float
    optimum_is_exact: bool
    clearances: Array
    history: History
    trails: Trails | Branches
    certificate: Certificate
    interrupted: bool
    seconds: float
    fuel: FuelFigures | None = None

    @cached_property
    def configurations(self) -> Array:
        """(m + 1, nq) base poses in the world [m, quaternion xyzw] and joints at the nodes."""
        return frozen(self.motion.configurations())

    @property
    def attitudes(self) -> Array:
        """(m + 1, 4) attitudes of the base at the nodes, base axes to world axes (xyzw)."""
        return self.configurations[:, 3:7]

    @cached_property
    def motion_objective(self) -> float:
        """F of the whole motion [length units]: L + delta sum over all edges of 1 / d.

        Without a lattice the sum is over the 40 pieces between the stations. Here d is the least
        clearance sampled on the edge, whereas `objective` contains the clearances at the nodes
        only. Refinement lowers this value. An edge is sampled at 2, 4, 8 and at most 16 equal
        steps, until no point can travel farther over a step than d.
        """
        problem, still = self.problem, np.zeros((self.motion.edges + 1, 3))
        if problem.lattice is None:
            return whole_objective(problem, self.motion, self.length)
        if problem.delta == 0.0:
            return motion_objective(problem, self.length, np.full(self.motion.edges, np.inf))
        pace = problem.pace(self.motion.edges)
        prover = Prover(self.motion, problem.obstacles, problem.tolerance, pace=pace)
        verdicts = EdgeClearances(problem, prover).of_path(still, self.clearances)
        least = np.array([verdict.least_clearance for verdict in verdicts])
        return motion_objective(problem, self.length, least)

    @property
    def edges(self) -> int:
        """m, the number of edges; on a lattice, of its divisions."""
        lattice = self.problem.lattice
        return self.motion.edges if lattice is None else lattice.divisions

    @property
    def slip(self) -> float:
        """Time by which the whole flight may be early or late and is still free of bodies [s].

        The robot is then where it was proven free, and no body has come nearer than it can move in
        that time. Infinite where nothing moves.
        """
        return slip(self.problem.scene.moving, self.certificate.least_clearance)

    @property
    def gap(self) -> float:
        """(lattice_objective - optimum) / optimum; see `optimum_is_exact`."""
        above = self.lattice_objective - self.optimum
        if above <= 0.0:
            return 0.0
        return above / self.optimum if self.optimum > 0.0 else np.inf

    @property
    def arrival_attitude(self) -> Array:
        """(3,) ZYX angles alpha, beta, gamma [rad] of the base at the end of the motion."""
        return to_angles(self.configurations[-1, 3:7])

    @property
    def arrival_attitude_error(self) -> float | None:
        """Angle [rad] from the attitude reached to the goal's; None where none is demanded."""
        if not self.problem.reach_attitude:
            return None
        return float(angle_between(self.configurations[-1, 3:7], self.problem.goal[3:7]))

    def at(self, s: ArrayLike) -> Array:
        """Configuration at path parameter `s`, the reaction of the base included.

        Args:
            s: a number from 0 to 1, or an array (N,) of them; node i is at i / m.

        Returns:
            (nq,), or (N, nq) for an array: base pose in the world [m, quaternion xyzw] and joints.

        Raises:
            InvalidInput: s outside [0, 1] or not finite.
        """
        parameter = finite_array("s", s, np.shape(s))
        if np.any((parameter < 0.0) | (parameter > 1.0)):
            raise InvalidInput("s", s, "path parameters from 0 to 1")
        divisions = self.motion.edges
        scaled = np.atleast_1d(parameter).ravel() * divisions
        edge = np.minimum(scaled.astype(np.int64), divisions - 1)
        q = self.motion.at(edge, scaled - edge)
        return q.reshape(*parameter.shape, self.problem.robot.model.nq)

    def wheel_momentum(self, duration: float, times: ArrayLike | None = None) -> WheelMomentum:
        """Angular momentum that the wheels of an attitude-held plan must store along the motion.

        The plan is a path; the time law flies it from rest to rest by s = 10 u^3 - 15 u^4 + 6 u^5,
        u = t / duration. All momenta go as 1 / duration, for any time law s(t) as ds/dt.

        Args:
            duration: of the whole motion [s].
            times: (N,) from 0 to the duration [s]; without, 1001 evenly spaced.

        Raises:
            InvalidInput: a mode without wheels, or a duration or times that are not allowed.
        """
        return wheel_momentum(self.motion, duration, times)

    def least_singular_value(
        self, frame: str, *, attitude: bool = True, samples: int = 5
    ) -> SlowestPlace:
        """Least singular value of a frame's generalized Jacobian along a free-floating plan.

        It is measured at samples, not bounded between them; see `fp.least_singular_value`.

        Args:
            frame: name of a link, joint or other frame of the model.
            attitude: whether the frame is to be rotated too, at 1 m per rad, or only moved.
            samples: of each edge, evenly spaced.

        Returns:
            The value, and where it is.

        Raises:
            InvalidInput: another mode, or an argument that is not allowed.
        """
        return slowest_place(self.motion, frame, attitude, samples)
