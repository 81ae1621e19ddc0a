"""`FlownCourse`: a flight as a course along which distances are measured; its edges are pieces."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.verification.flights.flown import Flown
from ffsr_plan.verification.flights.met_target import may_touch
from ffsr_plan.verification.flights.used_limits import UsedLimits
from ffsr_plan.verification.motion_samples import Samples, samples_of
from ffsr_plan.verification.moving_bodies.scene_bodies import SceneBodies
from ffsr_plan.verification.rate_bounds import RateBounds
from ffsr_plan.verification.urdf_reading import Bodies


class FlownCourse:
    """A flight in the pieces of its time law; a `Course`. The path is sampled, without pulses."""

    def __init__(self, flight: Flown, bodies: Bodies, used: UsedLimits, clearance: float) -> None:
        """Prepare sampling.

        Args:
            flight: the flight.
            bodies: the robot, from its URDF.
            used: bounds on its speeds.
            clearance: the clearance to confirm [m].
        """
        self._flight, self._bodies = flight, bodies
        self.problem, self.clearance = flight.problem, clearance
        self._ends = flight.switch_times
        self._lengths = lengths = np.diff(self._ends)
        self.edges = len(lengths)
        length, mode = lengths[:, None], self.problem.mode
        values = flight.at(np.minimum(self._ends, flight.duration)).joints
        names = self.problem.robot.joint_names
        self.rates = RateBounds(
            bodies, names, values, used.sizes * length, used.bends * length * length
        )
        still = np.zeros(self.edges)
        self.base_speeds: Array = still if mode.floats else used.base_speeds * lengths
        self.held_turns = None if mode.attitude_reacts else used.turn_speeds * lengths
        moving = self.problem.scene.bodies
        self.moving = SceneBodies(moving, self.problem.start[:3], flight.duration)
        self.touching = may_touch(flight)

    def at(self, edge: IntArray, time: Array) -> Samples:
        """Configurations at times (N,) from 0 to 1 on pieces (N,)."""
        times = self._ends[edge] + time * self._lengths[edge]
        states = self._flight.at(np.minimum(times, self._flight.duration))
        rates = states.joint_velocities * self._lengths[edge][:, None]
        still = np.zeros(len(edge))
        q = states.configurations
        samples = samples_of(self._flight, self._bodies, q, still, rates, times)
        return samples._replace(moving=self.moving.poses(times))
