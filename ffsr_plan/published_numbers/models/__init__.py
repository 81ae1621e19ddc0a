"""Robots as publications state them, and their dynamics by sums over the bodies."""
