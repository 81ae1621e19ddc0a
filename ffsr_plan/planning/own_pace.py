"""What a plan past bodies that move cannot be turned into: a motion at another pace."""

from __future__ import annotations

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.problem.problem import Problem


def refuse_another_pace(what: str, problem: Problem) -> None:
    """Refuse what has a pace of its own where bodies of the scene move.

    Args:
        what: the name of the method.
        problem: the problem of the plan.

    Raises:
        InvalidInput: bodies move, and the plan is proven at its own pace alone.
    """
    if problem.scene.moves:
        allowed = (
            f"a scene at rest for {what}, which has a pace of its own; past bodies that move a "
            "plan is proven at its own pace alone, of which to_csv writes the times"
        )
        raise InvalidInput("scene bodies", list(problem.scene.moving), allowed)
