"""Lattices over time whose nodes are progress and offset: the robot may wait and go back."""
