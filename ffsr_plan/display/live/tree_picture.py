"""Picture of a round of a search by trees: branches as ribbons, the best path, the robot there."""

from __future__ import annotations

from ffsr_plan.display.scenes.meshcat_objects import CommandLog
from ffsr_plan.display.scenes.picture_data import branch_segments
from ffsr_plan.display.scenes.projection import view_axes
from ffsr_plan.display.scenes.scene_objects import TRACK, add_track, add_trails, place_robot
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import TreeCycle

_DRAWN_BRANCHES = 3000  # at most


def commands(cycle: TreeCycle, problem: Problem) -> list[str]:
    """Packed meshcat commands that replace the branches, the best path and the robot's posture.

    Args:
        cycle: the round.
        problem: gives the robot and the direction of view.
    """
    import meshcat

    log = CommandLog()
    viewer = meshcat.Visualizer(window=log)
    up = view_axes(problem)[2]
    viewer["ants"]["dots"].delete()  # of a colony that came before, in a portfolio
    segments, strength = branch_segments(cycle.branches, _DRAWN_BRANCHES)
    if len(segments):
        add_trails(viewer["trails"]["tau"], segments, strength, up)
    else:
        viewer["trails"]["tau"].delete()
    if len(cycle.path):
        add_track(viewer["tracks"]["best"], cycle.path, 0.035, TRACK, up)
        place_robot(viewer["robot"], problem.robot, cycle.arrival)
    return log.commands
