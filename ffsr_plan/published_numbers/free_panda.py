"""A free Panda arm: masses, a closed loop of two joints, and the limits of a heavy bus.

The inertial parameters are those that Franka published and MoveIt's panda_description carries.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.published_numbers.models.rigid_trees import Body, RigidTree, rotation
from ffsr_plan.published_numbers.models.summed_momentum import fixed_jacobian
from ffsr_plan.published_numbers.recomputed_number import PUBLISHED, RecomputedNumber
from ffsr_plan.robots.robot import SpaceRobot

_SOURCE = "free-floating-manipulation (github.com/amoeinn/free-floating-manipulation), README"
_QUARTER = 0.5 * np.pi
_HOME = np.array([0.0, -0.3, 0.0, -1.8, 0.0, 1.5, 0.0])
_POINTS = 1600  # straight pieces of a loop: the rotation is good to 2e-5 of itself
_GYRATION = 0.25  # [m^2] moment of inertia of a bus per kilogram
_LIMITS = np.array(
    [
        [-2.9671, 2.9671], [-1.8326, 1.8326], [-2.9671, 2.9671], [-3.1416, 0.0873],
        [-2.9671, 2.9671], [-0.0873, 3.8223], [-2.9671, 2.9671],
    ]
)  # fmt: skip
_JOINTS = (  # mass [kg]; ixx, iyy, izz, ixy, ixz, iyz [kg m^2]; centre [m]; place [m]; turn about x
    (4.970684, (0.70337, 0.70661, 0.009117, -0.000139, 0.006772, 0.019169),
     (0.003875, 0.002081, -0.04762), (0.0, 0.0, 0.333), 0.0),
    (0.646926, (0.007962, 0.02811, 0.025995, -0.003925, 0.010254, 0.000704),
     (-0.003141, -0.02872, 0.003495), (0.0, 0.0, 0.0), -_QUARTER),
    (3.228604, (0.037242, 0.036155, 0.01083, -0.004761, -0.011396, -0.012805),
     (0.027518, 0.039252, -0.066502), (0.0, -0.316, 0.0), _QUARTER),
    (3.587895, (0.025853, 0.019552, 0.028323, 0.007796, -0.001332, 0.008641),
     (-0.05317, 0.104419, 0.027454), (0.0825, 0.0, 0.0), _QUARTER),
    (1.225946, (0.035549, 0.029474, 0.008627, -0.002117, -0.004037, 0.000229),
     (-0.011953, 0.041065, -0.038437), (-0.0825, 0.384, 0.0), -_QUARTER),
    (1.666555, (0.001964, 0.004354, 0.005433, 0.000109, -0.001158, 0.000341),
     (0.060149, -0.014117, -0.010517), (0.0, 0.0, 0.0), _QUARTER),
    (0.735522, (0.012516, 0.010027, 0.004815, -0.000428, -0.00119, -0.000741),
     (0.010517, -0.004252, 0.061597), (0.088, 0.0, 0.0), _QUARTER),
)  # fmt: skip
_FINGER = (2.375e-6, 2.375e-6, 7.5e-7)


def free_panda() -> RigidTree:
    """The Panda on its own base link, its hand closed: a left finger of .015 kg, a right of .15."""
    pedestal = (0.00315, 0.00388, 0.004285, 8.2904e-07, 0.00015, 8.2299e-06)
    bodies = [Body("link0", 0.629769, _tensor(pedestal), (-0.041018, -0.00014, 0.049974))]
    for k, (mass, moments, center, place, turn) in enumerate(_JOINTS):
        turned = rotation(x=turn)
        body = Body(f"link{k + 1}", mass, _tensor(moments), center, f"link{k}", place, turned)
        bodies.append(body)
    turned = rotation(z=-0.25 * np.pi)
    hand = Body(
        "hand", 0.73, (0.001, 0.0025, 0.0017), (-0.01, 0.0, 0.03), "link7", (0.0, 0.0, 0.107),
        turned, moves=False,
    )  # fmt: skip
    fingers = [
        Body(f"finger_{side}", mass, _FINGER, parent="hand", place=(0.0, 0.0, 0.0584), moves=False)
        for side, mass in (("left", 0.015), ("right", 0.15))
    ]
    return RigidTree("free_panda", (*bodies, hand, *fingers))


def loop(amplitude: float, points: int = _POINTS) -> Array:
    """(points + 1, 7) joint values around the loop of joints 2 and 3 [rad]."""
    phase = np.linspace(0.0, 2.0 * np.pi, points + 1)
    values = np.tile(_HOME, (points + 1, 1))
    values[:, 1] += amplitude * np.sin(phase)
    values[:, 2] += amplitude * (1.0 - np.cos(phase))
    return values


def recomputed() -> list[RecomputedNumber]:
    """Masses, the closed loop on the arm's own base, and what a bus changes."""
    tree = free_panda()
    robot = tree.robot()
    base = float(robot.model.inertias[1].mass)
    masses = [
        _number("mass of the arm with its hand", "kg", 17.5869, robot.mass, 5e-5),
        _number("mass of its base link", "kg", 0.6298, base, 5e-5),
    ]
    return [*masses, *_closed_loop(tree, robot), *_buses(tree)]


