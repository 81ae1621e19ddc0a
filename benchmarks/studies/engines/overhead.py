"""What a study costs beyond its plans: overhead and tasks a second on each engine.

    python -m benchmarks.studies.engines.overhead [--cases 0 9]

Lines of cases that are not measured stay as they are; all of them take some 40 minutes.

The planner rests for a given time and returns a trajectory of two points, without reckoning: what
remains is the cost of handing out tasks, of bringing rows back and of writing them. More workers
than the computer has cores therefore stand for a cluster, whose scheduler is here.
"""

import argparse
import tempfile
import time
from dataclasses import dataclass

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table

CASES = [  # engine, workers, tasks, seconds of a task
    ("in-process", 1, 60, 1.0),
    ("processes", 1, 60, 1.0),
    ("processes", 2, 120, 1.0),
    ("dask", 1, 60, 1.0),
    ("dask", 2, 120, 1.0),
    ("dask", 8, 480, 1.0),
    ("processes", 2, 2000, 0.05),
    ("dask", 2, 2000, 0.05),
    ("dask", 8, 10000, 0.05),
    ("dask", 8, 10000, 1.0),
]
PAGE = RESULTS / "study_overhead.md"


@dataclass(frozen=True)
class Rest:
    """A planner that rests."""

    seconds: float

    def plan(self, problem: fp.Problem, seed: int) -> fp.Trajectory:
        """The straight way, whatever is on it."""
        end = time.perf_counter() + self.seconds
        held = {name: [0.0, 0.0] for name in problem.robot.joint_names}
        ends = [problem.start[:3], problem.goal[:3]]
        found = fp.Trajectory([0.0, 1.0], held, base_positions=ends)
        time.sleep(max(0.0, end - time.perf_counter()))
        return found


def measured(engine: str, workers: int, tasks: int, seconds: float) -> list[str]:
    """One line of the table."""
    robot = fp.load_robot("point")
    goal = robot.configuration(position=(4.0, 0.0, 0.0))
    problem = fp.Problem(robot, fp.Scene(), start=robot.neutral(), goal=goal)
    study, marks = fp.Study({"p": problem}, {"rest": Rest(seconds)}, tasks), []

    def note(told: fp.StudyProgress) -> None:
        marks.append((time.perf_counter(), told.done))

    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        result = study.run(folder, engine=engine, workers=workers, on_progress=note)
        whole = time.perf_counter() - begin
        spent = sum(row["wall"] for row in result.rows())
        begun = marks[0][0]
        wall = marks[-1][0] - begun
    overhead = (wall * workers - spent) / spent
    return [
        engine,
        str(workers),
        str(tasks),
        f"{seconds:g}",
        f"{begun - begin + whole - (marks[-1][0] - begin):.1f}",
        f"{wall:.1f}",
        f"{tasks / wall:.1f}",
        f"{overhead:.2%}",
    ]


def measured_before(case: tuple[str, int, int, float]) -> list[str]:
    """The line of a case on the page; empty if there is none."""
    for line in PAGE.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if cells[:4] == [*map(str, case[:3]), f"{case[3]:g}"]:
            return cells
    return []


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, nargs="*", default=range(len(CASES)))
    arguments = parser.parse_args()
    lines = {case: line for case in CASES if (line := measured_before(case))}
    lines |= {CASES[k]: measured(*CASES[k]) for k in arguments.cases}
    text = "\n\n".join(
        [
            "# Overhead of studies",
            "    python -m benchmarks.studies.engines.overhead",
            "The planner rests for `task` seconds and reckons nothing, so that more workers than "
            "cores stand for a cluster. Start and end are those of the engine: processes, "
            "imports, the first connection. Overhead is (time x workers - sum of the tasks' own "
            "times) / sum of the tasks' own times, after the start; tasks of less than a second "
            "are sent several at a time. Workers of `processes` start, and all workers load the "
            "package, with their first job, in that time. The machine has two cores and other "
            "work: eight workers that judge 10 000 trajectories wait for a core, which is most "
            "of the line before the last.",
            table(
                [
                    "engine", "workers", "tasks", "task [s]", "start and end [s]", "time [s]",
                    "tasks a second", "overhead",
                ],
                [lines[case] for case in CASES if case in lines],
            ),
        ]
    )  # fmt: skip
    publish(text, PAGE)


if __name__ == "__main__":
    main()
