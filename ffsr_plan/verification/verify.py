"""The independent re-check of a plan: dense samples, closed-form distances, momentum body by body.

Nothing here calls the planner's clearance, momentum, length or objective code. The motion itself,
`plan.at`, is taken as a black box and sampled; velocities come from differences of link poses. What
the plan says of its wheels, `plan.wheel_momentum`, is compared with that.

Where a solid stands for a cylinder or mesh (`SpaceRobot.replacements`), all distances are to that
solid, as in the plan, and it is checked that it holds the original: the cylinder of the URDF, the
corners of the mesh's hull that the plan carries. The true robot is then at least as clear.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import Polynomial

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import whole_number
from ffsr_plan.verification.separation import separation
from ffsr_plan.verification.solids import Shape, least_sphere_distance, sphere_distance
from ffsr_plan.verification.urdf_reading import Bodies, pose

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData

MOMENTUM_LIMIT = 1e-9
AGREEMENT = 1e-9
HULL_AGREEMENT = 1e-8  # [m], as exact as Coal's iterations make a distance to a hull
# Central difference of eighth order: steps 1 .. 4 to either side
_STENCIL = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])
_CLOSE = 0.02  # bounding spheres [m] that lie farther apart say enough
_SPACING = 0.05  # of an edge, and less where edges are few and therefore long
_MANY_EDGES = 8
_STATIONS = (0.22, 0.5, 0.78)


@dataclass(frozen=True)
class Report:
    """What `plan.verify()` found."""

    ok: bool
    problems: tuple[str, ...]
    """One sentence for each thing that is not as it should be."""
    least_clearance: float
    """Least link-to-sphere distance over all samples [m]."""
    least_self_separation: float
    """Least lower bound on the distance of non-adjacent links over all samples [m]."""
    momentum_residual: float | None
    """Largest |angular momentum about the centre of mass| relative to the sum of the bodies' own
    shares, over all stations; None where wheels hold the attitude and may store momentum."""
    center_drift: float | None
    """Farthest that the centre of mass is from where it was at the start [m], over all samples;
    None where thrusters move it."""
    wheel_momentum_error: float | None
    """Largest difference between the plan's wheel momentum and the one found here, relative in the
    same way; None in modes without wheels."""
    clearance_error: float
    """Largest difference between the plan's node clearances and the ones found here [m]."""
    objective_error: float
    """Difference between the plan's F and F from scratch, relative."""
    samples: int
    """Configurations whose distances were checked."""
    largest_step: float
    """Longest way of any shape's centre between two samples [m]."""


def verify(plan: PlanData, samples: int = 2000) -> Report:
    """Check a plan again, from its configurations and its motion alone.

    Args:
        plan: the plan.
        samples: distance checks per edge.
    """
    samples = whole_number("samples", samples, at_least=1)
    problems: list[str] = []
    if not np.all(np.isfinite(plan.configurations)):
        problems.append("some configurations are not numbers")
    robot = plan.problem.robot
    bodies = Bodies(robot.urdf, robot.srdf, robot.replacements)
    for link in bodies.uncovered(robot.meshes):
        problems.append(f"a shape of link '{link}' sticks out of the solid that stands for it")
    pairs = bodies.pairs()
    divisions = plan.problem.lattice.divisions
    clearances, separations, centers, largest, checked = [], [], [], 0.0, 0
    for edge in range(divisions):
        q = plan.at(np.minimum((edge + np.linspace(0.0, 1.0, samples + 1)) / divisions, 1.0))
        poses = _poses(plan, bodies, q)
        placed = [poses[s.link] @ s.placement for s in bodies.shapes]
        clearances.append(_least_clearance(plan, bodies.shapes, placed))
        separations.append(_least_separation(pairs, dict(zip(bodies.shapes, placed, strict=True))))
        centers.append(_center_of_mass(bodies, poses))
        ways = [np.linalg.norm(np.diff(p[:, :3, 3], axis=0), axis=1).max() for p in placed]
        largest = max([largest, *map(float, ways)])
        checked += len(q)
    least, apart = min(clearances), min(separations)
    if least <= 0.0:
        problems.append(
            f"a link is {-least:.3g} m inside an obstacle on edge {np.argmin(clearances)}"
        )
    if apart <= 0.0:
        problems.append(f"two links touch on edge {int(np.argmin(separations))}")
    if plan.certificate.least_clearance > least + AGREEMENT:
        proven = plan.certificate.least_clearance
        problems.append(f"{proven:.6g} m are said to be proven, but {least:.6g} m were met")
    held, floats = (plan.problem.mode == m for m in ("attitude-held", "free-floating"))
    residual = None if held else _momentum_residual(plan, bodies)
    if residual is not None and residual > MOMENTUM_LIMIT:
        problems.append(f"angular momentum is not conserved: residual {residual:.3g}")
    wheel_error = _wheel_momentum_error(plan, bodies) if held else None
    if wheel_error is not None and wheel_error > MOMENTUM_LIMIT:
        problems.append(f"the wheels must store another momentum: error {wheel_error:.3g}")
    drift = None
    if floats:
        drift = max(float(np.linalg.norm(c - centers[0][0], axis=1).max()) for c in centers)
        if drift > AGREEMENT:
            problems.append(f"the centre of mass moves by {drift:.3g} m without thrusters")
    problems += _ends_and_limits(plan)
    clearance_error, objective_error = _recomputed(plan, bodies, problems)
    figures = (least, apart, residual, drift, wheel_error, clearance_error, objective_error)
    if any(figure is not None and np.isnan(figure) for figure in figures):
        problems.append("some of the figures are not numbers")
    return Report(
        not problems, tuple(problems), least, apart, residual, drift, wheel_error, clearance_error,
        objective_error, checked, largest,
    )  # fmt: skip


