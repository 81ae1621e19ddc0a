"""Compiled search: flight of edges, trees, and improvement of paths."""
