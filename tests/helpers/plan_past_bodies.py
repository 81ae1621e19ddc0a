"""A plan past three moving bodies, of which pictures are made."""

import json

import ffsr_plan as fp
from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.tumble import Tumble

DURATION = 40.0
BODIES = (
    MovingBody([fp.Box((0.9, 0.2, 0.2)), fp.Ball(0.2, (0.5, 0, 0))], Spin((0, 0, 0.1)), (1, 2, 0)),
    MovingBody([fp.Ball(0.2)], Drift((0.02, -0.03, 0.0)), (2.5, 3.0, 0.0), name="debris"),
    MovingBody(
        [fp.Box((0.6, 0.3, 0.2), name="bus"), fp.Box((0.1, 1.0, 0.3), (0, 0.6, 0), name="panel")],
        Tumble((1.0, 2.0, 2.5), (0.1, 0.2, 0.05), (0.01, 0.0, 0.0), known_until=DURATION),
        (2.0, -2.2, 0.0),
        (0.3, 0.2, 0.1),
        "old satellite",
    ),
)


def plan_past_bodies():
    """The plan; its problem has a duration and a ramp."""
    robot = fp.load_robot("planar_dual_arm")
    problem = fp.Problem(
        robot,
        fp.Scene([[3.0, 1.8, 0.0]], [0.2], bodies=BODIES),
        start=robot.neutral(),
        goal=robot.configuration((4.0, 0.0, 0.0), joints={"left_1": 0.6}),
        lattice=fp.Lattice(5, lateral=fp.Axis(2, 0.4)),
        delta=0.2,
        duration=DURATION,
        ramp=0.25,
    )
    return fp.plan(problem, fp.LatticeOptimum())


def data_of(html):
    """The data of a page."""
    return json.JSONDecoder().raw_decode(html, html.index("const data = ") + 13)[0]
