"""The command `ffsr-plan study`: studies of many plans, and their reports."""
