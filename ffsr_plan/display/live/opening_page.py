"""The page of a live view before the first cycle: obstacles, and the robot at both ends."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.display.scenes.body_tracks import body_tracks
from ffsr_plan.display.scenes.debris_track import debris_track
from ffsr_plan.display.scenes.meshcat_objects import CommandLog
from ffsr_plan.display.scenes.picture_data import drawn_solid, motion_frames
from ffsr_plan.display.scenes.projection import view_axes
from ffsr_plan.display.scenes.scene_objects import (
    add_bodies,
    add_body_ghosts,
    add_debris,
    add_ends,
    add_obstacles,
    add_zones,
    set_up,
)
from ffsr_plan.display.web.html_template import html_page
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.problem.problem import Problem

_CORNERS = 41  # of the straight way
_INSTANTS = 61  # of the ways of bodies; a third of the time is among them
_LATER = (20, 40, 60)  # instants at which bodies are drawn faint


def opening_page(problem: Problem, lattice: LayeredLattice | None, title: str) -> str:
    """HTML text. The camera sees the inner half of the lattice or of the base's window.

    Moving bodies are where they are at the start, and faint where they are later; the heading says
    so.

    Args:
        problem: what will be planned.
        lattice: its lattice; None without one.
        title: heading; by default the robot and the mode.
    """
    import meshcat

    log = CommandLog()
    viewer = meshcat.Visualizer(window=log)
    straight = (_straight_way(problem) if lattice is None else lattice.nominal).configurations()
    frames = motion_frames(problem.robot, straight)
    centers, radii = frames.bounding_spheres()
    aside = 0.5 * _farthest_aside(problem, lattice)  # little of the search goes farther out
    spread = centers + aside[:, None, None]
    tracks = body_tracks(problem.scene, _instants(problem))
    debris = debris_track(problem.scene, _instants(problem))
    view = set_up(viewer, problem, spread, radii, tracks, debris)
    add_obstacles(viewer["obstacles"], problem.scene, drawn_solid(problem.scene, centers))
    add_bodies(viewer["bodies"], tracks, view_axes(problem)[2])
    add_body_ghosts(viewer["bodies"]["later"], tracks, _LATER)
    add_debris(viewer["bodies"]["debris"], debris)
    for row in _LATER if debris else ():
        add_debris(viewer["bodies"]["debris_later"][str(row)], debris, row, faint=True)
    add_zones(viewer["zones"], problem.scene, spread, radii)
    goal = problem.goal if problem.reach_attitude else straight[-1]
    add_ends(viewer, problem.robot, problem.start, goal)
    space = "the whole space"
    if lattice is not None:
        space = f"{lattice.divisions} edges, {lattice.size} offsets a layer"
    data = {
        "title": title or f"{problem.robot.name}, {problem.mode}",
        "subtitle": f"search over {space}, δ {problem.delta:g}{_said_of(problem)}",
        "commands": log.commands,
        "view": view,
        "trees": lattice is None,
        "bodies": problem.scene.moves,
    }
    return html_page("live", data)


def _instants(problem: Problem) -> Array | None:
    """Times at equal steps [s]; None without a duration."""
    duration = problem.duration
    return None if duration is None else np.linspace(0.0, duration, _INSTANTS)


def _said_of(problem: Problem) -> str:
    """At which times moving bodies are drawn."""
    times = _instants(problem)
    if times is None or not problem.scene.moves:
        return ""
    later = ", ".join(f"{times[row]:.3g}" for row in _LATER)
    return f"; moving bodies at 0 s, faint at {later} s"


def _straight_way(problem: Problem) -> Motion:
    shares = np.arange(_CORNERS)[:, None] / (_CORNERS - 1)
    way = problem.start[:3] + shares * problem.base_displacement
    return Motion(problem.robot, problem.mode, problem.start, problem.goal, way)


def _farthest_aside(problem: Problem, lattice: LayeredLattice | None) -> Array:
    """(3, 3) how far from the straight way the base may be, at both extremes and not at all [m]."""
    if lattice is not None:
        return lattice.offsets[[0, lattice.origin, -1]]
    if problem.mode.floats:
        return np.zeros((3, 3))
    ends = np.stack([problem.start[:3], problem.start[:3] + problem.base_displacement])
    low, high = problem.base_window
    return np.stack([low - ends.min(axis=0), np.zeros(3), high - ends.max(axis=0)])
