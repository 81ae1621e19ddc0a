"""Trajectories: time laws along a proven motion, and their tables."""
