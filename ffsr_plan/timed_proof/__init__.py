"""Proofs at the times of a flight, past bodies that move."""
