"""The command line."""

from ffsr_plan.cli.commands import app, main

__all__ = ["app", "main"]
