"""Planners run on the problem set."""