def _closed_loop(tree: RigidTree, robot: SpaceRobot) -> list[RecomputedNumber]:
    turn = _loop_turn(robot, 0.6)
    angle = float(np.degrees(np.linalg.norm(turn)))
    simulated = "the source extrapolates a simulation to a step of zero"
    integrated = "the source integrates the base's velocity in 400 Runge-Kutta steps"
    numbers = [
        _number("rotation after the loop of .6 rad", "deg", 18.982, angle, 1e-3, simulated),
        _number("the same, without simulation", "deg", 18.9823, angle, 1e-3, integrated),
    ]
    axes = "the source prints it in the principal axes of the base link, as its simulator does"
    printed = (-0.071, 0.006, -0.323)
    own = _principal_axes(tree).T @ turn
    for axis, expected, found in zip("xyz", printed, own.tolist(), strict=True):
        what = f"{axis} of that rotation"
        numbers.append(_number(what, "rad", expected, found, 1e-3, axes))
    return numbers


def _buses(tree: RigidTree) -> list[RecomputedNumber]:
    amplitudes, masses = np.array([0.1, 0.2, 0.3]), np.array([1e3, 3e3, 1e4])
    heavy = _on_bus(tree, 1e4).robot()
    small = [np.linalg.norm(_loop_turn(heavy, each, 400)) for each in amplitudes]
    by_mass = [np.linalg.norm(_loop_turn(_on_bus(tree, m).robot(), 0.45, 400)) for m in masses]
    bus = "bus of moment of inertia m (.5 m)^2 about the base link's centre of mass"
    random = f"{bus}; mean over eight configurations, drawn as the source does"
    servicer = float(np.degrees(np.linalg.norm(_loop_turn(_on_bus(tree, 2300.0).robot(), 0.6))))
    return [
        _number("slope of log rotation in log amplitude", "", 1.94, _slope(amplitudes, small),
                5e-3, bus),
        _number("slope of log rotation in log bus mass", "", -0.98, _slope(masses, by_mass), 5e-3,
                bus),
        _number("slope of log |J* - J| / |J| in log bus mass", "", -0.996, _jacobian_slope(tree),
                5e-4, random),
        _number("rotation on a bus of 2300 kg", "deg", 0.25, servicer, 0.03,
                f"the source says about a quarter of a degree; {bus}"),
    ]  # fmt: skip


def _jacobian_slope(tree: RigidTree) -> float:
    from ffsr_plan.dynamics.momentum import generalized_jacobian

    masses = np.array([3e3, 1e4, 3e4, 1e5])
    low, high = 0.8 * _LIMITS.T
    values = np.random.default_rng(0).uniform(low, high, (8, 7))
    fixed = np.array([fixed_jacobian(tree, each, "hand") for each in values])
    relative = []
    for mass in masses:
        robot = _on_bus(tree, mass).robot()
        configurations = robot.assemble(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), values)
        stars = np.array([generalized_jacobian(robot, q, "hand") for q in configurations])
        missing = np.linalg.norm(stars - fixed, axis=(1, 2))
        relative.append(np.mean(missing / np.linalg.norm(fixed, axis=(1, 2))))
    return _slope(masses, relative)


def _loop_turn(robot: SpaceRobot, amplitude: float, points: int = _POINTS) -> Array:
    """(3,) rotation vector of the base after the loop, base axes at the start [rad]."""
    from ffsr_plan.core.rotations import IDENTITY, log
    from ffsr_plan.dynamics.reaction import Reaction

    turned = Reaction.along(robot, loop(amplitude, points)).attitudes(IDENTITY)[-1]
    return np.asarray(log(turned))


def _on_bus(tree: RigidTree, mass: float) -> RigidTree:
    return tree.on_base(mass, 3 * (_GYRATION * mass,))


def _principal_axes(tree: RigidTree) -> Array:
    """(3, 3) principal axes of the base link as columns, those nearest to its own."""
    axes = np.linalg.eigh(tree.bodies[0].tensor)[1]
    axes = axes[:, np.argmax(np.abs(axes), axis=1)]
    return np.asarray(axes * np.sign(np.diag(axes)))


def _slope(x: Array, y: list[np.floating] | Array) -> float:
    return float(np.polyfit(np.log(x), np.log(np.asarray(y)), 1)[0])


def _tensor(moments: tuple[float, ...]) -> Array:
    xx, yy, zz, xy, xz, yz = moments
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _number(
    quantity: str,
    unit: str,
    expected: float,
    computed: float,
    tolerance: float,
    differs: str = "",
) -> RecomputedNumber:
    what = f"free Panda: {quantity}"
    return RecomputedNumber(what, unit, PUBLISHED, expected, computed, tolerance, _SOURCE, differs)
