"""Bounds on the travel of bodies that move against sampled travel.

    python -m benchmarks.studies.moving.body_travel --bodies 5000 --edges 4500

compares `MovingBody.travel` with the sampled paths of points of random bodies, `BodyEdge.travel`
with changes of clearance on random edges at an even pace and with a ramp, and the largest rate of
tumbles with the first maximum that an integration meets, and writes docs/benchmarks/body_travel.md.
It takes about an hour of a core.
"""

import argparse
import textwrap
import warnings
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from itertools import product
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.bodies.pace import Pace
from ffsr_plan.collision.body_distances import BodyDistances
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.body_edge import BodyEdge
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.motion_edges import NominalPlacements

KINDS = ("Drift", "Spin", "Tumble", "Track")
INTERVALS, SAMPLES, HORIZON = 200, 24, 300.0  # of a body; chords of an interval; [s]
HALVINGS = 7  # of an edge
_EDGES_AT_ONCE = 20
DISTANCE_ERROR = 1e-8  # [m] of two clearances


def random_inertia(rng):
    """A tensor of inertia of an ellipsoid in random axes, some of it flat or long."""
    squares = 10.0 ** rng.uniform(-2.0, 0.0, 3)
    moments = squares.sum() - squares
    turn = Rotation.random(rng=rng).as_matrix()
    return turn @ np.diag(moments) @ turn.T


def random_shapes(rng):
    """One to three boxes, balls and capsules."""
    shapes = []
    for kind in rng.integers(3, size=rng.integers(1, 4)):
        place = rng.normal(size=3) * rng.choice([0.0, 0.5])
        angles = rng.uniform(-3.0, 3.0, 3)
        if kind == 0:
            shapes.append(fp.Box(rng.uniform(0.02, 2.0, 3), place, angles))
        elif kind == 1:
            shapes.append(fp.Ball(rng.uniform(0.05, 0.5), place))
        else:
            shapes.append(fp.Capsule(rng.uniform(0.05, 0.3), rng.uniform(0.1, 2.0), place, angles))
    return shapes


def random_body(rng, kind, place=(0.0, 0.0, 0.0), horizon=HORIZON):
    """A random body that moves, known until the horizon [s]."""
    shapes, size = random_shapes(rng), 10.0 ** rng.uniform(-3.0, -0.5)
    velocity = rng.normal(size=3) * 10.0 ** rng.uniform(-3.0, -0.5) * rng.integers(2)
    angles = rng.uniform(-3.0, 3.0, 3)
    if kind == "Drift":
        return fp.MovingBody(shapes, fp.Drift(rng.normal(size=3) * size), place, angles)
    if kind == "Spin":
        return fp.MovingBody(shapes, fp.Spin(rng.normal(size=3) * size, velocity), place, angles)
    if kind == "Tumble":
        motion = fp.Tumble(random_inertia(rng), rng.normal(size=3) * size, velocity, horizon)
        return fp.MovingBody(shapes, motion, place, angles)
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 12.0, 300))])
    times = times[: np.searchsorted(times, horizon) + 1]
    places = place + np.cumsum(rng.normal(size=(len(times), 3)), axis=0) * size
    turns, now = [], Rotation.random(rng=rng)
    vectors = rng.normal(size=(len(times), 3)) * rng.choice([0.0, 0.1, 0.3])
    for vector in vectors:
        size = max(1.0, np.linalg.norm(vector) / 1.5)  # turns of a row stay below 90 degrees
        now = now * Rotation.from_rotvec(vector / size)
        turns.append(now.as_quat())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fp.WideTurns)
        return fp.MovingBody(shapes, fp.Track(times, places, np.array(turns)))


def points_of(body):
    """(k, 3) points on a body's surface, the farthest from its reference point and axis among them.

    Corners of boxes; of balls and of the ends of capsules the farthest points and six others.
    """
    axis, found = body.motion.axis, []
    for shape in body.shapes:
        place = np.asarray(shape.position)
        if isinstance(shape, fp.Ball):
            middles, radius = place[None], shape.radius
        else:
            axes = Rotation.from_quat(np.array(shape.attitude)).as_matrix()
            if isinstance(shape, fp.Box):
                signs = np.stack(np.meshgrid(*[(-0.5, 0.5)] * 3), axis=-1).reshape(-1, 3)
                found.append(place + (signs * np.asarray(shape.size)) @ axes.T)
                continue
            half = 0.5 * shape.length * axes[:, 2]
            middles, radius = np.stack([place - half, place + half]), shape.radius
        outwards = middles if axis is None else middles - (middles @ axis)[:, None] * axis
        sizes = np.linalg.norm(outwards, axis=1, keepdims=True)
        ways = [
            outwards / np.where(sizes > 0.0, sizes, 1.0),
            *np.concatenate([np.eye(3), -np.eye(3)]),
        ]
        found += [middles + radius * way for way in ways]
    return np.concatenate(found)


