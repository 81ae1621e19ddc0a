"""What cannot be made of a plan past bodies that move: searches that see no times."""

from __future__ import annotations

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.problem.problem import Problem


def refuse_bodies(what: str, problem: Problem) -> None:
    """Refuse a search that sees no times where bodies of the scene move.

    Args:
        what: the name of the method.
        problem: the problem of the plan.

    Raises:
        InvalidInput: bodies move.
    """
    if problem.scene.moves:
        allowed = (
            f"a scene at rest for {what}, whose search sees no times; smooth and timed are proven "
            "past bodies that move"
        )
        raise InvalidInput("scene bodies", list(problem.scene.moving), allowed)
