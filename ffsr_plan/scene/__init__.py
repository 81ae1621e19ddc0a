"""Obstacles: spheres, the tree over them, their files and seeded generators."""
