"""Flights that meet a moving frame: end conditions, curves that fulfil them, and their times."""
