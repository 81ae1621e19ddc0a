"""Momentum conservation: base reaction, motions, wheel momentum, inverse dynamics."""
