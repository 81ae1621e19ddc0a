"""Trajectories from anywhere judged: proven free, or the first contact and its cause."""
