"""Ant colonies on lattices whose nodes have one configuration each."""
