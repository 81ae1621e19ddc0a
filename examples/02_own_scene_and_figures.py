"""Describe a problem in Python and draw the plan in a figure of your own.

Start, goal, obstacles and lattice are plain numbers. Lengths are in metres, angles in radians.

Writes `own_scene.png`: the path on the left, the clearance along it on the right.
"""

from matplotlib.figure import Figure

import ffsr_plan as fp
from ffsr_plan.display import clearance_figure, path_figure

FOLDED = {"left_1": -0.6, "left_2": -0.9, "right_1": 0.6, "right_2": 0.9}


def main() -> None:
    """Plan past three spheres and draw two figures side by side."""
    robot = fp.load_robot("planar_dual_arm")
    scene = fp.Scene(
        centers=[[2.0, 0.2, 0.0], [4.8, -1.4, 0.0], [4.2, 2.4, 0.0]],
        radii=[0.4, 0.35, 0.35],
    )
    problem = fp.Problem(
        robot,
        scene,
        start=robot.configuration(joints=FOLDED),
        goal=robot.configuration(position=(6.0, 0.0, 0.0), joints=FOLDED | {"left_1": 0.7}),
        lattice=fp.Lattice(divisions=24, lateral=fp.Axis(half_count=15, spacing=0.1)),
        delta=0.05,
    )
    plan = fp.plan(problem, seed=0)
    print(f"length {plan.length:.2f} m, least clearance at a node {plan.clearances.min():.3f} m")

    figure = Figure(figsize=(13.0, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    path_figure(plan, ax=left)
    clearance_figure(plan, ax=right)
    figure.savefig("own_scene.png", dpi=120)


if __name__ == "__main__":
    main()
