"""Put an arm on a satellite and plan past a truss.

`compose` joins a box-shaped bus, solar panels and an arm of example-robot-data to one robot with
masses, inertias and collision shapes. The result is a URDF that other tools read too.

Writes `my_satellite.urdf` (with its SRDF) and `satellite.html`.
"""

import ffsr_plan as fp


def main() -> None:
    """Compose the satellite, save it and plan an approach."""
    panels = [
        fp.Panel((0.8, 2.0, 0.03), (0.0, side * 1.65, 0.0), mass=12.0, name=name)
        for name, side in (("left_panel", 1.0), ("right_panel", -1.0))
    ]
    robot = fp.compose(
        fp.Bus(size=(1.0, 1.0, 1.2), mass=200.0, panels=panels),
        arms=[fp.Mount("ur5", position=(0.3, 0.0, 0.6), prefix="arm_")],
        name="my_satellite",
    )
    robot.save("my_satellite.urdf")
    print(f"{robot.name}: joints {', '.join(robot.joint_names)}")

    folded = {"arm_shoulder_lift_joint": -1.2, "arm_elbow_joint": 1.8, "arm_wrist_1_joint": -0.6}
    truss = fp.generators.truss((1.5, 0.0, 1.8), (7.5, 0.0, 1.8), width=0.6, bays=8, radius=0.06)
    problem = fp.Problem(
        robot,
        truss,
        start=robot.configuration(joints=folded),
        goal=robot.configuration((6.0, 0.0, 0.0), joints=folded | {"arm_shoulder_pan_joint": 1.0}),
        lattice=fp.Lattice(24, lateral=fp.Axis(6, 0.25), normal=fp.Axis(6, 0.25)),
        delta=0.02,
    )
    plan = fp.plan(problem, seed=0)
    print(f"length {plan.length:.2f} m, proven clearance {plan.certificate.least_clearance:.3f} m")
    plan.write_html("satellite.html", title="A satellite of our own along a truss")


if __name__ == "__main__":
    main()
