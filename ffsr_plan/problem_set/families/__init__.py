"""Seeded generators of the problem set's families."""
