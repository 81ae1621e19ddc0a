"""Planners of OMPL on the problem set: their paths are judged with the true reaction."""

from dataclasses import asdict, replace

import pytest

import ffsr_plan as fp
from ffsr_plan.problem_set.running.ompl_peers import AT_REST, STRAIGHT, OmplPlanner

pytest.importorskip("ompl")
NAME = "paper/03"


def test_a_path_for_a_base_at_rest_is_judged_with_its_reaction(problems):
    """The arms turn the base on the way, which its planner takes to be at rest."""
    planner = OmplPlanner("RRTConnect", AT_REST)
    trajectory, figures = planner.plan(problems[NAME].problem, 0, time_limit=5.0)
    assert trajectory.base_attitudes is None
    again = fp.judge(problems[NAME], trajectory)
    assert figures["judgement"] == asdict(replace(again, problem=""))
    problem = problems[NAME].problem
    report = fp.certify(problem.robot, fp.Scene(), trajectory, problem.mode)
    assert report.largest_turn > 0.05


def test_both_assumptions_agree_where_nothing_turns_the_base(problems):
    problem = problems[NAME].problem
    held = fp.Problem(problem.robot, problem.scene, problem.start,
                      problem.robot.assemble(problem.goal[:3], problem.start[3:7],
                                             problem.robot.joint_values(problem.start)),
                      "attitude-held")  # fmt: skip
    for assumed in (AT_REST, STRAIGHT):
        _, figures = OmplPlanner("RRTConnect", assumed).plan(held, 0, time_limit=5.0)
        assert figures["judgement"]["accepted"], figures["judgement"]["reason"]


def test_bodies_that_move_are_refused(problems):
    with pytest.raises(fp.InvalidInput, match="no body moves"):
        OmplPlanner("RRTConnect", AT_REST).plan(problems["moving/00"].problem, 0)
