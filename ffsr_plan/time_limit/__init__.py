"""The time limit of a call."""
