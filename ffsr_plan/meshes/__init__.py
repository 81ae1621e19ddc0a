"""Triangle meshes: reading them, simpler hulls around them, covers by spheres and boxes."""
