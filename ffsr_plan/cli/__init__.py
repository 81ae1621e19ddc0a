"""The command line."""

from ffsr_plan.cli.bench.commands import bench_app
from ffsr_plan.cli.commands import app, main
from ffsr_plan.cli.study.commands import study_app

app.add_typer(study_app, name="study")
app.add_typer(bench_app, name="bench")

__all__ = ["app", "main"]
