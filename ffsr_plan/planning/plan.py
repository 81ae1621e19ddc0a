"""`Plan`: what a planner returns: path, figures of merit, how it was found, what was proven."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ffsr_plan.collision.shape_placements import near_track, shape_placements
from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.checks import finite_array, whole_number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.rotations import angle_between, to_angles
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.wheel_momentum import WheelMomentum, wheel_momentum
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.lattice.roadmap import Certificate
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import History, Planner, Trails
from ffsr_plan.trajectory.csv_tables import path_table, write_csv
from ffsr_plan.trajectory.limits import PerJoint, read_limits
from ffsr_plan.trajectory.timed_plan import TimedPlan, timed

if TYPE_CHECKING:  # these import this module; a plan calls them when asked to
    from ffsr_plan.display.page_server import PageServer
    from ffsr_plan.verification.verify import Report


@dataclass(frozen=True, eq=False)
class Plan:
    """A certified whole-body motion. Two plans are equal if all but the computing time is.

    Attributes:
        problem: what was planned.
        planner: the planner's settings.
        seed: the seed, or None if a generator was handed over.
        nodes: offset indices along the path, 0 = no offset: (m + 1,), or (m + 1, axes) where the
            lattice has several axes (lateral, normal, postures in this order).
        configurations: (m + 1, nq) base pose in the world [m, quaternion xyzw] and joints [rad, m].
        length: L of Eq. 6 [m].
        objective: F of Eq. 8 [length units].
        lattice_objective: F of the path on the lattice, before refinement.
        optimum: F of the exact lattice optimum; with posture axes a lower bound on it.
        clearances: (m + 1,) least link-to-sphere distance at each node [m].
        history: per cycle, best F, best and mean F of the cycle, number of different paths.
        trails: the edges that ants walked, with ants and pheromone.
        certificate: edges proven, Coal queries spent, proven clearance along the whole motion.
        interrupted: whether Ctrl-C or the time limit ended the search early.
        seconds: computing time.
    """

    problem: Problem
    planner: Planner
    seed: int | None
    nodes: IntArray
    configurations: Array
    length: float
    objective: float
    lattice_objective: float
    optimum: float
    clearances: Array
    history: History
    trails: Trails
    certificate: Certificate
    interrupted: bool
    seconds: float

    @property
    def gap(self) -> float:
        """(lattice_objective - optimum) / optimum: how far the search stayed above the optimum."""
        above = self.lattice_objective - self.optimum
        if above <= 0.0:
            return 0.0
        return above / self.optimum if self.optimum > 0.0 else np.inf

    @cached_property
    def motion(self) -> Motion:
        """The continuous motion through `configurations`."""
        problem, along = self.problem, self.configurations[:, :3]
        joints = None
        if problem.lattice.postures:
            values = problem.robot.joint_values(self.configurations)
            endless = np.isinf(problem.robot.upper)
            joints = np.where(endless, np.unwrap(values, axis=0), values)
        return Motion(problem.robot, problem.mode, problem.start, problem.goal, along, joints)

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

    @property
    def optimum_is_exact(self) -> bool:
        """Whether `optimum` is the exact lattice optimum, and not only a lower bound on it.

        With posture axes the cost depends on the way, and `gap` says how far the plan is from a
        bound that no path of the lattice falls below.
        """
        return not self.problem.lattice.postures

    def at(self, s: ArrayLike) -> Array:
        """Configuration at path parameter `s` in [0, 1], the reaction of the base included.

        Args:
            s: a number, or an array (N,); node i is at i / m.

        Returns:
            (nq,) or (N, nq).

        Raises:
            InvalidInput: s outside [0, 1] or not finite.
        """
        parameter = finite_array("s", s, np.shape(s))
        if np.any((parameter < 0.0) | (parameter > 1.0)):
            raise InvalidInput("s", s, "path parameters from 0 to 1")
        divisions = self.problem.lattice.divisions
        scaled = np.atleast_1d(parameter).ravel() * divisions
        edge = np.minimum(scaled.astype(np.int64), divisions - 1)
        q = self.motion.at(edge, scaled - edge)
        return q.reshape(*parameter.shape, self.problem.robot.model.nq)

    def wheel_momentum(self, duration: float, times: ArrayLike | None = None) -> WheelMomentum:
        """Angular momentum that the wheels of an attitude-held plan must store along the motion.

        The plan is a path; here it is flown from rest to rest by s = 10 u^3 - 15 u^4 + 6 u^5,
        u = t / duration. All momenta go as 1 / duration, for any time law s(t) as ds/dt.

        Args:
            duration: of the whole motion [s].
            times: (N,) from 0 to the duration [s]; without, 1001 evenly spaced.

        Raises:
            InvalidInput: another mode (there are no wheels), or a duration or times that cannot be.
        """
        return wheel_momentum(self.motion, duration, times)

    def timed(
        self,
        *,
        joint_acceleration: PerJoint = None,
        thruster_acceleration: float | None = None,
        joint_velocity: PerJoint = None,
        base_velocity: float | None = None,
        joint_torque: PerJoint = None,
        joint_jerk: PerJoint = None,
        thruster_jerk: float | None = None,
        turn_velocity: float | None = None,
        turn_acceleration: float | None = None,
        velocity_jump: float = 0.0,
    ) -> TimedPlan:
        """The plan flown as fast as limits allow, from rest to rest, on exactly the proven path.

        It rests wherever the path has a corner: there a velocity would have to change at once.
        What is not named is not limited, but for `joint_velocity`, which is the URDF's. Limits for
        joints are one number for all of them, or numbers by joint name.

        Args:
            joint_acceleration: [rad/s^2 or m/s^2], of every joint that moves.
            thruster_acceleration: of the base origin, and thrust / mass [m/s^2]; without meaning
                where the robot floats freely.
            joint_velocity: [rad/s or m/s]; the URDF's for joints not named.
            base_velocity: of the base origin [m/s].
            joint_torque: [N m or N].
            joint_jerk: [rad/s^3 or m/s^3].
            thruster_jerk: of the base origin [m/s^3].
            turn_velocity: of a base that wheels turn [rad/s].
            turn_acceleration: of a base that wheels turn [rad/s^2].
            velocity_jump: by how much thrusters may change the velocity of the base in one pulse
                [m/s]; instead of resting at a corner of its path, the robot then passes it at the
                speed at which the pulse is as large. A pulse takes time, so that the corner is cut
                a little (`TimedPlan.corner_cut`); by less than the proven clearance, or the jump
                is refused.

        Raises:
            InvalidInput: a limit that cannot be, an acceleration that is needed and not given,
                pulses that the proven clearance has no room for, or a plan along which nothing
                moves.
        """
        limits = read_limits(
            self.problem.robot,
            joint_velocity=joint_velocity,
            joint_acceleration=joint_acceleration,
            joint_jerk=joint_jerk,
            joint_torque=joint_torque,
            base_velocity=base_velocity,
            thruster_acceleration=thruster_acceleration,
            thruster_jerk=thruster_jerk,
            turn_velocity=turn_velocity,
            turn_acceleration=turn_acceleration,
            velocity_jump=velocity_jump,
        )
        return timed(self.motion, limits, self.certificate.least_clearance)

    def trail_segments(self, most: int = 3000) -> tuple[Array, Array]:
        """Where the ants walked, faint trails first.

        Args:
            most: how many edges; the strongest.

        Returns:
            Ends (k, 2, 3) of the edges, base origin in the world [m], and strengths (k,) in [0, 1]:
            half for all the pheromone ever laid on the edge, half for the ants that walked it, on
            logarithmic scales, so that early trails show too.
        """
        lattice, trails = LayeredLattice(self.problem), self.trails
        if not len(trails.layer):
            return np.zeros((0, 2, 3)), np.zeros(0)
        strength = 0.5 * (_logarithmic(trails.laid) + _logarithmic(trails.ants))
        order = np.argsort(strength, kind="stable")[-most:]
        layer, tail, head = trails.layer[order], trails.tail[order], trails.head[order]
        begin = lattice.nominal.positions[layer] + lattice.offsets[tail]
        end = lattice.nominal.positions[layer + 1] + lattice.offsets[head]
        return np.stack([begin, end], axis=1), strength[order]

    def obstacles_near(self, within: float) -> Flags:
        """(N,) which spheres come so near [m] to the middle of any of the robot's shapes.

        For pictures of scenes with many obstacles: looked at eight times an edge, not proven.
        """
        scene, robot = self.problem.scene, self.problem.robot
        q = self.at(np.linspace(0.0, 1.0, 8 * self.problem.lattice.divisions + 1))
        return near_track(scene, shape_placements(robot, q).positions, within)

    def verify(self, samples: int = 2000) -> Report:
        """Check the plan again, densely and by other code than the planner's; see `verify`.

        Args:
            samples: distance checks per edge.
        """
        from ffsr_plan.verification.verify import verify

        return verify(self, samples)

    def save(self, path: str | Path) -> None:
        """Write everything to a JSON file; `Plan.load` gives the same plan back, bit for bit."""
        from ffsr_plan.planning.plan_file import write

        write(self, Path(path))

    @staticmethod
    def load(path: str | Path) -> Plan:
        """Read a plan that `save` wrote. The file holds the robot's URDF too.

        Raises:
            InvalidInput: no such file, cut short, or changed since it was written.
        """
        from ffsr_plan.planning.plan_file import read

        return read(Path(path))

    def to_dict(self) -> dict[str, Any]:
        """Everything, as in the file that `save` writes, in plain Python values fit for JSON."""
        from ffsr_plan.planning.plan_file import to_dict

        return to_dict(self)

    @staticmethod
    def from_dict(data: dict[str, Any]) -> Plan:
        """The inverse of `to_dict`.

        Raises:
            InvalidInput: not what `to_dict` gives.
        """
        from ffsr_plan.planning.plan_file import checked

        return checked("plan", data)

    def to_csv(self, path: str | Path, samples: int | None = None) -> None:
        """Write the path as a table, one configuration a row, reaction included, units on top.

        Columns: path parameter, base origin in the world, its quaternion and ZYX angles, joints. A
        file that is there is replaced. `timed(...).to_csv` writes a trajectory.

        Args:
            path: of the file.
            samples: rows, evenly spaced in s; without, one for each node.

        Raises:
            InvalidInput: a file that cannot be written, or fewer than two samples.
        """
        rows = self.problem.lattice.divisions + 1
        if samples is not None:
            rows = whole_number("samples", samples, at_least=2, at_most=1_000_000)
        write_csv(Path(path), path_table(self.motion, np.linspace(0.0, 1.0, rows)))

    def write_html(self, path: str | Path, title: str = "") -> None:
        """Write one self-contained page that shows the motion; it needs no network."""
        from ffsr_plan.display.page import page

        text = page(self, title)
        try:
            Path(path).write_text(text, encoding="utf-8")
        except OSError as error:
            raise InvalidInput("page", str(path), f"a file that can be written ({error})") from None

    def show(
        self,
        port: int = 0,
        *,
        block: bool | None = None,
        open_browser: bool | None = None,
        title: str = "",
    ) -> PageServer:
        """Show the page of `write_html`, served on 127.0.0.1 by this process; in notebooks too.

        Args:
            port: 0 for any that is free.
            block: whether to go on only after Ctrl-C; by default in scripts, whose end ends the
                server, and not in notebooks and at prompts.
            open_browser: whether to open the user's browser; by default unless in a notebook, where
                the page appears as a frame below the cell.
            title: as for `write_html`.

        Returns:
            The server, with its `url`; `stop()`, or the end of a `with` block, ends it.

        Raises:
            InvalidInput: a port that cannot be had, such as one in use.
        """
        from ffsr_plan.display.browser import serve
        from ffsr_plan.display.page import page

        return serve(page(self, title), port, block, open_browser)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Plan):
            return NotImplemented
        from ffsr_plan.planning.plan_file import to_dict

        first: dict[str, Any] = to_dict(self) | {"seconds": 0.0}
        return first == to_dict(other) | {"seconds": 0.0}

    __hash__ = None  # type: ignore[assignment]  # equality is by content


def _logarithmic(amount: NDArray[Any]) -> Array:
    """Amounts >= 0 on a logarithmic scale from 0 to 1."""
    amount = amount.astype(np.float64)
    scaled = np.log1p(amount / np.min(amount, where=amount > 0.0, initial=np.inf))
    return np.asarray(scaled / max(float(scaled.max()), 1e-12))
