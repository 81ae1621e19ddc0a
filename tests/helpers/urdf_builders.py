"""Random robots, configurations and scenes from a seed, and URDF elements as text."""

import numpy as np

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf


def inertial(mass, moments, xyz=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0)):
    ixx, iyy, izz = moments
    return (
        f"<inertial><origin xyz='{_text(xyz)}' rpy='{_text(rpy)}'/><mass value='{mass!r}'/>"
        f"<inertia ixx='{ixx!r}' iyy='{iyy!r}' izz='{izz!r}' ixy='0' ixz='0' iyz='0'/></inertial>"
    )


def box(size, xyz=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0)):
    return _shape(f"<box size='{_text(size)}'/>", xyz, rpy)


def sphere(radius, xyz=(0.0, 0.0, 0.0)):
    return _shape(f"<sphere radius='{radius!r}'/>", xyz, (0.0, 0.0, 0.0))


def capsule(radius, length, xyz=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0)):
    return _shape(f"<capsule radius='{radius!r}' length='{length!r}'/>", xyz, rpy)


def cylinder(radius, length, xyz=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0)):
    return _shape(f"<cylinder radius='{radius!r}' length='{length!r}'/>", xyz, rpy)


def mesh(address, scale=(1.0, 1.0, 1.0), xyz=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0)):
    return _shape(f"<mesh filename='{address}' scale='{_text(scale)}'/>", xyz, rpy)


def link(name, *parts):
    return f"<link name='{name}'>{''.join(parts)}</link>"


def joint(name, kind, parent, child, xyz, rpy=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0), limit=3.0):
    bounds = "" if kind == "continuous" else f"lower='{-limit}' upper='{limit}'"
    return (
        f"<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>"
        f"<origin xyz='{_text(xyz)}' rpy='{_text(rpy)}'/><axis xyz='{_text(axis)}'/>"
        f"<limit {bounds} effort='1' velocity='1'/></joint>"
    )


def urdf(*parts):
    return f"<robot name='made'>{''.join(parts)}</robot>"


def random_robot(
    seed, kinds=("revolute", "continuous", "prismatic"), arms=2, depth=3, solids=(), **options
):
    """A tree of boxes and spheres with moderate, physical inertias.

    `solids` (functions of a radius and a length: `capsule`, `cylinder`) replace most shapes of the
    arms; `options` are passed to `robot_from_urdf`.
    """
    rng, more = np.random.default_rng(seed), np.random.default_rng(seed + 1)
    parts = [
        link(
            "base",
            inertial(rng.uniform(2, 20), _moments(rng, 2.0)),
            box(rng.uniform(0.2, 0.6, 3)),
        )
    ]
    for arm in range(arms):
        parent = "base"
        for k in range(int(rng.integers(1, depth + 1))):
            name = f"arm{arm}_{k}"
            reach = rng.uniform(-0.3, 0.3, 3)
            body = inertial(rng.uniform(0.2, 3), _moments(rng, 0.05), reach, rng.uniform(-3, 3, 3))
            shape = (
                box(rng.uniform(0.04, 0.3, 3), reach, rng.uniform(-3, 3, 3))
                if rng.random() < 0.7
                else sphere(float(rng.uniform(0.03, 0.15)), reach)
            )
            if solids and more.random() < 0.7:
                solid = solids[int(more.integers(len(solids)))]
                radius, length = more.uniform((0.02, 0.02), (0.1, 0.4)).tolist()
                shape = solid(radius, length, reach, more.uniform(-3, 3, 3))
            parts.append(link(name, body, shape))
            axis = rng.normal(size=3)
            offset = rng.uniform(-0.5, 0.5, 3) + (
                np.sign(rng.normal(size=3)) * 0.3 if k == 0 else 0
            )
            parts.append(
                joint(
                    f"j{arm}_{k}",
                    str(rng.choice(kinds)),
                    parent,
                    name,
                    offset,
                    rng.uniform(-3, 3, 3),
                    axis / np.linalg.norm(axis),
                )
            )
            parent = name
    return robot_from_urdf(urdf(*parts), f"random_{seed}", **options)


def random_configuration(robot, rng, spread=2.0):
    values = rng.uniform(-1.0, 1.0, robot.nd)
    joints = dict(zip(robot.joint_names, values.tolist(), strict=True))
    angles = rng.uniform(-1.3, 1.3, 3)
    return robot.configuration(rng.uniform(-spread, spread, 3), angles, joints)


def random_scene(rng, count=6, low=(-1, -3, -0.5), high=(9, 3, 0.5), radii=(0.1, 0.5)):
    return fp.Scene(rng.uniform(low, high, (count, 3)), rng.uniform(*radii, count))


def _moments(rng, size):
    """Principal moments of a random body: sums of pairs of positive second moments."""
    x, y, z = rng.uniform(0.05, 1.0, 3) * size
    return float(y + z), float(x + z), float(x + y)


def _shape(solid, xyz, rpy):
    origin = f"<origin xyz='{_text(xyz)}' rpy='{_text(rpy)}'/>"
    return f"<collision>{origin}<geometry>{solid}</geometry></collision>"


def _text(numbers):
    return " ".join(repr(float(n)) for n in numbers)
