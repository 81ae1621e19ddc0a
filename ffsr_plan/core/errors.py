"""Exceptions."""
# ruff: noqa: N818 - the names are part of the public contract

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, ClassVar

from ffsr_plan.core.contacts import (
    Contact,
    closing_obstacles,
    contact_list,
    encounter,
    obstacle_name,
)
from ffsr_plan.core.formatting import on_one_line, shortened


class FfsrPlanError(Exception):
    """Root of all errors that ffsr-plan raises on purpose.

    A subclass that is a dataclass holds its constructor arguments as attributes, composes the
    message from them in `message`, and is pickled by them.
    """

    def message(self) -> str:
        """The text of the error."""
        return super().__str__()

    def __str__(self) -> str:
        return self.message()

    def __reduce__(self) -> tuple[object, ...]:
        if not is_dataclass(self):
            return super().__reduce__()  # type: ignore[return-value]
        return type(self), tuple(getattr(self, f.name) for f in fields(self) if f.init)


@dataclass(eq=False, repr=False)
class InvalidInput(FfsrPlanError, ValueError):
    """A value that cannot be used.

    Attributes:
        what: the field or argument, as the user wrote it.
        value: the offending value.
        allowed: what would have been accepted.
    """

    what: str
    value: object
    allowed: str

    def message(self) -> str:
        """What is wrong, the value and what is allowed, on one line."""
        what, allowed = on_one_line(self.what), on_one_line(self.allowed)
        return f"{what}: got {shortened(self.value)}; allowed: {allowed}"


class WideTurns(UserWarning):
    """A table of attitudes turns so far from row to row that another way may be meant."""


class UncheckedLinks(UserWarning):
    """A robot has links with mass but no shape, which nothing keeps clear of obstacles."""


class GoalPoseIgnored(UserWarning):
    """The goal's base pose is not demanded in this mode, and the plan ends at another one."""


class NearDynamicSingularity(UserWarning):
    """A floating robot can hardly move a frame in some direction from where it arrives."""


class PlanningError(FfsrPlanError):
    """The input is valid, but no plan exists or none was found."""


@dataclass(eq=False, repr=False)
class InternalError(FfsrPlanError):
    """An invariant of ffsr-plan is broken; not the user's fault.

    Attributes:
        detail: which invariant, and the values at hand.
    """

    detail: str

    def message(self) -> str:
        """The detail, with the request to report it."""
        return f"internal error: {self.detail}; please report it"


class IntegrationError(FfsrPlanError):
    """A numerical integration did not converge."""


@dataclass(eq=False, repr=False)
class _InCollision(PlanningError):
    """A prescribed configuration is in collision."""

    configuration: ClassVar[str]

    link: str
    obstacle: int | str | None
    depth: float
    contacts: tuple[Contact, ...] = ()
    goal_contacts: tuple[Contact, ...] = ()
    advice: tuple[str, ...] = ()

    def message(self) -> str:
        """All that touches, how deep, and what may help."""
        contacts = self.contacts or (Contact(self.link, self.obstacle, self.depth),)
        text = f"{self.configuration} in collision: {contact_list(contacts)}"
        if self.goal_contacts:
            text += f"; the goal is in collision too: {contact_list(self.goal_contacts)}"
        return text + helping(self.advice)


class StartInCollision(_InCollision):
    """The start configuration touches an obstacle or the robot itself.

    Attributes:
        link: name of the link in the deepest collision.
        obstacle: index of the sphere in the scene, or name of the other link.
        depth: penetration depth [m], zero in contact.
        contacts: all links and obstacles that touch, the deepest first.
        goal_contacts: those of the goal, if it is in collision as well.
        advice: what may help.
    """

    configuration = "start"


class GoalInCollision(_InCollision):
    """The goal configuration, at the attitude that results there, touches something.

    Attributes:
        link: name of the link in the deepest collision.
        obstacle: index of the sphere in the scene, or name of the other link.
        depth: penetration depth [m], zero in contact.
        contacts: all links and obstacles that touch, the deepest first.
        goal_contacts: empty.
        advice: what may help.
    """

    configuration = "goal"


