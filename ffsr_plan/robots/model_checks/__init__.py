"""Checks of a loaded robot: against its URDF, and for plausibility."""
