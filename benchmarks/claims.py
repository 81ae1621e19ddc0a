"""Sentences of the documentation with numbers from the tables in docs/benchmarks.

`python -m benchmarks.remake --check` compares them; see `benchmarks/claim_check.py`.
"""

from benchmarks.claim_check import Cell, Claim, Phrase

_COLLIDE = "planned as if held, delta = 0: collide"
_WITH_REACTION = "planned with reaction, all deltas: collide"
_PROBLEMS = Phrase("base_reaction", "table counts colliding plans out of {} for each delta")
_LIGHT = Cell("base_reaction", "5", _COLLIDE)
_HEAVY = Cell("base_reaction", "2000", _COLLIDE)
_DEPTH = Cell("base_reaction", None, "deepest [mm]", take=max, factor=0.1)
_PLANS = Cell("base_reaction", None, _WITH_REACTION, part=1)
_COLLIDING = Cell("base_reaction", None, _WITH_REACTION)


_RUNS = Cell("gap", "AntSystem", "runs")
_TIME = "time to a path, median (90th percentile) [ms]"
_DEFAULT = ("edge resolution", "0.01")
_FINE = ("edge resolution", "0.002")
_HITS = "with a collision (deepest)"
_EQUAL = "**equal clearance, against delta 0.05**"
_QUERIES = "family `paper`, 4 to 11 spheres: sharp, link by link"


def _above(row: str) -> Cell:
    """Share of a colony's runs that end more than 0.1 % above the optimum [%]."""
    return Cell("gap", row, "above 0.1 %")


def _ompl(row: str, factor: float = 1.0) -> Cell:
    """Median time of one of our planners in OMPL's table, to one digit [ms]."""
    return Cell("ompl", row, _TIME, factor=factor, digits=1)


def _worst(column: str, where: tuple[str, str], part: int = 0) -> Cell:
    """The largest number that a planner of OMPL has there."""
    return Cell("ompl", None, column, part=part, where=where, take=max)


