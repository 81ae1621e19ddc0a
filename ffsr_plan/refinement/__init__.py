"""Refinement: paths moved off the lattice, with the clearance between the nodes."""
