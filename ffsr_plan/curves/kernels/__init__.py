"""Compiled evaluation of curves, and of the base reaction along them."""
