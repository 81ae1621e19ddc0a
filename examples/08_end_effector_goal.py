"""Give the goal as a position of the hand instead of joint values.

The base reacts to the arms, so that the place of the hand depends on the motion that leads there.
`reaching` solves the inverse kinematics at the true end of the motion.

Writes `end_effector.html`.
"""

import numpy as np
import pinocchio as pin

import ffsr_plan as fp


def main() -> None:
    """Plan to a position of the left hand and measure by how much it is missed."""
    robot = fp.load_robot("planar_dual_arm")
    problem = fp.Problem(
        robot,
        fp.Scene(centers=[[1.0, -1.6, 0.0]], radii=[0.3]),
        start=robot.neutral(),
        goal=robot.configuration((2.0, 0.0, 0.0)),
        lattice=fp.Lattice(divisions=10, lateral=fp.Axis(half_count=5, spacing=0.1)),
    )
    hand, position = "left_link_3", np.array([2.9, 0.5, 0.0])
    plan = fp.plan(problem.reaching(hand, position=position))

    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, plan.configurations[-1])
    reached = data.oMf[robot.model.getFrameId(hand)].translation
    print(f"hand at {reached.round(4)}, missed by {np.linalg.norm(reached - position):.1e} m")
    plan.write_html("end_effector.html", title="The left hand at a given position")


if __name__ == "__main__":
    main()