def _poses(plan: PlanData, bodies: Bodies, q: Array) -> dict[str, Array]:
    robot = plan.problem.robot
    values = robot.joint_values(q)
    joints = {name: values[:, k] for k, name in enumerate(robot.joint_names)}
    return bodies.link_poses(pose(q[:, :3], q[:, 3:7]), joints)


def _center_of_mass(bodies: Bodies, poses: dict[str, Array]) -> Array:
    """(N, 3) of the whole robot in the world [m]."""
    mass, moment = 0.0, np.zeros(3)
    for link, inertial in bodies.inertials.items():
        frame = poses[link] @ (np.eye(4) if inertial.origin is None else inertial.origin)
        mass, moment = mass + inertial.mass, moment + inertial.mass * frame[:, :3, 3]
    return np.asarray(moment / mass)


def _least_clearance(plan: PlanData, shapes: list[Shape], placed: list[Array]) -> float:
    """Over all samples; spheres that a shape cannot come nearest to are left out."""
    centers, radii = plan.problem.scene.centers, plan.problem.scene.radii
    least = np.inf
    if len(radii) == 0:
        return least
    for shape, at in zip(shapes, placed, strict=True):
        track = at[:, :3, 3]
        middle = track.mean(axis=0)
        spread = float(np.linalg.norm(track - middle, axis=1).max())
        about = np.linalg.norm(centers - middle, axis=1) - radii
        near = about - spread - shape.radius <= min(least, float(about.min()) + spread)
        if near.any():
            least = min(least, least_sphere_distance(shape, at, centers[near], radii[near]))
    return least


def _least_separation(pairs: list[tuple[Shape, Shape]], placed: dict[Shape, Array]) -> float:
    """Over all samples of all pairs; what lies apart by its bounding spheres counts with that."""
    least = np.inf
    for a, b in pairs:
        pose_a, pose_b = placed[a], placed[b]
        apart = np.linalg.norm(pose_a[:, :3, 3] - pose_b[:, :3, 3], axis=1) - a.radius - b.radius
        close = apart <= _CLOSE
        least = min(least, float(np.min(apart[~close], initial=np.inf)))
        if close.any():
            least = min(least, float(separation(a, pose_a[close], b, pose_b[close]).min()))
    return least


def _momentum_residual(plan: PlanData, bodies: Bodies) -> float:
    """|angular momentum|, relative to the sum of the terms' sizes."""
    total, scale = _momentum(plan, bodies, _stations(plan))
    return _relative(total, scale)


def _wheel_momentum_error(plan: PlanData, bodies: Bodies) -> float:
    """The same for what is left once the wheels' share is added, for one time law."""
    divisions, duration = plan.problem.lattice.divisions, 10.0
    law = Polynomial([0, 0, 0, 10, -15, 6])
    grid = np.linspace(0.0, 1.0, 100 * divisions + 1)
    elapsed = np.interp(_stations(plan) / divisions, law(grid), grid)
    s, rate = law(elapsed), law.deriv()(elapsed) * divisions / duration
    total, scale = _momentum(plan, bodies, s * divisions)
    wheels = plan.wheel_momentum(duration, elapsed * duration)
    base = _poses(plan, bodies, plan.at(s))[bodies.root][:, :3, :3]
    turned = np.einsum("nij,nj->ni", base, wheels.vectors)
    left = [stored + rate[:, None] * total for stored in (turned, wheels.world)]
    return _relative(np.concatenate(left), rate * scale)