@dataclass(eq=False, repr=False)
class NoPath(PlanningError):
    """The lattice contains no free path; this is proven.

    Attributes:
        layer: the first layer of which no node can be reached.
        obstacles: what closes the layer: indices of spheres in the scene and, for self-collision,
            names of links.
        divisions: number of divisions of the lattice; its layers are 0 .. divisions.
        contacts: the same with the links that meet the obstacles.
        advice: what may help on this lattice.
    """

    layer: int
    obstacles: tuple[int | str, ...]
    divisions: int
    contacts: tuple[Contact, ...] = ()
    advice: tuple[str, ...] = ()

    def message(self) -> str:
        """The layer, what closes it, and what may help."""
        spheres = [o for o in self.obstacles if isinstance(o, int)]
        links = ", ".join(f"'{o}'" for o in self.obstacles if isinstance(o, str))
        touching = f"self-collision of {links}" if links else ""
        causes = filter(None, (closing_obstacles(self.contacts, spheres), touching))
        return (
            f"no path on this lattice: layer {self.layer} of {self.divisions} cannot be passed "
            f"(closed by {' and '.join(causes) or 'the limits of the lattice'})"
            + helping(self.advice or ("wider or additional lattice axes",))
        )


@dataclass(eq=False, repr=False)
class AttitudeOutOfReach(PlanningError):
    """No joint path was found that rotates the base to the attitude of the goal.

    Attributes:
        wanted: angle from the start attitude to the goal attitude [rad].
        missed: angle from the attitude reached to the goal attitude [rad].
        best: the `Plan` that misses it so, proven free all the same; None without one.
        turned: the part of `wanted` that was reached, wanted - missed, at least 0 [rad].
    """

    wanted: float
    missed: float
    best: Any = None
    turned: float = field(init=False)

    def __post_init__(self) -> None:
        self.turned = max(0.0, self.wanted - self.missed)

    def message(self) -> str:
        """All three angles in degrees, and which settings may help."""
        longer = "a longer time_limit, " if getattr(self.best, "interrupted", False) else ""
        return (
            f"goal attitude out of reach: the best joint path rotates the base by "
            f"{math.degrees(self.turned):.1f} of {math.degrees(self.wanted):.1f} degrees and "
            f"misses the goal by {math.degrees(self.missed):.2g} degrees; {longer}more divisions, "
            "wider or more posture axes, or another seed may help"
        )


@dataclass(eq=False, repr=False)
class OutOfTime(PlanningError):
    """The time limit passed before any path was proven free; this does not prove that none exists.

    Attributes:
        time_limit: [s]; infinite where Ctrl-C ended the planning.
        stage: what it ended.
        advice: what may help.
    """

    time_limit: float
    stage: str
    advice: tuple[str, ...] = ("a longer time_limit", "fewer divisions, offsets or postures")

    def message(self) -> str:
        """The limit, what it ended, and what may help."""
        end = (
            "Ctrl-C" if math.isinf(self.time_limit) else f"the time_limit of {self.time_limit:g} s"
        )
        return f"no path was proven free before {end} ended {self.stage}" + helping(self.advice)


@dataclass(eq=False, repr=False)
class UnprovenPath(PlanningError):
    """The path of the colony could not be proven free; this does not prove that none exists.

    Attributes:
        layer: the first layer that could not be reached.
        link: name of the link that comes too close.
        obstacle: index of the sphere, or name of the other link; None in an empty scene.
        distance: least distance measured [m], negative in penetration.
        divisions: number of divisions of the lattice; its layers are 0 .. divisions.
        source: what the sphere comes from, such as the name of a mesh; empty where that is unknown.
        advice: what may help on this lattice.
    """

    layer: int
    link: str
    obstacle: int | str | None
    distance: float
    divisions: int
    source: str = ""
    advice: tuple[str, ...] = ()

    def message(self) -> str:
        """Where the proof fails, and which settings may help."""
        return (
            f"no path was found that could be proven free: between layers {self.layer - 1} and "
            f"{self.layer} of {self.divisions}, link '{self.link}' "
            f"{encounter(self.distance, self.obstacle, self.source)}"
            + helping(self.advice or ("other posture axes",))
        )


@dataclass(eq=False, repr=False)
class UnprovenCurve(PlanningError):
    """No smooth curve along a plan could be proven free, not even its path at rest at every bend.

    Attributes:
        edge: the first edge of the path that was refused, from 1 on.
        edges: their number.
        contact: the nearest pair in its middle; its depth is negative apart.
        time: when the path is there [s]; None without bodies that move.
    """

    edge: int
    edges: int
    contact: Contact
    time: float | None = None

    def message(self) -> str:
        """Where the proof fails, and what may help."""
        link, obstacle, depth, source = self.contact
        when = "" if self.time is None else f" at {self.time:.4g} s"
        return (
            f"no smooth curve could be proven free: on edge {self.edge} of {self.edges}, link "
            f"'{link}' {encounter(-depth, obstacle, source)}{when}; what may help: a plan with "
            "more clearance, by min_clearance or a larger delta"
        )


