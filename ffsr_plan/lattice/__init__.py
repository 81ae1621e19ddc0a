"""The layered lattice: nodes, edges and shortest paths over it."""
