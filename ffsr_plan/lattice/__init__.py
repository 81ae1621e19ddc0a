"""The layered lattice: nodes, edges, shortest paths over it and refinement beyond it."""
