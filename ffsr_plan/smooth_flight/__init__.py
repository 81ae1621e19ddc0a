"""Smooth flights: time laws along smooth curves, at rest at the ends only."""
