"""`SmoothPlanData`: a smooth curve along a plan, its proof and figures of merit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.bodies.pace import slip
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import finite_array, number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import html_table, proven
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.curves.smooth_curve import SmoothCurve
from ffsr_plan.fuel.curve_refinement import curve_change
from ffsr_plan.lattice.certificate import Certificate
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.problem.problem import Problem
from ffsr_plan.smoothing.proven_curve import Kind


@dataclass(frozen=True, eq=False, repr=False)
class SmoothPlanData:
    """A whole-body motion without corners, proven free of collisions, the base's reaction included.

    Velocity and acceleration are continuous in the curve's parameter. Start and goal are those of
    the plan; a goal attitude that is demanded is reached again.

    Attributes:
        plan: the plan that was smoothed.
        curve: the curve. Its parameter runs from 0 to the number of its pieces.
        kind: what the curve is: a `spline` whose control points are the plan's nodes, a `refined
            spline` with more of them, the spline `through` the nodes, the plan's path `with rests`
            at its bends, one of `least fuel` beside it, or a spline that ends with a `meeting` or
            begins with a `departure`.
        nodes: (m + 1,) parameters of the curve that belong to the plan's nodes.
        length: L by its definition for paths [m]; shorter than the plan's but for `through`.
        objective: F by its definition for paths [length units]. It may be a little larger than the
            plan's, as a spline cuts corners, and these are at obstacles.
        clearances: (n + 1,) least distances to obstacles at the ends of the curve's n pieces [m].
        certificate: pieces proven and refused, Coal queries spent, and the proven clearance all
            along the curve.
    """

    plan: PlanData
    curve: SmoothCurve
    kind: Kind
    nodes: Array
    length: float
    objective: float
    clearances: Array
    certificate: Certificate

    @property
    def problem(self) -> Problem:
        """Robot, obstacles, start and goal."""
        return self.plan.problem

    @property
    def slip(self) -> float:
        """Time by which the whole motion may be early or late and is still free of bodies [s].

        At the pace of the plan, or of the flight that this belongs to; see `Plan.slip`.
        """
        return slip(self.problem.scene.moving, self.certificate.least_clearance)

    @cached_property
    def change(self) -> float:
        """Change of the centre of mass's velocity for a flight of unit duration [m].

        At constant pace along the curve, from rest to rest: divided by a duration it is the delta-v
        [m/s]. 0 where nothing moves the base.
        """
        return 0.0 if self.plan.problem.mode.floats else curve_change(self.curve.motion)

    def delta_v(self, duration: float) -> float:
        """Delta-v of a flight at constant pace [m/s].

        Args:
            duration: of the flight [s].

        Raises:
            InvalidInput: a duration that is not positive.
        """
        return self.change / number("duration", duration, above=0.0)

    def at(self, s: ArrayLike) -> Array:
        """Configuration at path parameter `s`, the reaction of the base included.

        Args:
            s: a number from 0 to 1, or an array (N,) of them; piece i of n begins at i / n.

        Returns:
            (nq,), or (N, nq) for an array: base pose in the world [m, quaternion xyzw] and joints.

        Raises:
            InvalidInput: s outside [0, 1] or not finite.
        """
        parameter = finite_array("s", s, np.shape(s))
        if np.any((parameter < 0.0) | (parameter > 1.0)):
            raise InvalidInput("s", s, "path parameters from 0 to 1")
        scaled = np.atleast_1d(parameter).ravel() * self.curve.pieces
        edge = np.minimum(scaled.astype(np.int64), self.curve.pieces - 1)
        q = self.curve.motion.at(edge, scaled - edge)
        return q.reshape(*parameter.shape, self.plan.problem.robot.model.nq)

    @property
    def arrival_attitude_error(self) -> float | None:
        """Angle [rad] from the attitude reached to the goal's; None where none is demanded."""
        if not self.plan.problem.reach_attitude:
            return None
        reached = self.curve.motion.attitudes[-1]
        return float(angle_between(reached, self.plan.problem.goal[3:7]))

    def __repr__(self) -> str:
        problem = self.plan.problem
        clearance = f"proven clearance {proven(self.certificate.least_clearance)}"
        parts = [
            problem.robot.name,
            str(problem.mode),
            self.kind,
            f"L {self.length:.4g} m",
            f"F {self.objective:.6g}",
            clearance if len(problem.scene) else "no obstacles",
        ]
        return f"{type(self).__name__}({', '.join(parts)})"

    def _repr_html_(self) -> str:
        rows = {
            "curve": f"{self.kind}, {self.curve.pieces} pieces",
            "length L": f"{self.length:.4f} m",
            "objective F": f"{self.objective:.4f}",
            "proven along the motion": f"at least {proven(self.certificate.least_clearance)}",
        }
        return html_table("SmoothPlan", rows)
