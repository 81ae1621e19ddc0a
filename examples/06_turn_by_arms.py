"""Rotate the base by 30 degrees with nothing but the arms.

Angular momentum is conserved, and yet a closed loop of the joints leaves the base rotated. Two
posture axes span the plane in which the search finds such loops: start and goal have the same
position and the same joint values, and differ in the attitude of the base alone.

Writes `turn.gif`: the close-up below the scene shows the angle.
"""

import numpy as np

import ffsr_plan as fp

REST = {"left_2": 0.8, "right_2": -0.8}
SHOULDERS = {"left_1": 1.0, "right_1": -1.0}
ELBOWS = {"left_2": 1.0, "right_2": 1.0}


def main() -> None:
    """Plan the rotation and write a moving picture."""
    robot = fp.load_robot("planar_dual_arm")
    problem = fp.Problem(
        robot,
        fp.Scene(),
        start=robot.configuration(joints=REST),
        goal=robot.configuration(attitude=(np.radians(30.0), 0.0, 0.0), joints=REST),
        lattice=fp.Lattice(
            divisions=48,
            postures=[
                fp.PostureAxis(SHOULDERS, half_count=5, spacing=0.3),
                fp.PostureAxis(ELBOWS, half_count=5, spacing=0.3),
            ],
        ),
        reach_attitude=True,
    )
    plan = fp.plan(problem, seed=0)
    print(f"base rotated by {np.degrees(plan.arrival_attitude[0]):.4f} degrees")
    print(f"length of the joint path {plan.length:.2f} m")
    plan.write_gif("turn.gif", frames=80, width=480)


if __name__ == "__main__":
    main()
