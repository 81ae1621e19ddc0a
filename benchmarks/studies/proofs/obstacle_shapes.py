"""Distances to obstacles of every shape: how exact they are, and how long they take.

    python -m benchmarks.studies.proofs.obstacle_shapes

Closed forms are compared with a bounded least-squares programme, or with the hull of all
differences of corners where bodies overlap, and with Coal. Then obstacles of all shapes around a
UR5 satellite grow in number, and a satellite with two thin panels is described by boxes and by
covers of spheres.
"""

import argparse
import time
from pathlib import Path

import coal
import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.nearest_obstacle_kernels import distance_to_solid
from ffsr_plan.robots.collision_shapes import sharpen
from tests.helpers.obstacle_shapes import KINDS, random_shape
from tests.helpers.widened_boxes import RELATIONS, random_pair, signed_distance

PAIRS = [
    ("box", "box"), ("box", "capsule"), ("box", "ball"), ("capsule", "capsule"),
    ("capsule", "ball"), ("ball", "ball"),
]  # fmt: skip
COUNTS = (10, 100, 1_000, 10_000)
EXCESSES = (0.2, 0.1, 0.05)
SPACE = 6.0  # [m] half side of the cube that holds ten obstacles; it grows with their number


def coal_distance(one, other):
    """Coal's signed distance of two widened boxes [m]."""
    solids, frames = [], []
    for each in (one, other):
        if each.skin == 0.0:
            solids.append(coal.Box(*(2.0 * each.halves)))
        elif each.halves[2] == 0.0:
            solids.append(coal.Sphere(each.skin))
        else:
            solids.append(coal.Capsule(each.skin, 2.0 * each.halves[2]))
        frames.append(coal.Transform3s(each.turn, each.middle))
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    sharpen(request)
    return coal.distance(solids[0], frames[0], solids[1], frames[1], request, result)


def exactness(count):
    """One row for each pair of kinds: the largest differences [m]."""
    rows, still = [], np.zeros(3)
    for first, second in PAIRS:
        rng, programme, by_coal = np.random.default_rng(0), 0.0, 0.0
        for k in range(count):
            one, other = random_pair(rng, first, second, RELATIONS[k % len(RELATIONS)])
            kind, frame = one.frame()
            found = distance_to_solid(kind, frame, still, other.solid(), np.inf)
            programme = max(programme, abs(found - signed_distance(one, other)))
            by_coal = max(by_coal, abs(found - coal_distance(one, other)))
        rows.append([f"{first}, {second}", f"{count:,}", f"{programme:.0e}", f"{by_coal:.0e}"])
        print(rows[-1], flush=True)
    return rows


def configurations(robot, rng, count, far):
    """(n, nq) random configurations."""
    return np.array(
        [
            robot.configuration(
                rng.uniform(-far, far, 3),
                rng.uniform(-3.0, 3.0, 3),
                dict(zip(robot.joint_names, rng.uniform(-2.0, 2.0, robot.nd), strict=True)),
            )
            for _ in range(count)
        ]
    )


def microseconds(robot, scene, q):
    """Median time of a configuration's exact clearance [us]."""
    query, times = ObstacleQuery(robot, scene), []
    query.distances(q)
    for _ in range(5):
        begin = time.process_time()
        query.distances(q)
        times.append(time.process_time() - begin)
    return 1e6 * float(np.median(times)) / len(q)


def counted_up(robot):
    """One row for each number of obstacles: times of mixed shapes, closed forms, and spheres."""
    rows = []
    for count in COUNTS:
        rng, far = np.random.default_rng(1), SPACE * (count / 10) ** (1 / 3)
        low, high = np.full(3, -far), np.full(3, far)
        q = configurations(robot, rng, 300, far)
        mixed = [random_shape(rng, KINDS[k % len(KINDS)], low, high) for k in range(count)]
        boxes = [random_shape(rng, ("box", "capsule")[k % 2], low, high) for k in range(count)]
        spheres = fp.Scene(rng.uniform(low, high, (count, 3)), rng.uniform(0.1, 0.6, count))
        scenes = fp.Scene(shapes=mixed), fp.Scene(shapes=boxes), spheres
        rows.append([f"{count:,}", *(f"{microseconds(robot, s, q):.0f} us" for s in scenes)])
        print(rows[-1], flush=True)
    return rows


