"""Bodies that move: where they are at any time, and bounds on how far they travel."""
