"""All paths of small lattices among bodies that move: edges sampled, costs worked out anew.

What is compared with the package's optima shares kinematics and distances with them, and no proof,
bound, lattice or search.
"""

from __future__ import annotations

from functools import cached_property, lru_cache
from itertools import product

import numpy as np

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.motion import Motion


def time_at(problem, share):
    """The time at which a share of the path has been run, by bisection of the trapezoid law [s]."""
    ramp, low, high = problem.ramp, 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        run = middle - 0.5 * ramp
        if middle < ramp:
            run = middle**2 / (2.0 * ramp)
        elif middle > 1.0 - ramp:
            run = 1.0 - ramp - (1.0 - middle) ** 2 / (2.0 * ramp)
        low, high = (middle, high) if run / (1.0 - ramp) < share else (low, middle)
    return 0.5 * (low + high) * problem.duration


class SampledScene:
    """Distances of configurations to all obstacles of a scene, each at its own time."""

    def __init__(self, robot, scene):
        self._bodies = [*scene.bodies]
        for cloud in scene.debris:  # each sphere is a body of its own
            rows = zip(cloud.centers, cloud.radii, cloud.velocities, strict=True)
            self._bodies += [fp.MovingBody([fp.Ball(r)], fp.Drift(v), c) for c, r, v in rows]
        self._at_rest = ObstacleQuery(robot, scene.at_rest)
        self._each = [
            ObstacleQuery(robot, fp.Scene(shapes=b.shapes, growth=scene.growth))
            for b in self._bodies
        ]

    def distances(self, q, times):
        """(n,) least distances of configurations (n, nq) at times (n,) [m]."""
        found = [self._at_rest.distances(q)]
        for body, query in zip(self._bodies, self._each, strict=True):
            poses, seen = body.poses(times), np.array(q)
            back = rotations.inverse(poses.attitudes)
            seen[:, :3] = rotations.rotate(back, q[:, :3] - poses.positions)
            seen[:, 3:7] = rotations.multiply(back, q[:, 3:7])
            found.append(query.distances(seen))
        return np.min(found, axis=0)


class AllPaths:
    """Every path of a small lattice with a lateral axis alone, with or without progress.

    Attributes:
        closest: least distance from contact of any edge that was looked at [m].
    """

    def __init__(self, problem, samples=160):
        self.problem, self.samples, self.closest = problem, samples, np.inf
        self.lattice, self.m = problem.lattice, problem.lattice.divisions
        self._scene = SampledScene(problem.robot, problem.scene)
        way = problem.goal[:3] / np.linalg.norm(problem.goal[:3])
        self._aside = np.array([way[1], -way[0], 0.0])
        self._least, self._node = lru_cache(None)(self.least), lru_cache(None)(self.node)
        self.steps = self.m if self.lattice.progress is None else self.lattice.progress.steps

    @cached_property
    def _straight(self):
        ends = np.stack([self.problem.start[:3], self.problem.goal[:3]])
        problem = self.problem
        return Motion(problem.robot, problem.mode, problem.start, problem.goal, ends)

    def clearances(self, shares, held, offsets, instants):
        """(n,) distances at shares of the way, of the joints' way, offsets and shares of layers."""
        problem, robot = self.problem, self.problem.robot
        base = problem.start[:3] + shares[:, None] * problem.base_displacement
        base = base + offsets[:, None] * self.lattice.lateral.spacing * self._aside
        joints = robot.joint_values(problem.start) + held[:, None] * problem.joint_displacement
        q = robot.assemble(base, self._straight.attitudes_at(held), joints)
        return self._scene.distances(q, np.array([time_at(problem, each) for each in instants]))

    def node(self, layer, place, offset):
        """Clearance of a node [m]."""
        share = np.array([place / self.steps])
        at = np.array([float(offset)]), np.array([layer / self.m])
        return self.clearances(share, np.clip(share, 0.0, 1.0), *at)[0]

    def least(self, layer, tail, head):
        """Least distance on an edge, whose joints go straight between its ends [m]."""
        t = np.linspace(0.0, 1.0, self.samples + 1)
        shares = np.array([tail[0], head[0]]) / self.steps
        mixed = [(1.0 - t) * a + t * b for a, b in (shares, np.clip(shares, 0.0, 1.0))]
        offsets = (1.0 - t) * tail[1] + t * head[1]
        found = self.clearances(*mixed, offsets, (layer + t) / self.m).min()
        self.closest = min(self.closest, abs(found))
        return found

    def cost(self, tail, head):
        """Length of an edge [m]."""
        problem = self.problem
        turned = np.diff(np.clip([tail[0] / self.steps, head[0] / self.steps], 0.0, 1.0))[0]
        along = (head[0] - tail[0]) / self.steps * np.linalg.norm(problem.base_displacement)
        joints = turned * np.linalg.norm(problem.joint_displacement)
        across = (head[1] - tail[1]) * self.lattice.lateral.spacing
        return np.sqrt(along**2 + joints**2 + (turned * problem.held_rotation) ** 2 + across**2)

    def best(self):
        """F of the best path; infinite where there is none."""
        if self._node(0, 0, 0) <= 0.0 or self._node(self.m, self.steps, 0) <= 0.0:
            return np.inf
        best = np.inf
        for path in self._paths():
            cost = sum(self.cost(*path[k : k + 2]) for k in range(self.m))
            if cost >= best:
                continue
            near = [self._node(k, *path[k]) for k in range(1, self.m)]
            if min(near) <= 0.0:
                continue
            cost += self.problem.delta * sum(1.0 / each for each in near)
            if cost < best and all(self._least(k, *path[k : k + 2]) > 0 for k in range(self.m)):
                best = cost
        return best

    def _paths(self):
        progress, half = self.lattice.progress, self.lattice.lateral.half_count
        offsets, start, goal = range(-half, half + 1), (0, 0), (self.steps, 0)
        if progress is None:
            for inner in product(offsets, repeat=self.m - 1):
                yield (start, *((k + 1, each) for k, each in enumerate(inner)), goal)
            return
        places = range(-progress.before, progress.steps + progress.beyond + 1)
        for inner in product(list(product(places, offsets)), repeat=self.m - 1):
            path = (start, *inner, goal)
            steps = np.abs(np.diff(path, axis=0)).max(axis=0)
            if steps[0] <= progress.most and steps[1] <= progress.aside:
                yield path


