"""Plans whose flights meet a frame, in all modes, and what a frame does by Pinocchio alone."""

import numpy as np
import pinocchio as pin

import ffsr_plan as fp

LIMITS = {
    "free-flying": {"joint_acceleration": 0.05, "thruster_acceleration": 0.01},
    "attitude-held": {
        "joint_acceleration": 0.05,
        "thruster_acceleration": 0.01,
        "turn_acceleration": 0.01,
    },
    "free-floating": {"joint_acceleration": 0.05},
}
FRAMES = {"planar_dual_arm": "right_link_3", "satellite_ur5": "arm_tool0"}
TWISTS = {
    "planar_dual_arm": ((0.005, 0.01, 0.0), (0.0, 0.0, 0.015)),
    "satellite_ur5": ((0.004, -0.003, 0.002), (0.004, -0.006, 0.01)),
}
AT = 150.0


def meeting_for(name, **given):
    velocity, angular = TWISTS[name]
    wanted = {"velocity": velocity, "angular_velocity": angular, "at": AT} | given
    return fp.Meeting(FRAMES[name], **wanted)


def plan_for(name, mode):
    """A plan among two obstacles from the start posture to another one."""
    robot = fp.load_robot(name)
    names = robot.joint_names
    start = robot.configuration(joints=dict.fromkeys(names, 0.1))
    bent = {joint: 0.1 + 0.4 * (-1.0) ** k for k, joint in enumerate(names)}
    afloat = mode == "free-floating"
    angles = (0.1, 0.0, 0.0) if mode == "attitude-held" else (0.0, 0.0, 0.0)
    place = (0.0, 0.0, 0.0) if afloat else (4.0, 1.0, 0.0)
    goal = robot.configuration(place, angles, joints=bent)
    scene = fp.Scene([[2.0, 6.0, 0.0], [2.0, -6.0, 0.0]], [0.5, 0.5])
    lattice = None if afloat else fp.Lattice(8, fp.Axis(1, 0.3))
    problem = fp.Problem(robot, scene, start, goal, mode=mode, lattice=lattice)
    return fp.plan(problem, until="first") if afloat else fp.plan(problem, "lattice-optimum")


def frame_poses(robot, frame, configurations):
    """Poses of a frame in the world at configurations (N, nq)."""
    data, index = robot.model.createData(), robot.model.getFrameId(frame)
    poses = []
    for q in configurations:
        pin.forwardKinematics(robot.model, data, q)
        poses.append(pin.SE3(pin.updateFramePlacement(robot.model, data, index)))
    return poses


def twist_of(robot, frame, states):
    """(6,) of a frame at the first of some states, world axes [m/s, rad/s]."""
    data, index = robot.model.createData(), robot.model.getFrameId(frame)
    pin.forwardKinematics(robot.model, data, states.configurations[0], states.velocities[0])
    pin.updateFramePlacement(robot.model, data, index)
    return pin.getFrameVelocity(robot.model, data, index, pin.LOCAL_WORLD_ALIGNED).vector


def momenta(robot, states):
    """(N, 6) linear momentum, and angular about the centre of mass, world axes."""
    data = robot.model.createData()
    return np.array(
        [
            pin.computeCentroidalMomentum(robot.model, data, q, v).vector
            for q, v in zip(states.configurations, states.velocities, strict=True)
        ]
    )
