"""Debris about a way along x, and problems past it."""

import numpy as np

import ffsr_plan as fp

DURATION = 40.0


def cloud_about(seed, count=40, far=4.0, speed=0.02, name="shell"):
    """Spheres about a way of `far`, a few of them ten times as fast as the others."""
    rng = np.random.default_rng(seed)
    centers = rng.uniform((0.0, -2.5, -1.0), (far, 2.5, 1.0), (count, 3))
    velocities = rng.normal(size=(count, 3)) * speed
    velocities[:: max(count // 4, 2)] *= 10.0
    radii = rng.uniform(0.02, 0.15, count)
    return fp.DebrisCloud(centers - 0.5 * DURATION * velocities, radii, velocities, name)


def free_of_ends(cloud, ends, room=1.6):
    """The spheres that stay away from start (at time zero) and goal (at the end)."""
    away = [
        np.linalg.norm(cloud.centers_at(time) - end, axis=1) - cloud.radii > room
        for end, time in zip(ends, (0.0, DURATION), strict=True)
    ]
    kept = np.all(away, axis=0)
    rows = cloud.centers[kept], cloud.radii[kept], cloud.velocities[kept]
    return fp.DebrisCloud(*rows, cloud.name)


def problem_in_debris(seed=0, count=40, robot="planar_dual_arm", **fields):
    """A way of 4 m along x through debris."""
    model, goal = fp.load_robot(robot), np.array((4.0, 0.0, 0.0))
    cloud = free_of_ends(cloud_about(seed, count), (np.zeros(3), goal))
    chosen = {"lattice": fp.Lattice(6, lateral=fp.Axis(4, 0.4)), "delta": 0.1} | fields
    return fp.Problem(
        model,
        fp.Scene(debris=[cloud]),
        start=model.neutral(),
        goal=model.configuration(goal, joints={model.joint_names[0]: 0.5}),
        duration=DURATION,
        **chosen,
    )
