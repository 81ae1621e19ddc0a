"""Write the moving picture of the README.

It shows the plan of the scenario `fig2a`, found by the default planner with seed 0 and refined.

`python -m tools.make_demo_gif docs/demo.gif`
"""

from __future__ import annotations

import sys

import ffsr_plan as fp
from ffsr_plan.display.moving_picture import write_gif


def main(path: str) -> None:
    """Plan `fig2a` and write its moving picture to a file."""
    write_gif(fp.plan(fp.load_scenario("fig2a"), seed=0), path)


if __name__ == "__main__":
    main(sys.argv[1])
