"""Studies: thousands of plans of a grid of problems, planners and seeds."""
