"""Study files: TOML that describes a grid of problems, planners and seeds."""
