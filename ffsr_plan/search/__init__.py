"""Planners: what they share, the exact optimum, and worker processes."""
