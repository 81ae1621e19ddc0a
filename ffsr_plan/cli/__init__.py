"""The command line."""

from ffsr_plan.cli.commands import app, main
from ffsr_plan.cli.result_files import RESULTS

__all__ = ["RESULTS", "app", "main"]
