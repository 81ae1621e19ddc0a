"""Draw the figure of a flight that the documentation shows.

`python -m tools.make_flight_figure docs/flight.png`
"""

from __future__ import annotations

import sys

import ffsr_plan as fp


def demo_flight() -> fp.SmoothFlight | fp.TimedPlan:
    """A flight of the scenario `fig2a`, planned by the default planner with seed 0 and refined."""
    plan = fp.plan(fp.load_scenario("fig2a"), seed=0)
    return plan.timed(joint_acceleration=0.05, thruster_acceleration=0.01)


def main(path: str) -> None:
    """Plan and time `fig2a` and write its figure to a file."""
    demo_flight().write_figure(path)


if __name__ == "__main__":
    main(sys.argv[1])
