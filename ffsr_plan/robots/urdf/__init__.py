"""The text of a URDF, read once: one canonical text for all that use the robot."""