def shares_travelled(body, begins, ends, samples=SAMPLES):
    """(n,) longest sampled path of a point of the body over the bound, for n intervals of time.

    Chords are not longer than the path, so that a share above 1 refutes the bound.
    """
    bounds = np.array([body.travel(a, b) for a, b in zip(begins, ends, strict=True)])
    share = np.linspace(0.0, 1.0, samples + 1)
    times = begins[:, None] + share * (ends - begins)[:, None]
    poses = body.poses(np.clip(times.ravel(), 0.0, body.motion.known_until))
    turns = Rotation.from_quat(np.array(poses.attitudes)).as_matrix()
    tracks = np.asarray(poses.positions)[:, None] + points_of(body) @ turns.transpose(0, 2, 1)
    tracks = tracks.reshape(len(begins), samples + 1, -1, 3)
    ways = np.linalg.norm(np.diff(tracks, axis=1), axis=3).sum(axis=1).max(axis=1)
    # a body at rest has neither path nor bound; 1e-13 m are the rounding of the positions
    return np.maximum(ways - 1e-13 * samples, 0.0) / np.maximum(bounds, 1e-300)


def body_shares(rng, kind, intervals=INTERVALS):
    """Shares of the bound on random intervals of a random body; see `shares_travelled`."""
    body = random_body(rng, kind)
    spans = 10.0 ** rng.uniform(-2.0, 2.0, intervals)
    begins = rng.uniform(0.0, HORIZON - spans)
    return shares_travelled(body, begins, begins + spans)


@cache
def the_robot():
    """The robot of all edges, loaded once."""
    return fp.load_robot("planar_dual_arm")


def edge_shares(rng, kind, ramp, halvings=HALVINGS):
    """Changes of clearance on a random edge past a random body over the bound on both travels.

    Of all intervals that proofs come to by halving the edge so often.
    """
    robot, duration, edges = the_robot(), 200.0, 20
    ends = []
    for _ in range(2):
        joints = dict(zip(robot.joint_names, rng.uniform(-0.6, 0.6, robot.nd), strict=True))
        ends.append(robot.configuration(rng.normal(size=3) * 0.5, joints=joints))
    positions = np.stack([end[:3] for end in ends])
    motion = Motion(robot, "free-flying", *ends, positions)
    body = random_body(rng, kind, rng.normal(size=3) * 2.5, duration)
    slot = int(rng.choice([0, edges - 1, rng.integers(edges)]))
    offsets = rng.normal(size=(2, 3)) * 0.3
    step = positions[1] - positions[0] + offsets[1] - offsets[0]
    query, pace = ObstacleQuery(robot, fp.Scene(shapes=body.shapes)), Pace(duration, ramp, edges)
    edge = BodyEdge(
        body, query, NominalPlacements(motion), EdgeTravel(motion), 0, tuple(offsets), step, pace,
        0.0, slot,
    )  # fmt: skip
    count = 2**halvings
    places = np.arange(count + 1) / count
    placed = shape_placements(robot, motion.at(np.zeros(count + 1, dtype=np.int64), places))
    seen = BodyDistances(robot, query, placed, body.poses(pace.instants(slot + places)))
    shifts = (1.0 - places)[:, None] * offsets[0] + places[:, None] * offsets[1]
    clearances, shares = seen.distances(np.arange(count + 1), shifts), []
    for length in 2 ** np.arange(halvings + 1):
        found = clearances[::length]
        change, clear = np.abs(np.diff(found)), np.minimum(found[:-1], found[1:]) > 0.0
        for k in np.flatnonzero(clear).tolist():  # depths are not the distances that proofs use
            bound = float(np.max(edge.travel(k * length / count, (k + 1) * length / count)))
            shares.append(change[k] / (bound + DISTANCE_ERROR))
    return shares


def many_shares(seed, kind, ramp, edges):
    """The same of some random edges."""
    rng = np.random.default_rng([seed, KINDS.index(kind), int(ramp > 0.0)])
    return np.array([share for _ in range(edges) for share in edge_shares(rng, kind, ramp)])


def rate_share(rng):
    """The first maximum of |w| that a tumble meets over `largest_rate`; 0 where it meets none.

    A maximum is where w . w' falls through zero. SciPy's integrator finds it between its steps.
    """
    inertia, rate = random_inertia(rng), rng.normal(size=3) * 0.05
    inverse, size = np.linalg.inv(inertia), np.linalg.norm(rate)

    def slope(_, w):
        return inverse @ np.cross(inertia @ w, w)

    def rises(time, w):
        return w @ slope(time, w)

    rises.direction, rises.terminal = -1.0, True
    end = 400.0 / size
    found = solve_ivp(
        slope, (0.0, end), rate, "DOP853", events=rises, rtol=1e-13, atol=1e-15, max_step=0.1 / size
    )
    largest = fp.Tumble(inertia, rate, known_until=1.0).largest_rate
    seen = np.linalg.norm(found.y, axis=0).max()
    if not len(found.y_events[0]):
        return 0.0, float(seen / largest)
    peak = float(np.linalg.norm(found.y_events[0][0]))
    return peak / largest, float(max(seen, peak) / largest)


