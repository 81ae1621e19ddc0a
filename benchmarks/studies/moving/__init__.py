"""Studies of bodies that move, and of lattices with progress."""
