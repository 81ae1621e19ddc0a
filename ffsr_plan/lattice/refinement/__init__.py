"""Refinement of a proven lattice path to offsets between the nodes."""
