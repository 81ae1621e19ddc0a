"""Compiled base reaction: motion of the links, rotation of the base, and bounds on its error."""
