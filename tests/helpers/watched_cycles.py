"""Cycles of a search, and the meshcat commands that show them."""

import base64

import umsgpack

import ffsr_plan as fp


def cycles_of(problem, planner=None):
    """All cycles of a colony, with their pheromone as it was."""
    seen = []
    fp.plan(problem, planner, on_cycle=lambda c: seen.append(c._replace(pheromone=c.pheromone + 0)))
    return seen


def unpacked(packed):
    return {c["path"]: c for c in (umsgpack.unpackb(base64.b64decode(p)) for p in packed)}
