"""Shapes of obstacles, zones, and the trees over them."""
