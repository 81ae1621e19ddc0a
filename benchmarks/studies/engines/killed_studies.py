"""Studies that are killed at random: do they end with the same rows as one left alone?

    python -m benchmarks.studies.engines.killed_studies

A study of 2 000 plans, 50 scenes x 2 planners x 20 seeds, runs on two workers. Its process is
killed by SIGKILL five times, at moments drawn at random, and run again. In the end its rows are
compared with those of the same study on one worker that nothing happened to: all columns but times
and workers, digests of the plans included.
"""

import argparse
import os
import random
import sqlite3
import subprocess
import sys
import tempfile
import time

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table

SCENES, SEEDS = 50, 20
PLANNERS = {
    "ant system": fp.AntSystem(ants=6, cycles=4),
    "max-min": fp.MaxMinAntSystem(ants=6, cycles=4),
}
RUN = "from benchmarks.studies.engines.killed_studies import study; study({}).run({!r}, {})"


def study(scenes: int = SCENES) -> fp.Study:
    """A point robot past three spheres, on a small lattice."""
    robot, rng, problems = fp.load_robot("point"), random.Random(0), {}
    for k in range(scenes):
        centers = [[x, rng.uniform(-0.5, 0.5), 0.0] for x in (2.0, 4.0, 6.0)]
        problems[f"scene {k}"] = fp.Problem(
            robot,
            fp.Scene(centers, [0.3] * 3),
            start=robot.neutral(),
            goal=robot.configuration(position=(8.0, 0.0, 0.0)),
            lattice=fp.Lattice(divisions=16, lateral=fp.Axis(half_count=5, spacing=0.15)),
            delta=0.05,
        )
    return fp.Study(problems, PLANNERS, SEEDS)


def begun(folder: str, scenes: int, how: str) -> subprocess.Popen:
    """A run of the study in a process of its own."""
    command = [sys.executable, "-c", RUN.format(scenes, folder, how)]
    return subprocess.Popen(command, env={**os.environ, "PYTHONPATH": os.getcwd()})


def rows(folder: str) -> int:
    """Number of rows that are committed."""
    try:
        with sqlite3.connect(f"file:{folder}/study.sqlite?mode=ro", uri=True) as connection:
            return connection.execute("SELECT count(*) FROM rows").fetchone()[0]
    except sqlite3.Error:
        return 0


def killed(folder: str, engine: str, scenes: int, kills: int, seed: int) -> list[int]:
    """Run a study to its end, through `kills` kills at random; rows after each."""
    rng, found = random.Random(seed), []
    total = len(study(scenes))
    moments = sorted(rng.sample(range(1, total), kills))
    how = f"engine={engine!r}, workers=2"
    for moment in moments:
        process = begun(folder, scenes, how)
        while process.poll() is None and rows(folder) < moment:
            time.sleep(0.005)
        time.sleep(rng.random() * 0.2)
        process.kill()
        process.wait()
        found.append(rows(folder))
    assert begun(folder, scenes, how).wait() == 0
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=SCENES)
    parser.add_argument("--kills", type=int, default=5)
    arguments = parser.parse_args()
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        assert begun(f"{folder}/alone", arguments.scenes, "").wait() == 0
        alone = fp.StudyResult(f"{folder}/alone")
        seconds = time.perf_counter() - begin
        counts = [str(len(alone)), str(alone.plans)]
        lines.append(["1, left alone", "", *counts, f"{seconds:.0f}", "-"])
        for seed, engine in enumerate(("processes", "dask")):
            place, begin = f"{folder}/{engine}", time.perf_counter()
            after = killed(place, engine, arguments.scenes, arguments.kills, seed)
            result, seconds = fp.StudyResult(place), time.perf_counter() - begin
            same = "yes" if result.digest() == alone.digest() else "NO"
            name, at = f"2, {engine}, killed", ", ".join(map(str, after))
            lines.append([name, at, str(len(result)), str(result.plans), f"{seconds:.0f}", same])
    text = "\n\n".join(
        [
            "# Studies that are killed",
            f"    python -m benchmarks.studies.engines.killed_studies --scenes {arguments.scenes} "
            f"--kills {arguments.kills}",
            f"A study of {lines[0][2]} plans runs on two workers; its process is killed by SIGKILL "
            f"{arguments.kills} times at random moments and run again. `same rows` compares all "
            "columns but times and workers with the study that was left alone, bit for bit; the "
            "digests of the plans are among them. Times contain the new starts, of some seconds "
            "each.",
            table(["workers", "rows when killed", "rows", "plans", "time [s]", "same rows"], lines),
        ]
    )
    publish(text, RESULTS / "killed_studies.md")


if __name__ == "__main__":
    main()
