"""Plans flown by MuJoCo edge by edge, and how far the base is from where it was planned.

At zero momentum the reaction does not depend on the time law. So each edge is flown from rest to
rest, and the joints keep to their path, corners included.
"""

import numpy as np

from ffsr_plan.core import rotations
from tests.helpers import mujoco_flight as engine

EDGE, STEP = 2.0, 0.02  # [s] for each edge and for each step of the engine
RECORDED = 10  # states an edge


def flown(plan, step=STEP):
    """The flight, recorded ten times an edge, with s, its rate and acceleration at these times."""
    edges = plan.motion.edges
    course, every = engine.course_of(plan, edges * EDGE, parts=edges), round(EDGE / step / RECORDED)
    flight = engine.fly(plan.problem.robot, plan.problem.mode, course, edges * EDGE, step, every)
    assert len(flight.times) == RECORDED * edges + 1
    return flight, engine.progress(flight.times, edges * EDGE, parts=edges)


def configurations(plan, flight):
    """(N, nq) of the flight."""
    return plan.problem.robot.assemble(flight.positions, flight.attitudes, flight.joints)


def departures(plan, flight):
    """Largest angle [rad] and distance [m] of the base, and change of a joint, from the plan."""
    edges = plan.motion.edges
    s, *_ = engine.progress(flight.times, edges * EDGE, parts=edges)
    planned = plan.at(s)
    planned[::RECORDED] = plan.configurations  # at the corners
    joints = np.abs(flight.joints - plan.problem.robot.joint_values(planned))
    return (
        float(rotations.angle_between(flight.attitudes, planned[:, 3:7]).max()),
        float(np.linalg.norm(flight.positions - planned[:, :3], axis=1).max()),
        float(joints.max()),
    )
