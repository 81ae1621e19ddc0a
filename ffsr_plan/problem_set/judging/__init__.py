"""Results of any planner for the problem set, judged by `certify`."""
