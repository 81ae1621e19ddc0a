"""Separations of boxes of a robot from boxes and balls that move, compiled, at many instants.

Boxes are compared by the separating-axis theorem: of the 15 axes (faces, and pairs of edges) the
widest gap is a lower bound on the distance of boxes that are apart, and minus the depth of others.
"""

import numpy as np
from numba import njit


@njit(cache=True)
def _times(a, b, out):
    """The product of two (3, 3)."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@njit(cache=True)
def _moved(turn, place, x, out):
    """A point (3,) along axes turn (3, 3) at a place."""
    for i in range(3):
        out[i] = place[i] + turn[i, 0] * x[0] + turn[i, 1] * x[1] + turn[i, 2] * x[2]


@njit(cache=True)
def gap_of_boxes(turn, apart, half, other):
    """The widest gap between two boxes.

    Args:
        turn: (3, 3) axes of the second box in the axes of the first.
        apart: (3,) its middle there [m].
        half: (3,) half sizes of the first [m].
        other: (3,) half sizes of the second [m].
    """
    best = -np.inf
    for i in range(3):
        reach = half[i]
        for j in range(3):
            reach += abs(turn[i, j]) * other[j]
        best = max(best, abs(apart[i]) - reach)
    for j in range(3):
        reach, along = other[j], 0.0
        for i in range(3):
            reach += abs(turn[i, j]) * half[i]
            along += turn[i, j] * apart[i]
        best = max(best, abs(along) - reach)
    for i in range(3):
        a, b = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            size = np.sqrt(turn[a, j] ** 2 + turn[b, j] ** 2)
            if size < 1e-7:  # parallel edges: the faces tell
                continue
            c, d = (j + 1) % 3, (j + 2) % 3
            along = abs(turn[a, j] * apart[b] - turn[b, j] * apart[a])
            reach = half[a] * abs(turn[b, j]) + half[b] * abs(turn[a, j])
            reach += other[c] * abs(turn[i, d]) + other[d] * abs(turn[i, c])
            best = max(best, (along - reach) / size)
    return best


@njit(cache=True)
def gap_to_point(point, half):
    """Signed distance of a point (3,) to a box of half sizes (3,) at the origin [m]."""
    outside, deepest = 0.0, -np.inf
    for i in range(3):
        beyond = abs(point[i]) - half[i]
        deepest = max(deepest, beyond)
        if beyond > 0.0:
            outside += beyond * beyond
    return np.sqrt(outside) if deepest > 0.0 else deepest


@njit(cache=True)
def _link_frames(parents, fixed_turns, fixed_places, axes, joints, turns, places):
    """Frames of all links in base axes, parents first; the base is link 0.

    Args:
        parents: (L,) number of each link's parent.
        fixed_turns: (L, 3, 3) of the joint in the parent.
        fixed_places: (L, 3) of the joint in the parent [m].
        axes: (L, 3) of the joint; zeros where it is fixed.
        joints: (L,) angles [rad].
        turns: (L, 3, 3), filled in.
        places: (L, 3), filled in [m].
    """
    own, whole = np.empty((3, 3)), np.empty((3, 3))
    for k in range(1, len(parents)):
        p = parents[k]
        x, y, z = axes[k]
        s, c = np.sin(joints[k]), np.cos(joints[k])
        v = 1.0 - c
        own[0, 0], own[0, 1], own[0, 2] = c + x * x * v, x * y * v - z * s, x * z * v + y * s
        own[1, 0], own[1, 1], own[1, 2] = y * x * v + z * s, c + y * y * v, y * z * v - x * s
        own[2, 0], own[2, 1], own[2, 2] = z * x * v - y * s, z * y * v + x * s, c + z * z * v
        _times(turns[p], fixed_turns[k], whole)
        _times(whole, own, turns[k])
        _moved(turns[p], places[p], fixed_places[k], places[k])


@njit(cache=True)
def link_frames(parents, fixed_turns, fixed_places, axes, joints):
    """(n, L, 3, 3) turns and (n, L, 3) places of links for joints (n, L); see `_link_frames`."""
    count = len(parents)
    turns, places = np.zeros((len(joints), count, 3, 3)), np.zeros((len(joints), count, 3))
    for n in range(len(joints)):
        for i in range(3):
            turns[n, 0, i, i] = 1.0
        _link_frames(parents, fixed_turns, fixed_places, axes, joints[n], turns[n], places[n])
    return turns, places


@njit(cache=True)
def least_separation(tree, boxes, base, joints, body, shapes, start):
    """The least separation at all instants, and the instant; `start` where none is less.

    Args:
        tree: parents, fixed turns, fixed places and axes of L links.
        boxes: (b,) link, (b, 3, 3) turn, (b, 3) place and (b, 3) half sizes of the robot's boxes.
        base: (n, 3, 3) turns and (n, 3) places of the robot's base.
        joints: (n, L) angles [rad].
        body: (n, 3, 3) turns and (n, 3) places of the body.
        shapes: (s, 3, 3) turns, (s, 3) places, (s, 3) half sizes and (s,) radii of its shapes; a
            ball has half sizes of zero and a radius, a box a radius of zero.
        start: separation from which on nothing counts [m].

    Returns:
        Separation [m] and number of the instant.
    """
    parents, fixed_turns, fixed_places, axes = tree
    links, own_turns, own_places, halves = boxes
    shape_turns, shape_places, shape_halves, radii = shapes
    count = len(parents)
    turns, places = np.zeros((count, 3, 3)), np.zeros((count, 3))
    for i in range(3):
        turns[0, i, i] = 1.0
    sizes = np.sqrt((halves**2).sum(axis=1))
    others = np.sqrt((shape_halves**2).sum(axis=1)) + radii
    one, two, three = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    middle, apart, point = np.empty(3), np.empty(3), np.empty(3)
    best, when = start, -1
    for n in range(len(joints)):
        _link_frames(parents, fixed_turns, fixed_places, axes, joints[n], turns, places)
        for b in range(len(links)):
            link = links[b]
            _moved(turns[link], places[link], own_places[b], point)
            _moved(base[0][n], base[1][n], point, apart)
            for i in range(3):
                apart[i] -= body[1][n, i]
            for i in range(3):  # the middle of the robot's box in the body's axes
                middle[i] = (
                    body[0][n, 0, i] * apart[0]
                    + body[0][n, 1, i] * apart[1]
                    + body[0][n, 2, i] * apart[2]
                )
            placed = False
            for s in range(len(radii)):
                square = 0.0
                for i in range(3):
                    square += (shape_places[s, i] - middle[i]) ** 2
                far = best + sizes[b] + others[s]
                if far <= 0.0 or square >= far * far:  # its ball is no nearer than the best
                    continue
                if not placed:  # the turn of the robot's box in the body's axes
                    _times(turns[link], own_turns[b], one)
                    _times(base[0][n], one, two)
                    _times(body[0][n].T, two, one)
                    placed = True
                for i in range(3):
                    apart[i] = 0.0
                    for j in range(3):
                        apart[i] += one[j, i] * (shape_places[s, j] - middle[j])
                if radii[s] > 0.0:
                    found = gap_to_point(apart, halves[b]) - radii[s]
                else:
                    _times(one.T, shape_turns[s], three)
                    found = gap_of_boxes(three, apart, halves[b], shape_halves[s])
                if found < best:
                    best, when = found, n
    return best, when


@njit(cache=True)
def tumbled(inertia, inverse, rate, steps, step):
    """(steps + 1, 4) attitudes (xyzw) of a body without torque, by Runge and Kutta's method.

    Args:
        inertia: (3, 3).
        inverse: (3, 3) of it.
        rate: (3,) at the begin, body axes [rad/s].
        steps: their number.
        step: [s].
    """
    out, state = np.empty((steps + 1, 4)), np.zeros(7)
    state[:3], state[6] = rate, 1.0
    slopes, now = np.zeros((4, 7)), np.empty(7)
    out[0] = state[3:]
    for n in range(steps):
        for k in range(4):
            weight = 0.0 if k == 0 else (step if k == 3 else 0.5 * step)
            for i in range(7):
                now[i] = state[i] + weight * slopes[max(k - 1, 0), i]
            u, v, w = now[0], now[1], now[2]
            a, b, c, d = now[3], now[4], now[5], now[6]
            carried, turning = np.zeros(3), np.zeros(3)
            for i in range(3):
                carried[i] = inertia[i, 0] * u + inertia[i, 1] * v + inertia[i, 2] * w
            turning[0] = carried[1] * w - carried[2] * v
            turning[1] = carried[2] * u - carried[0] * w
            turning[2] = carried[0] * v - carried[1] * u
            for i in range(3):
                slopes[k, i] = (
                    inverse[i, 0] * turning[0]
                    + inverse[i, 1] * turning[1]
                    + inverse[i, 2] * turning[2]
                )
            slopes[k, 3] = 0.5 * (d * u + b * w - c * v)
            slopes[k, 4] = 0.5 * (d * v + c * u - a * w)
            slopes[k, 5] = 0.5 * (d * w + a * v - b * u)
            slopes[k, 6] = -0.5 * (a * u + b * v + c * w)
        for i in range(7):
            state[i] += (
                step / 6.0 * (slopes[0, i] + 2.0 * slopes[1, i] + 2.0 * slopes[2, i] + slopes[3, i])
            )
        out[n + 1] = state[3:]
    return out
