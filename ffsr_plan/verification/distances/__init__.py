"""Distances of convex solids for verification: compiled, by hand, without Coal."""
