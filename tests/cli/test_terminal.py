"""Exit status and messages of the command line at its boundary."""

import pytest
import typer
from typer.testing import CliRunner

from ffsr_plan import errors
from ffsr_plan.cli import planning
from ffsr_plan.cli.commands import app
from ffsr_plan.cli.console.terminal import errors_on_stderr


def leave(error):
    """Exit status and text for an error inside."""
    with pytest.raises(typer.Exit) as left, errors_on_stderr():
        raise error
    return left.value.exit_code


@pytest.mark.parametrize(
    ("error", "status"),
    [
        (errors.InvalidInput("a", 1, "b"), 2),
        (errors.NoPath(1, (), 2), 1),
        (errors.IntegrationError("it does not converge"), 2),
        (errors.InternalError("a broken invariant"), 70),
        (RuntimeError("not foreseen"), 70),
        (MemoryError(), 70),
        (RecursionError("deep"), 70),
        (UnicodeEncodeError("utf-8", "\ud800", 0, 1, "surrogates"), 70),
    ],
)
def test_every_error_has_its_exit_status(error, status, capsys):
    assert leave(error) == status
    shown = " ".join(capsys.readouterr().err.split())
    assert shown.startswith("ffsr-plan: ")
    assert ("please report it" in shown) == (status == 70)
    assert "Traceback" not in shown


def test_an_unforeseen_error_says_what_and_where(capsys):
    leave(ZeroDivisionError("a\nb"))
    shown = " ".join(capsys.readouterr().err.split())
    assert "ZeroDivisionError in terminal.py, line" in shown
    assert "a b" in shown


def test_brackets_in_names_are_not_markup(tmp_path, monkeypatch):
    monkeypatch.setattr(planning, "write_results", lambda *_: None)
    target = tmp_path / "[" / "red]:smile:[bold]"
    result = CliRunner().invoke(app, ["plan", "fig2a", "--no-verify", "--out", str(target)])
    assert result.exit_code == 0, result.output
    assert "red]:smile:[bold]" in result.output.replace("\n", "")


@pytest.mark.parametrize("name", ["n" * 300, "a\0b"])
@pytest.mark.parametrize(
    "command",
    [["plan", "fig2a", "--out"], ["plan"], ["verify"], ["export", "p.json"], ["gif", "p.json"]],
    ids=range(5),
)
def test_names_that_no_file_can_have_are_refused(command, name):
    result = CliRunner().invoke(app, [*command, name])
    assert result.exit_code == 2
    assert isinstance(result.exception, SystemExit)
