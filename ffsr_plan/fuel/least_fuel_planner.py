"""`LeastFuel`: the planner of paths that need little change of velocity at a given clearance."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any, ClassVar, NamedTuple

import numpy as np

from ffsr_plan.collision.contacts import named
from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.errors import InvalidInput, NoPath, OutOfTime, UnprovenPath
from ffsr_plan.core.setting_rules import Number, WholeNumber
from ffsr_plan.core.settings import settings
from ffsr_plan.fuel.lattice_search import LeastChange, least_change_path
from ffsr_plan.fuel.pair_programme import BYTES_PER_EDGE
from ffsr_plan.fuel.refinement import BestRefined, FuelRefinement, RefinedOffsets, best_refined
from ffsr_plan.lattice.certificate import Certificate, Counts, proven_clearance
from ffsr_plan.lattice.optimum import lattice_optimum
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.problem.lattice_settings import Axis, Lattice
from ffsr_plan.problem.memory_estimate import check_lattice
from ffsr_plan.problem.objective import objective, path_length
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.prover import Prover
from ffsr_plan.scene.scene import Scene
from ffsr_plan.search.fuel_figures import FuelFigures
from ffsr_plan.search.records import History, SearchRequest, Solution, Trails
from ffsr_plan.time_limit.deadline import Deadline

_OFFSETS = {1: 60, 2: 10}  # to either side, by number of axes
STARTS = _PAIRS, _OPTIMUM = "pair-programme", "lattice-optimum"
"""What a motion is refined from."""


class _Found(NamedTuple):
    """The best refined path, the path on the planner's lattice, and edges and queries spent."""

    best: BestRefined
    on_lattice: LeastChange | None
    counts: Counts


