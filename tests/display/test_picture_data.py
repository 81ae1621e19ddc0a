"""Kinematics and nearby obstacles of pictures agree with Pinocchio and with brute force."""

import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from ffsr_plan.display.scenes.picture_data import drawn_solid, motion_frames, near_track


@pytest.mark.parametrize("name", ["planar_dual_arm", "spatial_dual_arm", "satellite_ur5"])
def test_frames_agree_with_pinocchio(name):
    robot = fp.load_robot(name)
    rng = np.random.default_rng(1)
    goal = robot.configuration((1.0, -2.0, 0.5), (0.3, -0.4, 0.7))
    goal[7:] = rng.uniform(-1.0, 1.0, robot.nd)
    configurations = np.array([robot.neutral(), goal])
    frames = motion_frames(robot, configurations)
    data, geometry = robot.model.createData(), robot.collision_model.createData()
    for row, q in enumerate(configurations):
        pin.updateGeometryPlacements(robot.model, data, robot.collision_model, geometry, q)
        for joint in range(1, robot.model.njoints):
            assert np.allclose(frames.origins[row, joint - 1], data.oMi[joint].translation)
            assert np.allclose(frames.rotations[row, joint - 1], data.oMi[joint].rotation)
        placed = np.array([placement.translation for placement in geometry.oMg])
        assert np.allclose(frames.placements.positions[row], placed)


def test_tips_are_the_last_shapes_of_the_arms(robot):
    q = robot.neutral()
    tracks = motion_frames(robot, q[None]).tip_tracks()
    assert sorted(tracks) == ["left_3", "right_3"]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        (tip,) = tracks[f"{side}_3"]
        assert tip[0] == pytest.approx(0.12)
        assert sign * tip[1] > 1.0


def test_near_track_agrees_with_brute_force():
    rng = np.random.default_rng(2)
    scene = fp.Scene(rng.uniform(-3.0, 3.0, (200, 3)), rng.uniform(0.05, 0.5, 200))
    positions = rng.uniform(-1.0, 1.0, (5, 7, 3))
    distances = np.linalg.norm(positions.reshape(-1, 1, 3) - scene.centers, axis=2).min(axis=0)
    near = near_track(scene, positions, 0.4)
    assert np.array_equal(near, distances < 0.4 + scene.radii)
    assert 0 < np.count_nonzero(near) < 200


def test_few_obstacles_are_all_drawn_solid():
    positions = np.zeros((1, 3))
    for count, solid in ((0, 0), (60, 60), (61, 1)):
        centers = np.outer(np.arange(count), [10.0, 0.0, 0.0])
        assert np.count_nonzero(drawn_solid(fp.Scene(centers, np.ones(count)), positions)) == solid
