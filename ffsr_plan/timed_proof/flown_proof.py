"""Proofs of motions that are run at given times past bodies that move, waits included.

While a robot waits it is a motion of one edge without motion, past which bodies travel.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.bodies.pace import Timetable
from ffsr_plan.collision.contacts import named
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.contacts import Contact
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.interval_halving import Verdict
from ffsr_plan.proof.prover import Prover
from ffsr_plan.scene.scene import Scene


class Refusal(NamedTuple):
    """What comes too close, and when.

    Attributes:
        contact: link and obstacle; the depth is negative apart.
        time: of it [s].
    """

    contact: Contact
    time: float


class FlownProof(NamedTuple):
    """What is proven of a motion at given times.

    Attributes:
        least_clearance: proven all along it [m]; zero where an edge is refused.
        refusal: the first edge that was refused, in the words of an error; None where none was.
    """

    least_clearance: float
    refusal: Refusal | None


class _Waiting(NamedTuple):
    """The times of an edge without motion, from zero on."""

    end: float

    def instants(self, places: Array) -> Array:
        return np.asarray(places) * self.end

    def is_even(self, edge: int) -> bool:
        return True


def prove_flown(scene: Scene, prover: Prover, edges: int, times: Timetable) -> FlownProof:
    """Prove that a motion is free at given times.

    Args:
        scene: the obstacles.
        prover: proofs along the motion at these times.
        edges: m, number of its edges.
        times: the times.
    """
    still, layers = np.zeros((edges + 1, 3)), np.arange(edges + 1)
    clearances = prover.clearances(layers, still)
    ends = np.column_stack([clearances[:-1], clearances[1:]])
    verdicts = prover.certify_all(layers[:-1], still[1:], still[1:], ends)
    refusal = first_refusal(scene, prover, verdicts, times)
    if refusal is not None:
        return FlownProof(0.0, refusal)
    return FlownProof(prover.least_clearance(still, clearances), None)


def prove_waiting(scene: Scene, motion: Motion, wait: float, tolerance: float) -> FlownProof:
    """Prove that a robot is free while it waits at the start of a motion, from time zero on.

    Args:
        scene: the obstacles.
        motion: the motion.
        wait: until when [s].
        tolerance: clearance below which the wait may be refused [m].
    """
    if wait == 0.0:
        return FlownProof(np.inf, None)
    q, times = motion.configurations()[0], _Waiting(wait)
    still = Motion(motion.robot, motion.mode, q, q, np.stack([q[:3], q[:3]]))
    return prove_flown(scene, Prover(still, scene, tolerance, pace=times), 1, times)


def first_refusal(
    scene: Scene, prover: Prover, verdicts: list[Verdict], times: Timetable
) -> Refusal | None:
    """The first edge that is refused; None where all are free.

    Args:
        scene: the obstacles.
        prover: proofs along the motion.
        verdicts: of its edges.
        times: of the motion.
    """
    for edge, verdict in enumerate(verdicts):
        if not verdict.free:
            near = prover.nearest(edge, np.zeros(3), np.zeros(3), verdict.time)
            time = float(times.instants(np.array(edge + verdict.time)))
            return Refusal(named(scene, near), time)
    return None