def _stations(plan: PlanData) -> Array:
    """Where the momentum is looked at, in edges; differences stay within each edge."""
    stations: Array = np.arange(plan.problem.lattice.divisions)[:, None] + np.array(_STATIONS)
    return stations.ravel()


def _relative(vectors: Array, scale: Array) -> float:
    """Largest norm of vectors (n, 3), relative to the largest scale (k,)."""
    largest = float(scale.max())
    return float(np.linalg.norm(vectors, axis=1).max()) / largest if largest > 0.0 else 0.0


def _momentum(plan: PlanData, bodies: Bodies, stations: Array) -> tuple[Array, Array]:
    """Sum of m (r - c) x (v - v_c) + I w over bodies (n, 3), and of the terms' sizes (n,).

    World axes, at `stations` (n,) counted in edges [kg m^2 rad per edge].
    """
    divisions = plan.problem.lattice.divisions
    spacing = _SPACING * min(1.0, divisions / _MANY_EDGES)
    reach = np.arange(-4, 5) * spacing
    times = stations[:, None] + reach
    poses = _poses(plan, bodies, plan.at(times.ravel() / divisions))
    masses, points, velocities, spins, scale = [], [], [], [], np.zeros(len(stations))
    for link, inertial in bodies.inertials.items():
        frame = poses[link] @ (np.eye(4) if inertial.origin is None else inertial.origin)
        frame = frame.reshape(len(stations), len(reach), 4, 4)
        here = frame[:, 4]
        velocity, angular = _rates(frame, spacing)
        inertia = here[:, :3, :3] @ inertial.inertia @ np.swapaxes(here[:, :3, :3], 1, 2)
        spin = np.einsum("nij,nj->ni", inertia, angular)
        masses.append(inertial.mass)
        points.append(here[:, :3, 3])
        velocities.append(velocity)
        spins.append(spin)
        scale += np.linalg.norm(spin, axis=1)
    mass = np.array(masses)[:, None, None]
    center = np.sum(mass * points, axis=0) / mass.sum()
    drift = np.sum(mass * velocities, axis=0) / mass.sum()
    arms, relative = points - center, velocities - drift
    orbital = mass * np.cross(arms, relative)
    scale += np.sum(
        mass[:, :, 0] * np.linalg.norm(arms, axis=2) * np.linalg.norm(relative, axis=2), axis=0
    )
    total = np.sum(orbital, axis=0) + np.sum(spins, axis=0)
    # where nothing moves relative to the base there is only the rounding of the translation left
    rigid = np.sum(mass[:, :, 0] * np.linalg.norm(arms, axis=2), axis=0)
    floor = 1e-4 * rigid * np.linalg.norm(drift, axis=1)
    return total, np.maximum(scale, floor)


def _rates(frame: Array, spacing: float) -> tuple[Array, Array]:
    """Velocity and angular velocity (n, 3) in the middle of nine poses (n, 9, 4, 4)."""
    velocity = np.zeros((len(frame), 3))
    angular = np.zeros((len(frame), 3))
    turn_back = np.swapaxes(frame[:, 4, :3, :3], 1, 2)
    for k, weight in enumerate(_STENCIL, start=1):
        for sign in (1, -1):
            other = frame[:, 4 + sign * k]
            velocity += sign * weight * other[:, :3, 3]
            angular += sign * weight * _rotation_vector(other[:, :3, :3] @ turn_back)
    return velocity / spacing, angular / spacing


def _rotation_vector(r: Array) -> Array:
    """Of rotations (n, 3, 3) by less than half a turn."""
    odd = np.stack([r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]], 1)
    sine = 0.5 * np.linalg.norm(odd, axis=1)
    cosine = 0.5 * (np.trace(r, axis1=1, axis2=2) - 1.0)
    angle = np.arctan2(sine, cosine)
    factor = np.where(sine > 1e-12, angle / np.where(sine > 1e-12, sine, 1.0), 1.0)
    return np.asarray(0.5 * factor[:, None] * odd)


