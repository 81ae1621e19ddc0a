"""The command `ffsr-plan bench`: the problem set."""
