"""Small studies, and planners that are slow or fail on purpose."""

import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path

import ffsr_plan as fp


def small_problem(height=0.1):
    """A sphere of four metres' way, on a small lattice."""
    robot = fp.load_robot("point")
    return fp.Problem(
        robot,
        fp.Scene([[2.0, height, 0.0]], [0.3]),
        start=robot.neutral(),
        goal=robot.configuration(position=(4.0, 0.0, 0.0)),
        lattice=fp.Lattice(divisions=6, lateral=fp.Axis(half_count=2, spacing=0.3)),
        delta=0.1,
    )


class Slow:
    """An ant colony, after a rest of `FFSR_TEST_REST` seconds, which is no setting of it."""

    def plan(self, problem, seed):
        time.sleep(float(os.environ.get("FFSR_TEST_REST", "0")))
        return fp.plan(problem, fp.AntSystem(ants=3, cycles=2), seed)


@dataclass(frozen=True)
class Deadly:
    """A planner that kills its process at seed 1 once, and at seed 2 always."""

    folder: str

    def plan(self, problem, seed):
        mark = Path(self.folder, "died")
        if seed == 2 or (seed == 1 and not mark.exists()):
            mark.touch() if seed == 1 else None
            os.kill(os.getpid(), signal.SIGKILL)
        return fp.plan(problem, fp.AntSystem(ants=3, cycles=2), seed)


def small_study():
    """Four problems, two planners, three seeds."""
    problems = {f"height {k}": small_problem(0.1 * k) for k in range(4)}
    return fp.Study(problems, {"rested": Slow(), "exact": "lattice-optimum"}, 3)
