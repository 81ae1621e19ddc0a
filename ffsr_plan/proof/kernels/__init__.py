"""Compiled travel bound, and compiled interval halving on distances in closed form."""
