"""Bodies that move, for the verification: their poses and speeds by code of its own."""
