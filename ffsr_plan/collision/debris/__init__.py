"""Distances to spheres that drift, at any time."""