CLAIMS = [
    Claim(
        "README.md",
        "{problems} problems of [the problem set](docs/howto/problem_set.md) were planned as if",
        {"problems": _PROBLEMS},
    ),
    Claim(
        "README.md",
        "On a base of 5 kg {light} of {all} shortest paths collide, on a base of 2 000 kg {heavy} "
        "of {same}; the arms penetrate by up to {depth} cm. Of {plans} plans that include the "
        "reaction {colliding} collides",
        {
            "light": _LIGHT,
            "all": _PROBLEMS,
            "heavy": _HEAVY,
            "same": _PROBLEMS,
            "depth": _DEPTH,
            "plans": _PLANS,
            "colliding": _COLLIDING,
        },
    ),
    Claim(
        "docs/index.md",
        "{problems} problems of [the problem set](howto/problem_set.md) were planned as if",
        {"problems": _PROBLEMS},
    ),
    Claim(
        "docs/index.md",
        "Of the shortest paths {light} collide on a base of 5 kg, up to {depth} cm deep, and "
        "{heavy} on a base of 2 000 kg. Of {plans} plans that include the reaction {colliding} "
        "collides",
        {
            "light": _LIGHT,
            "depth": _DEPTH,
            "heavy": _HEAVY,
            "plans": _PLANS,
            "colliding": _COLLIDING,
        },
    ),
    Claim(
        "docs/index.md",
        "A clearance takes {few} µs among ten spheres and {many} µs among a hundred thousand",
        {
            "few": Cell("many_obstacles", "10", "a node"),
            "many": Cell("many_obstacles", "100 000", "a node"),
        },
    ),
    Claim(
        "docs/index.md",
        "Among a few obstacles {share} % of the free edges are proven without another distance "
        "query",
        {"share": Cell("certification", _QUERIES, "of these without a query")},
    ),
    Claim(
        "docs/index.md",
        "The exact optimum of a lattice takes about {time} ms",
        {"time": _ompl("LatticeOptimum, no refinement")},
    ),
    Claim(
        "docs/planning.md",
        "{share} % of {runs} runs end more than 0.1 % above the optimum",
        {"share": _above("MaxMinAntSystem"), "runs": _RUNS},
    ),
    Claim(
        "docs/planning.md",
        "the paper's ant system | {median} % above the optimum in the median",
        {"median": Cell("gap", "AntSystem", "median")},
    ),
    Claim(
        "docs/planning.md",
        "At equal clearance these paths need {share} % less delta-v than those of least F, in the "
        "median of {problems} problems",
        {
            "share": Cell("least_fuel", _EQUAL, "median [%]", factor=-1.0),
            "problems": Cell("least_fuel", _EQUAL, "plans"),
        },
    ),
    Claim("docs/planning.md", "matters most. Over {runs} runs", {"runs": _RUNS}),
    *(
        Claim("docs/planning.md", f"| {name} | {{above}} % |", {"above": _above(row)})
        for name, row in (
            ("as shipped", "MaxMinAntSystem"),
            ("without pheromone", "without pheromone"),
            ("without cost-aware visibility", "without cost-aware visibility"),
            ("without restarts", "without restarts"),
            ("without local search", "without local search"),
            ("the paper's Ant System", "AntSystem"),
        )
    ),
    Claim(
        "docs/planning.md",
        "it reduces the median gap from {without} % to {with_it} %",
        {
            "without": Cell("gap", "without local search and pheromone", "median"),
            "with_it": Cell("gap", "without local search", "median"),
        },
    ),
    Claim(
        "docs/paper.md",
        "above the optimum, by {median} % in the median over {runs} runs",
        {"median": Cell("gap", "AntSystem", "median"), "runs": _RUNS},
    ),
    Claim(
        "docs/comparison.md",
        "{exact} ms for the exact optimum, {refined} s refined",
        {
            "exact": _ompl("LatticeOptimum, no refinement"),
            "refined": _ompl("LatticeOptimum, refined", 1e-3),
        },
    ),
    Claim(
        "docs/comparison.md",
        "{first} to {fine} ms for a first path, with checks called from Python (same table)",
        {
            "first": Cell("ompl", "RRTConnect", _TIME, where=_DEFAULT),
            "fine": Cell("ompl", "RRTConnect", _TIME, where=_FINE),
        },
    ),
    Claim(
        "docs/comparison.md",
        "at the default resolution, between {least} and {most} of the paths of each planner "
        "contain a collision, up to {depth} mm deep; at a five times finer resolution up to "
        "{fine} paths do, at most {fine_depth} mm deep",
        {
            "least": Cell("ompl", None, _HITS, where=_DEFAULT, take=min),
            "most": _worst(_HITS, _DEFAULT),
            "depth": _worst(_HITS, _DEFAULT, part=1),
            "fine": _worst(_HITS, _FINE),
            "fine_depth": _worst(_HITS, _FINE, part=1),
        },
    ),
    Claim(
        "docs/comparison.md",
        "several times sooner than ours, and {longer} % longer",
        {"longer": Cell("ompl", "RRTConnect", "length against `plan()`, median", where=_DEFAULT)},
    ),
    Claim(
        "docs/howto/certify.md",
        "on a 200 kg bus, {colliding} collide once the base is free",
        {"colliding": Cell("fixed_base_plans", "200", "OMPL plans that collide")},
    ),
    Claim(
        "docs/howto/problem_set.md",
        "The default planner solves {solved} of the {problems} problems that it was measured on "
        "within their times; OMPL's RRTConnect for a base at rest solves {theirs} of {tried}",
        {
            "solved": Cell("problem_set", "all", "solved in time"),
            "problems": Cell("problem_set", "all", "solved in time", part=1),
            "theirs": Cell("problem_set", "all", "B in time"),
            "tried": Cell("problem_set", "all", "tasks"),
        },
    ),
    Claim(
        "docs/proof.md",
        "none does, and the largest error is {share} % of its bound",
        {"share": Cell("reaction_error", None, "largest share", take=max, factor=100.0)},
    ),
    Claim(
        "docs/proof.md",
        "of {free} proven free {touching} touches, and of {refused} refused {clear} is clear by "
        "more than 1 mm",
        {
            "free": Cell("shape_soundness", None, "proven free"),
            "touching": Cell("shape_soundness", None, "of these, touching"),
            "refused": Cell("shape_soundness", None, "refused"),
            "clear": Cell("shape_soundness", None, "of these, clear by more than 1 mm"),
        },
    ),
]
