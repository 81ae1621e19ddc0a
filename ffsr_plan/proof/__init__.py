"""Proofs that an edge is free: interval halving with a bound on travel."""
