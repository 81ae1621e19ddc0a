"""Satellites composed from a bus and arms."""
