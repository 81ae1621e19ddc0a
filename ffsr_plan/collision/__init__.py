"""Distances between the robot's shapes and obstacles, and between its links."""