def satellite(robot):
    """One row for each description of a satellite with two panels of 2 cm."""
    import trimesh

    parts = [
        fp.Box((2.0, 2.0, 2.0), name="bus"),
        fp.Box((2.0, 4.0, 0.02), (0.0, 3.2, 0.0), name="panel"),
        fp.Box((2.0, 4.0, 0.02), (0.0, -3.2, 0.0), name="panel"),
        fp.Box((0.1, 0.2, 0.1), (0.0, 1.1, 0.0), name="yoke"),
        fp.Box((0.1, 0.2, 0.1), (0.0, -1.1, 0.0), name="yoke"),
    ]
    q = configurations(robot, np.random.default_rng(2), 400, 5.0)
    begin = time.process_time()
    exact = fp.Scene(shapes=parts)
    exact.tree  # noqa: B018 - is built
    seconds = time.process_time() - begin
    clear = ObstacleQuery(robot, exact).distances(q)
    rows = [
        ["5 boxes", "5", f"{1e3 * seconds:.1f} ms", "0", f"{microseconds(robot, exact, q):.0f} us"]
    ]
    for excess in EXCESSES:
        begin = time.process_time()
        covers = [
            fp.Scene.from_mesh(trimesh.creation.box(part.size), excess, position=part.position)
            for part in parts
        ]
        cover = sum(covers[1:], covers[0])
        cover.tree  # noqa: B018 - is built
        seconds = time.process_time() - begin
        lost = clear - ObstacleQuery(robot, cover).distances(q)
        rows.append(
            [
                f"spheres, excess {excess:g} m",
                f"{len(cover):,}",
                f"{seconds:.1f} s",
                f"{100 * np.mean(lost[clear > 0.0]):.1f} cm",
                f"{microseconds(robot, cover, q):.0f} us",
            ]
        )
        print(rows[-1], flush=True)
    return rows


def main():
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=100_000, help="of each two kinds")
    parser.add_argument("--out", type=Path, default=RESULTS / "obstacle_shapes.md")
    args = parser.parse_args()
    robot = fp.load_robot("satellite_ur5")
    text = [
        "# Obstacles of every shape",
        "",
        f"`python -m benchmarks.studies.proofs.obstacle_shapes --pairs {args.pairs}`",
        "",
        "## Exactness",
        "",
        "Largest difference [m] of the closed form from a bounded least-squares programme or,",
        "where the bodies overlap, from the hull of all differences of corners; and from Coal.",
        "A seventh of the pairs each lies apart, near, with sides flush, with parallel axes,",
        "nested, in touch, and flat.",
        "",
        table(["pair", "pairs", "programme", "Coal"], exactness(args.pairs)),
        "",
        "## Number",
        "",
        "Time of the exact clearance of a UR5 satellite (15 boxes) at a random configuration,",
        "median of five rounds, processor time. The space grows with the number of obstacles.",
        "",
        table(["obstacles", "all shapes", "boxes and capsules", "spheres"], counted_up(robot)),
        "",
        "## A satellite with two thin panels",
        "",
        "A bus of 2 m with two panels of 2 x 4 x 0.02 m, at 400 random configurations of a UR5",
        "satellite around it.",
        "",
        table(
            ["target", "obstacles", "preparation", "clearance lost, mean", "a configuration"],
            satellite(robot),
        ),
    ]
    publish("\n".join(text) + "\n", args.out)


if __name__ == "__main__":
    main()
