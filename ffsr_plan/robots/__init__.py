"""Robots from URDF: validation, Pinocchio models, collision shapes, kinematics."""