def some_body(rng, place, duration):
    """A body of one of four kinds near a place."""
    shapes = [fp.Box(rng.uniform(0.1, 0.5, 3)), fp.Ball(0.1, rng.uniform(-0.3, 0.3, 3))]
    kind, angles = rng.integers(4), rng.uniform(-3.0, 3.0, 3)
    if kind == 0:
        velocity = rng.normal(size=3) * (0.05, 0.05, 0.0)
        return fp.MovingBody(shapes, fp.Drift(velocity), place - 0.5 * duration * velocity, angles)
    if kind == 1:
        return fp.MovingBody(shapes, fp.Spin((0.0, 0.0, rng.uniform(-0.2, 0.2))), place, angles)
    if kind == 2:
        tumble = fp.Tumble((1.0, 1.5, 2.0), rng.normal(size=3) * 0.1, known_until=duration)
        return fp.MovingBody(shapes, tumble, place, angles)
    times = np.linspace(0.0, duration, 5)
    ways = place + np.cumsum(rng.normal(size=(5, 3)) * (0.2, 0.2, 0.0), axis=0)
    track = fp.Track(times, ways, np.tile([0.0, 0.0, 0.0, 1.0], (5, 1)))
    return fp.MovingBody(shapes, track)


def some_debris(rng, far, duration):
    """Four spheres beside the middle of a way of `far` [m], one of them fast."""
    places = far * rng.uniform((0.3, 0.2, -0.02), (0.7, 0.7, 0.02), (4, 3))
    places[:, 1] *= rng.choice([-1.0, 1.0], 4)
    velocities = rng.normal(size=(4, 3)) * (0.006, 0.006, 0.001)
    velocities[0] *= 6.0
    radii = rng.uniform(0.03, 0.1, 4)
    return fp.DebrisCloud(places - 0.5 * duration * velocities, radii, velocities, "shell")


def small_problem(seed, mode="free-flying", waits=False, debris=False):
    """A way of 4 m, with progress 3 m, with bodies or debris in it, on a lattice of few paths."""
    rng, robot, duration = np.random.default_rng(seed), fp.load_robot("planar_dual_arm"), 60.0
    far = 3.0 if waits else 4.0
    bodies = [
        some_body(rng, far * np.array([rng.uniform(0.3, 0.7), rng.uniform(-0.4, 0.4), 0.0]), 60.0)
    ]
    if rng.random() < 0.5:
        bodies.append(some_body(rng, far * np.array([0.5, rng.uniform(-0.5, 0.5), 0.0]), 60.0))
    clouds = [some_debris(rng, far, duration)] if debris else []
    bodies = bodies[:1] if debris and seed % 2 else [] if debris else bodies
    aside = rng.uniform(0.8, 2.4) * rng.choice([-1, 1])
    still = [] if debris else [fp.Box((0.2, 0.2, 1.0), (0.5 * far, aside, 0.0))]
    lattice = fp.Lattice(3, lateral=fp.Axis(2, 0.5))
    if waits:
        most, beyond = int(rng.integers(1, 3)), int(rng.integers(2))
        progress = fp.Progress(2, most=most, before=1, beyond=beyond)
        lattice = fp.Lattice(4, lateral=fp.Axis(1, 0.9), progress=progress)
    return fp.Problem(
        robot,
        fp.Scene(shapes=still, bodies=bodies, debris=clouds),
        start=robot.neutral(),
        goal=robot.configuration((far, 0.0, 0.0), (0.4, 0.0, 0.0), {"left_1": 0.6}),
        mode=mode,
        lattice=lattice,
        delta=0.5,
        duration=duration,
        ramp=float(rng.choice([0.0, 0.25])),
    )


def optimum(problem):
    """F of the package's optimum on the lattice; infinite where it proves that there is none."""
    try:
        return fp.plan(problem, fp.LatticeOptimum(), refine=False).lattice_objective
    except (fp.NoPath, fp.StartInCollision, fp.GoalInCollision):
        return np.inf


def agree(problem):
    """Whether the package's optimum is the best of all paths, and whether there is a path.

    An edge that comes closer than a millimetre to contact may be refused, so that only less than
    the best would be wrong.
    """
    found, paths = optimum(problem), AllPaths(problem)
    best = paths.best()
    if paths.closest < 1e-3:
        return found >= best * (1.0 - 1e-12), np.isfinite(best)
    if np.isinf(best):
        return bool(np.isinf(found)), False
    return abs(found - best) <= 1e-12 * best, True


def main():
    """`python -m benchmarks.studies.moving.all_paths`: 100 problems of each kind, and of debris."""
    kinds = product((False, True), (False, True), ("free-flying", "attitude-held"))
    for debris, waits, mode in kinds:
        results = np.array([agree(small_problem(seed, mode, waits, debris)) for seed in range(50)])
        kind = ("progress" if waits else "fixed pace") + ", debris" * debris
        equal, solved = results.sum(axis=0)
        print(f"{kind}, {mode}: {equal} of 50 equal, {solved} with a path")


if __name__ == "__main__":
    main()