def _row(name, shares):
    """A row of quantiles of shares."""
    middle, high = np.quantile(shares, (0.5, 0.95))
    above = int(np.sum(shares > 1.0))
    return [
        name,
        f"{len(shares):,}",
        str(above),
        f"{middle:.4f}",
        f"{high:.4f}",
        f"{shares.max():.9f}",
    ]


def paragraph(text):
    """Text in lines of at most 120 characters."""
    return textwrap.fill(text, 120, break_long_words=False, break_on_hyphens=False)


def report(of_bodies, of_edges, of_rates, options):
    """The page: shares by kind, by (kind, ramp), and pairs of `rate_share`."""
    rates = np.array(of_rates)
    met = rates[rates[:, 0] > 0.0, 0]
    every = [*of_bodies.values(), *of_edges.values()]
    above = sum(int(np.sum(shares > 1.0)) for shares in every)
    heads = ["intervals", "above 1", "median", "95 %", "largest"]
    bodies = [_row(kind, shares) for kind, shares in of_bodies.items()]
    edges = [
        _row(f"{kind}, {'even' if ramp == 0.0 else f'ramp {ramp:g}'}", shares)
        for (kind, ramp), shares in of_edges.items()
    ]
    intervals = sum(map(len, every))
    parts = [
        "# Travel of bodies that move",
        f"    python -m benchmarks.studies.moving.body_travel{options}",
        paragraph(
            f"**{above} violations** on {intervals:,} intervals. Random bodies of one to three "
            "boxes, balls and capsules, rates of 0.001 to 0.3 rad/s, inertias from flat to "
            "long, tables with rows of 0.5 to 12 s. [Derivation](../proof.md#bodies-that-move)."
        ),
        "## Points of bodies",
        paragraph(
            f"The longest path of a body's outermost points, as {SAMPLES} chords, over "
            f"`MovingBody.travel`, on {INTERVALS} intervals of 0.01 to 100 s of each body. "
            "Chords are shorter than the path, by much where a body turns far between them."
        ),
        table(["motion", *heads], bodies),
        "## Clearances on edges",
        paragraph(
            "The change of clearance over an interval of an edge over `BodyEdge.travel`, robot and "
            f"body together, on all intervals that {HALVINGS} halvings of an edge come to; each "
            "edge of a path of 20 edges and 200 s has a motion and a body of its own. Errors of "
            f"the distances, {DISTANCE_ERROR:g} m, are added to the bound."
        ),
        table(["motion, pace", *heads], edges),
        "## Rates of tumbles",
        paragraph(
            f"Of {len(rates):,} random tumbles {len(met):,} pass the maximum of their rate "
            "within 400 rad. The rate there, by SciPy's integrator, over `Tumble.largest_rate` "
            f"differs from 1 by {np.abs(met - 1.0).max():.1e} at most. No rate that was met is "
            f"above it by more than {max(rates[:, 1].max() - 1.0, 0.0):.1e}, relative."
        ),
    ]
    return "\n\n".join(parts) + "\n"


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--bodies", type=int, default=5000, help="of each motion")
    parser.add_argument("--edges", type=int, default=4500, help="of each motion and pace")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--tumbles", type=int, default=1000, help="whose rate is followed")
    parser.add_argument("--out", type=Path, default=RESULTS / "body_travel.md")
    args = parser.parse_args()
    rng = np.random.default_rng(0)
    of_bodies, of_edges = {}, {}
    for kind in KINDS:
        of_bodies[kind] = np.concatenate([body_shares(rng, kind) for _ in range(args.bodies)])
        print(kind, of_bodies[kind].max(), flush=True)
    some = range(-(-args.edges // _EDGES_AT_ONCE))
    with ProcessPoolExecutor(args.workers) as pool:
        for kind, ramp in product(KINDS, (0.0, 0.2)):
            look = partial(many_shares, kind=kind, ramp=ramp, edges=_EDGES_AT_ONCE)
            of_edges[kind, ramp] = np.concatenate(list(pool.map(look, some)))
            print(kind, ramp, of_edges[kind, ramp].max(), flush=True)
    of_rates = [rate_share(rng) for _ in range(args.tumbles)]
    options = f" --bodies {args.bodies} --edges {args.edges} --tumbles {args.tumbles}"
    publish(report(of_bodies, of_edges, of_rates, options), args.out)


if __name__ == "__main__":
    main()
