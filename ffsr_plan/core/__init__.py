"""Arrays, checks, errors, rotations and files: what every other folder uses."""
