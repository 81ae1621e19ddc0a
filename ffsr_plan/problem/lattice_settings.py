"""Settings of a lattice: the number of layers, and the axes along which nodes are displaced."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from ffsr_plan.core.setting_rules import ByKey, Number, WholeNumber
from ffsr_plan.core.settings import Given, setting, settings
from ffsr_plan.problem.posture_axes import PostureAxis, PostureTarget

AnyPostureAxis = PostureAxis | PostureTarget


@settings
class Axis:
    """Offsets -n h, .., 0, .., n h along one direction: 2 n + 1 of them.

    Attributes:
        half_count: n, at least 1 (the paper's n_ac).
        spacing: h [m], greater than 0.
    """

    half_count: Annotated[int, WholeNumber(at_least=1)]
    spacing: Annotated[float, Number(at_least=1e-9, at_most=1e6)]


@settings
class Progress:
    """Progress along the way as part of a node: the robot may wait, go back, and start afresh.

    A layer is then an instant, and a node a place on the way with an offset. From layer to layer
    the robot makes a few steps of progress, forwards, none or back, and of each offset.

    Attributes:
        steps: number of steps of progress from start to goal.
        most: steps of progress from layer to layer at most.
        aside: steps along each axis of offsets from layer to layer at most.
        before: steps by which it may go back behind the start; joints rest there.
        beyond: steps by which it may go beyond the goal; joints rest there.
    """

    steps: Annotated[int, WholeNumber(at_least=1, at_most=1000)] = 20
    most: Annotated[int, WholeNumber(at_least=1, at_most=10)] = 1
    aside: Annotated[int, WholeNumber(at_least=0, at_most=100)] = 1
    before: Annotated[int, WholeNumber(at_least=0, at_most=1000)] = 0
    beyond: Annotated[int, WholeNumber(at_least=0, at_most=1000)] = 0


@settings
class Lattice:
    """Layers 0 .. m between start and goal, with nodes offset across the direction of motion.

    Attributes:
        divisions: m, at least 2; 40 in the paper.
        lateral: offsets along x' of the path frame (the paper's), or None.
        normal: offsets along y' of the path frame, for three-dimensional scenes, or None.
        postures: displacements of the joints.
        progress: makes layers instants, between which the robot may wait and go back; None for one
            step forwards from layer to layer.
    """

    divisions: Annotated[int, WholeNumber(at_least=2)] = 40
    lateral: Axis | None = None
    normal: Axis | None = None
    postures: Given[
        tuple[Annotated[AnyPostureAxis, ByKey(joints=PostureAxis, towards=PostureTarget)], ...],
        Sequence[AnyPostureAxis],
    ] = setting(default=())
    progress: Progress | None = None

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the axes along which the base is offset, in the order of node indices."""
        return tuple(name for name in ("lateral", "normal") if getattr(self, name) is not None)

    @property
    def summary(self) -> str:
        """Divisions and axes, in a few words."""
        axes = [*self.axes, *(f"posture {k}" for k, _ in enumerate(self.postures))]
        axes += ["progress"] if self.progress is not None else []
        across = f", axes {', '.join(axes)}" if axes else ""
        return f"{self.divisions} divisions{across}"
