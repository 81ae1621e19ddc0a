"""Paths of least fuel: the pair programme on coarse layers, and refinement on the curve's knots."""
