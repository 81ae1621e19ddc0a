"""Smooth curves through configuration space, base reaction included."""
