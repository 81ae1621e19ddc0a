"""A lattice and the whole space, searched one after the other."""
