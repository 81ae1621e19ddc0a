"""The data of a plan, its file, and the planners by name."""