@dataclass(eq=False, repr=False)
class PathNotFound(PlanningError):
    """No path was found without a lattice; this does not prove that none exists.

    Attributes:
        seconds: time that was spent [s].
        tries: number of searches by trees.
        nodes: nodes of all trees.
        meetings: how often a tree from the start met one from the goal.
        refused: paths that could not be proven free.
        apart: least distance of the last two trees, in which 0.6 m count as a radian [m].
        contact: what is in the way there, if anything.
        advice: what may help.
        attitude_missed: least angle by which a path to the goal missed the attitude that is
            demanded there [rad]; None without such a path.
        on_lattice: what a planner on a lattice said that found no path either; empty without one.
        enclosed: `start` or `goal` where the trees from there stayed near it while the others
            spread; empty otherwise.
        spread: greatest distance of a node of the trees from start and goal from their roots, in
            which 0.6 m count as a radian [m].
        paths: paths past what is at rest, none of which could be run among the bodies that move.
        closed_at: time from which on the last of them was closed [s]; None if it was too long.
    """

    seconds: float
    tries: int
    nodes: int
    meetings: int
    refused: int
    apart: float
    contact: Contact | None = None
    advice: tuple[str, ...] = ()
    attitude_missed: float | None = None
    on_lattice: str = ""
    enclosed: str = ""
    spread: tuple[float, float] = (0.0, 0.0)
    paths: int = 0
    closed_at: float | None = None

    def message(self) -> str:
        """What was tried, what is in the way, and what may help; last, what the lattice said."""
        if self.paths:
            text = f"no path could be run in time among the bodies that move, in {self.seconds:.3g}"
            text += f" s: {self.paths} paths were found past what is at rest"
            if self.closed_at is not None:
                text += f", the last of which is closed from {self.closed_at:.4g} s on"
            return text + helping(self.advice)
        text = f"no path was found in {self.seconds:.3g} s: {self.tries} searches, {self.nodes} "
        text += f"nodes, {self.meetings} meetings of the trees from start and goal"
        text += f", {self.refused} paths refused by the proof" if self.refused else ""
        if self.attitude_missed is not None:
            degrees = math.degrees(self.attitude_missed)
            text += f"; the best path misses the goal's attitude by {self.attitude_missed:.3g} rad "
            text += f"({degrees:.3g} degrees)"
        else:
            text += f"; the trees came as near to each other as {self.apart:.3g} m"
            if self.contact is not None:
                link, obstacle, depth, source = self.contact
                text += f", with link '{link}' {-depth:.3g} m from "
                text += obstacle_name(obstacle, source)
        if self.enclosed:
            own, other = self.spread if self.enclosed == "start" else self.spread[::-1]
            text += f"; the {self.enclosed} may be enclosed: the trees from it came no farther "
            text += f"than {own:.3g} m, the others {other:.3g} m"
        text += helping(self.advice)
        return f"{text}. On the lattice: {self.on_lattice}" if self.on_lattice else text


@dataclass(eq=False, repr=False)
class WorkerDied(PlanningError):
    """A worker process ended without a result.

    Attributes:
        worker: its number, from 0.
        colonies: numbers of the colonies that it was to run.
        status: its exit status, such as `SIGKILL(-9)`.
    """

    worker: int
    colonies: list[int]
    status: str

    def message(self) -> str:
        """The worker, its colonies and its exit status."""
        colonies = ", ".join(map(str, self.colonies))
        text = f"worker {self.worker} (colonies {colonies}) died with exit status {self.status}"
        return f"{text}; fewer workers need less memory"


@dataclass(eq=False, repr=False)
class PlanNotVerified(PlanningError):
    """The independent verification of a plan found a problem.

    Attributes:
        problems: what is wrong, one sentence each.
    """

    problems: tuple[str, ...]

    def message(self) -> str:
        """All problems."""
        return "the plan does not verify: " + "; ".join(self.problems)


def helping(advice: tuple[str, ...]) -> str:
    """The end of a message that says what may help; empty without advice."""
    return f"; what may help: {'; '.join(advice)}" if advice else ""
