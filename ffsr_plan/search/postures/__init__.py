"""Ant colony and annealing on lattices with posture axes."""
