"""Independent verification of a plan; shares no distance or momentum code with planning."""
