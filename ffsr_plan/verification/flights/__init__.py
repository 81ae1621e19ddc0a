"""Independent verification of flights: integrals, forces, limits and distances over time."""
