"""The problem set made: problem files, and the best plans known."""