def _ends_and_limits(plan: PlanData) -> list[str]:
    problem, robot = plan.problem, plan.problem.robot
    first, last = plan.configurations[0], plan.configurations[-1]
    values = robot.joint_values(plan.configurations)
    problems = []
    if np.abs(first - problem.start).max() > AGREEMENT:
        problems.append("the motion does not begin at the start")
    reached = last[7:] - problem.goal[7:]
    if problem.mode.has_thrusters:
        reached = np.append(reached, last[:3] - problem.goal[:3])
    if np.max(np.abs(reached), initial=0.0) > AGREEMENT:
        problems.append("the motion does not end at the goal")
    if problem.mode.has_wheels:
        overlap = abs(float(last[3:7] @ problem.goal[3:7]))
        if overlap < 1.0 - AGREEMENT:
            problems.append("the motion does not end at the goal's attitude")
    if problem.reach_attitude:
        overlap = min(1.0, abs(float(last[3:7] @ problem.goal[3:7])))
        if (missed := np.degrees(2.0 * np.arccos(overlap))) > 1.0:
            problems.append(f"the goal's attitude is missed by {missed:.3g} degrees")
    corners = plan.at(np.arange(len(plan.configurations)) / problem.lattice.divisions)
    if np.abs(corners - plan.configurations).max() > AGREEMENT:
        problems.append("the motion does not pass through the plan's configurations")
    if np.any((values < robot.lower - AGREEMENT) | (values > robot.upper + AGREEMENT)):
        problems.append("a joint leaves its limits")
    return problems


def _recomputed(plan: PlanData, bodies: Bodies, problems: list[str]) -> tuple[float, float]:
    """Node clearances, L and F from the configurations alone, Eqs. 4, 6, 8 and 9 written out."""
    problem = plan.problem
    q, m, unit = plan.configurations, problem.lattice.divisions, problem.length_unit
    poses = _poses(plan, bodies, q)
    nodes = np.full(m + 1, np.inf)
    if len(problem.scene.radii):
        for shape in bodies.shapes:
            at = poses[shape.link] @ shape.placement
            each = sphere_distance(shape, at, problem.scene.centers, problem.scene.radii)
            nodes = np.minimum(nodes, each.min(axis=1))
    with np.errstate(invalid="ignore"):
        difference = np.where(nodes == plan.clearances, 0.0, np.abs(nodes - plan.clearances))
    clearance_error = float(difference.max())
    joints = problem.robot.joint_values(q)
    turns = np.diff(joints, axis=0)
    turns = np.where(np.isinf(problem.robot.upper), (turns + np.pi) % (2 * np.pi) - np.pi, turns)
    straight = turns.mean(axis=0)  # postures displace nothing at start and goal
    weights = np.where(problem.robot.prismatic, problem.position_weight, problem.rotation_weight)
    floats = problem.mode.floats  # what the base does there counts for nothing
    along = np.zeros(3) if floats else (problem.goal[:3] - problem.start[:3]) / m
    nominal = np.sum((along * problem.position_weight) ** 2) + np.sum((straight * weights) ** 2)
    if problem.mode.has_wheels:
        overlap = min(1.0, abs(float(problem.start[3:7] @ problem.goal[3:7])))
        nominal += (2.0 * np.arccos(overlap) / m * problem.rotation_weight) ** 2
    across = (np.diff(q[:, :3], axis=0) - along) * (0.0 if floats else problem.position_weight)
    bends = (turns - straight) * weights
    length = float(np.sum(np.sqrt(nominal + np.sum(across**2, axis=1) + np.sum(bends**2, axis=1))))
    capped = nodes if problem.clearance_cap is None else np.minimum(nodes, problem.clearance_cap)
    objective = length / unit + problem.delta * float(np.sum(unit / capped[1:-1]))
    objective_error = abs(objective - plan.objective) / max(abs(objective), 1e-12)
    hulls = any(shape.half is None and len(shape.points) > 2 for shape in bodies.shapes)
    sharp = HULL_AGREEMENT if hulls else AGREEMENT
    blur = problem.delta * float(np.sum(unit / capped[1:-1] ** 2)) * (sharp - AGREEMENT)
    if clearance_error > sharp:
        problems.append(f"node clearances differ by {clearance_error:.3g} m")
    if abs(length - plan.length) > AGREEMENT * max(length, 1.0):
        problems.append(f"the length is {length:.12g} m, not {plan.length:.12g} m")
    if objective_error > AGREEMENT + blur / max(abs(objective), 1e-12):
        problems.append(f"F is {objective:.12g}, not {plan.objective:.12g}")
    return clearance_error, objective_error


__all__ = ["Report", "verify"]