@settings
class LeastFuel:
    """Little change of velocity, and so little fuel, past the obstacles at a given clearance.

    Layers lie at equal times, and the nodes of the plan are the control points of a smooth curve,
    `plan.smooth()`. The planner looks for the best path on a lattice of few layers, which is exact
    there, and refines it and the optimum of F from the problem's lattice by their lateral offsets
    on all layers of the problem's lattice; the better one is returned. Every edge keeps the margin,
    proven. Where a time limit ends the refinement, the path of few layers is returned as it is, if
    their corners are on layers of the problem's lattice. `plan.fuel` has its figures. F and L of
    the plan are those of its motion; `optimum` and `lattice_objective` are those of the problem's
    lattice, whose optimum `nodes` holds.

    Attributes:
        margin: clearance that is kept beyond the problem's `min_clearance` [m]; less than that of
            start and goal.
        layers: edges of a path on the planner's own lattice: few, so that slopes come in fine
            steps.
        spacing: distance between two offsets on it [m]; by default a sixtieth of the reach of the
            problem's lattice to either side, or with two axes a tenth.
    """

    margin: Annotated[float, Number(at_least=0.0, at_most=1e6)] = 0.02
    layers: Annotated[int, WholeNumber(at_least=2, at_most=1000)] = 10
    spacing: Annotated[float, Number(at_least=1e-9, at_most=1e6)] | None = None

    name: ClassVar[str] = "least-fuel"
    exact: ClassVar[bool] = True

    def refuse(self, problem: Problem) -> None:
        """Raise `InvalidInput` if the planner cannot solve the problem, naming what it needs."""
        lattice = problem.lattice
        if lattice is None:
            allowed = "a problem with a lattice, whose layers are the control points"
        elif lattice.progress is not None:
            allowed = "a lattice without progress: a robot that waits has no fixed pace"
        elif lattice.postures:
            allowed = "a lattice without posture axes: all nodes of a layer have the same joints"
        elif problem.mode.floats:
            allowed = "a mode with thrusters, free-flying or attitude-held: no fuel is burnt here"
        elif not lattice.axes:
            allowed = "a base that moves, and a lattice with a lateral or normal axis"
        elif problem.scene.moves:
            allowed = (
                "a scene at rest: its curves have no pace at which bodies that move are passed"
            )
        else:
            return
        raise InvalidInput("planner", self.name, allowed)

    def solve(self, problem: Problem, rng: np.random.Generator, request: SearchRequest) -> Solution:
        """Look for a path of little change of velocity and certify it.

        Args:
            problem: a problem on a lattice with thrusters and without posture axes.
            rng: not used: the same problem gives the same path.
            request: callback and stopping condition; refinement is part of the planner.

        Raises:
            InvalidInput: another problem, `refine=False`, or a margin that start or goal lack.
            StartInCollision, GoalInCollision: with link, obstacle and depth.
            NoPath: the problem's lattice holds no free path, or the planner's none with the margin.
            OutOfTime: no path with the margin was proven in time.
            PathNotFound: none was found.
        """
        self.refuse(problem)
        if request.refine is False:
            allowed = f"None or True with {self.name}, whose paths lie off the lattice"
            raise InvalidInput("refine", False, allowed)
        coarse = self._own_lattice(problem)
        deadline = request.deadline or Deadline()
        roadmap = Roadmap(problem, deadline)
        self._check_margin(roadmap)
        deadline.stage = "the search for a path"
        nodes = lattice_optimum(roadmap)
        request.begin()
        found = self._found(roadmap, nodes, coarse)
        return self._solution(roadmap, nodes, found)

    def _own_lattice(self, problem: Problem) -> Problem:
        """The problem on the planner's lattice, its obstacles larger by the margin."""
        given = problem.given_lattice
        axes: dict[str, Any] = {}
        for name in given.axes:
            axis = getattr(given, name)
            reach, most = axis.half_count * axis.spacing, _OFFSETS[len(given.axes)]
            spacing = reach / most if self.spacing is None else self.spacing
            axes[name] = Axis(max(1, int(reach / spacing + 1e-9)), min(spacing, reach))
        wider = replace(
            problem,
            lattice=Lattice(self.layers, **axes),
            min_clearance=problem.min_clearance + self.margin,
        )
        try:
            check_lattice(wider, BYTES_PER_EDGE)
        except InvalidInput as error:
            what = f"planner {self.name}, layers and spacing"
            allowed = f"{error.allowed}: fewer layers or a larger spacing"
            raise InvalidInput(what, (self.layers, self.spacing), allowed) from None
        return wider

    def _check_margin(self, roadmap: Roadmap) -> None:
        """Raise `InvalidInput` where start or goal lack the margin."""
        origin = roadmap.lattice.origin
        for layer, end in ((0, "start"), (-1, "goal")):
            clearance = float(roadmap.nodes.bounds[layer, origin])
            if clearance <= self.margin:
                allowed = f"less than {clearance:.6g} m, the clearance of the {end}"
                raise InvalidInput(f"planner {self.name}, margin", self.margin, allowed)

    def _found(self, roadmap: Roadmap, nodes: IntArray, coarse: Problem) -> _Found:
        """The better of the paths refined from the planner's lattice and from the optimum of F."""
        lattice, deadline = roadmap.lattice, roadmap.deadline
        own = Roadmap(coarse, deadline)
        on_lattice: LeastChange | None = None
        starts, no_path = {}, None
        try:
            on_lattice = least_change_path(own)
            starts[_PAIRS] = _on_layers(own.lattice.offsets[on_lattice.nodes], lattice.divisions)
        except NoPath as error:
            no_path = error
        starts[_OPTIMUM] = lattice.offsets[nodes]
        deadline.stage = "the refinement of a path"
        grown = coarse.obstacles
        prover = Prover(lattice.nominal, grown, roadmap.problem.tolerance, deadline)
        refinement = FuelRefinement(lattice, prover, grown, deadline)
        try:
            best = best_refined(refinement, starts)
        except OutOfTime:
            if on_lattice is None or lattice.divisions % self.layers:
                raise
            path = RefinedOffsets(starts[_PAIRS], on_lattice.change)
            best = BestRefined(_PAIRS, path, cut_short=True)
        if best is None:
            raise no_path or _unproven(refinement, coarse.obstacles, lattice.divisions)
        counts = roadmap.counts().plus(own.counts()).plus(refinement.counts())
        return _Found(best, on_lattice, counts)

    def _solution(self, roadmap: Roadmap, nodes: IntArray, found: _Found) -> Solution:
        problem, lattice, deadline = roadmap.problem, roadmap.lattice, roadmap.deadline
        (start, path, cut_short), on_lattice = found.best, found.on_lattice
        offsets = path.offsets
        deadline.close()
        clearances = roadmap.prover.clearances(np.arange(lattice.divisions + 1), offsets)
        least, cut = proven_clearance(roadmap.prover, offsets, clearances)
        length, optimum = path_length(problem, offsets), roadmap.objective(nodes)
        figures = FuelFigures(
            change=path.change,
            straight=2.0 * float(np.linalg.norm(problem.base_displacement)),
            lattice_change=None if on_lattice is None else on_lattice.change,
            lattice_bound=None if on_lattice is None else on_lattice.bound,
            margin=self.margin,
            start=start,
        )
        indices = lattice.indices[nodes]
        return Solution(
            lattice=lattice,
            motion=lattice.nominal.displaced(offsets),
            nodes=frozen(indices if indices.shape[1] > 1 else indices.sum(axis=1)),
            length=length,
            objective=objective(problem, length, clearances),
            lattice_objective=optimum,
            optimum=optimum,
            optimum_is_exact=True,
            clearances=frozen(clearances),
            history=History.of_rows(np.array([[optimum, optimum, optimum, 1.0]])),
            trails=Trails.none(),
            certificate=Certificate(
                *found.counts, max(least, self.margin), problem.robot.unchecked_links
            ),
            interrupted=cut or cut_short or bool(figures.gap),
            fuel=figures,
        )


def _unproven(refinement: FuelRefinement, scene: Scene, divisions: int) -> UnprovenPath:
    """The error that names what came too close on the edge that was refused last."""
    assert refinement.nearest is not None
    layer, near = refinement.nearest
    contact = named(scene, near)
    advice = ("a smaller margin", "more layers or a smaller spacing")
    return UnprovenPath(
        layer + 1, near.link, near.obstacle, near.distance, divisions, contact.source, advice
    )


def _on_layers(offsets: Array, divisions: int) -> Array:
    """Offsets (k + 1, 3) of a path on `divisions` layers, linear in between."""
    own = np.linspace(0.0, 1.0, len(offsets))
    layers = np.linspace(0.0, 1.0, divisions + 1)
    return np.stack([np.interp(layers, own, column) for column in offsets.T], axis=1)
