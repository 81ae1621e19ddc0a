"""Smooth curves through configuration space: twice continuously differentiable, base reaction included."""
