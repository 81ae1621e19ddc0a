"""Independent check of flights: motion, forces, limits and clearances over time."""
