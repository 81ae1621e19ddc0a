"""Run the deliberate breaks of `tests/mutations.toml`: each must make its test fail.

    python -m tools.run_mutations [--sample N --seed S] [--file PATTERN] [--workers 2] [--list]

Every mutation is applied in a copy of the repository, and its test is run there. Kernels that the
mutation changes are compiled for it alone (`ffsr_plan.core.kernels.kernel_cache`).
"""

from __future__ import annotations

import argparse
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from fnmatch import fnmatch
from pathlib import Path
from typing import NamedTuple

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parent.parent
MUTATIONS = ROOT / "tests" / "mutations.toml"
LEFT_OUT = (".*", "__pycache__", "*.egg-info", "site", "build", "dist", "ffsr-demo*")
TIME_LIMIT = 300.0  # [s] of one test; a mutation that makes it run longer counts as killed
PASSED, FAILED = 0, 1  # exit statuses of pytest
REASON = re.compile(r"^(?:FAILED|ERROR|SKIPPED) .*? - (.*)$", re.MULTILINE)


class Mutation(NamedTuple):
    """A deliberate break.

    Attributes:
        what: the break in words.
        file: path of the file from the root of the repository.
        old: text that occurs exactly once in the file.
        new: text in its place.
        test: node id of a test that must fail.
    """

    what: str
    file: str
    old: str
    new: str
    test: str


class Result(NamedTuple):
    """Result of one mutation.

    Attributes:
        status: `killed`, `SURVIVED`, `stale` (the old text does not occur exactly once), `skipped`
            (the test needs something that is not installed) or `invalid` (pytest did not run it).
        reason: message of the failed test, or what is wrong.
        seconds: duration [s].
    """

    status: str
    reason: str
    seconds: float


def read_mutations(path: Path = MUTATIONS) -> list[Mutation]:
    """All mutations of a file, in its order."""
    listed = tomllib.loads(path.read_text(encoding="utf-8"))["mutations"]
    return [Mutation(**entry) for entry in listed]


def run_pytest(
    root: Path, tests: Sequence[str], time_limit: float | None = None
) -> tuple[int | None, str]:
    """Run tests of a copy of the repository until the first one fails.

    Args:
        root: root of the copy.
        tests: node ids.
        time_limit: [s].

    Returns:
        Exit status, None if the time limit was exceeded, and output.
    """
    command = [
        sys.executable, "-m", "pytest", "-x", "-q", "--tb=short", "--import-mode=importlib",
        "-p", "no:cacheprovider", "--hypothesis-profile=mutations", *tests,
    ]  # fmt: skip
    settings = {"PYTHONPATH": str(root), "MPLBACKEND": "Agg", "COLUMNS": "250"}
    with subprocess.Popen(
        command, cwd=root, env=os.environ | settings, text=True, start_new_session=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ) as process:  # fmt: skip
        try:
            output, _ = process.communicate(timeout=time_limit)
            return process.returncode, output
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)  # with all processes that the test has started
            return None, ""


def run_mutation(base: Path, mutation: Mutation) -> Result:
    """Apply one mutation in a copy of `base` and run its test there."""
    begin = time.monotonic()
    text = (base / mutation.file).read_text(encoding="utf-8")
    count = text.count(mutation.old)
    if count != 1:
        return Result("stale", f"the old text occurs {count} times", 0.0)
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        copy = Path(folder) / "copy"
        shutil.copytree(base, copy)
        mutated = text.replace(mutation.old, mutation.new)
        (copy / mutation.file).write_text(mutated, encoding="utf-8")
        status, output = run_pytest(copy, [mutation.test], TIME_LIMIT)
    seconds = time.monotonic() - begin
    reason = "; ".join(REASON.findall(output)[:1])
    if status is None:
        return Result("killed", f"longer than {TIME_LIMIT:g} s", seconds)
    if status == FAILED:
        return Result("killed", reason, seconds)
    if status != PASSED:
        return Result("invalid", f"pytest ended with {status}: {reason}", seconds)
    if re.search(r"\d skipped", output) and not re.search(r"\d passed", output):
        return Result("skipped", reason, seconds)
    return Result("SURVIVED", mutation.test, seconds)


def run_all(mutations: Sequence[Mutation], workers: int) -> bool:
    """Run mutations and print one line each; whether none survived or could not be applied."""
    with tempfile.TemporaryDirectory(prefix="mutations-") as folder:
        base = Path(folder) / "base"
        shutil.copytree(ROOT, base, ignore=shutil.ignore_patterns(*LEFT_OUT))
        tests, begin = sorted({mutation.test for mutation in mutations}), time.monotonic()
        status, output = run_pytest(base, tests)
        if status != PASSED:
            print(output, "a test does not pass without mutations", sep="\n")
            return False
        print(f"{len(tests)} tests pass without mutations, {time.monotonic() - begin:.0f} s")
        counts = Counter({"killed": 0, "SURVIVED": 0, "stale": 0})
        with ThreadPoolExecutor(workers) as pool:
            jobs = {pool.submit(run_mutation, base, each): each for each in mutations}
            for job in as_completed(jobs):
                each, (status_word, reason, seconds) = jobs[job], job.result()
                counts[status_word] += 1
                print(f"{status_word:8} {seconds:4.0f} s  {each.file}: {each.what} [{reason}]")
    print(", ".join(f"{count} {word.lower()}" for word, count in counts.items()))
    return counts["killed"] + counts["skipped"] == len(mutations)


def main() -> int:
    """Run the command; 0 if no mutation survived and all could be applied."""
    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--sample", type=int, help="run a random sample of this size")
    parser.add_argument("--seed", type=int, default=0, help="seed of the sample")
    parser.add_argument("--file", default="*", help="only mutations of files that match")
    parser.add_argument("--workers", type=int, default=2, help="tests at a time")
    parser.add_argument("--list", action="store_true", help="print the mutations, run nothing")
    given = parser.parse_args()
    chosen = [each for each in read_mutations() if fnmatch(each.file, given.file)]
    if given.sample is not None:
        chosen = random.Random(given.seed).sample(chosen, min(given.sample, len(chosen)))
    if given.list:
        for each in chosen:
            print(f"{each.file}: {each.what}\n    {each.test}")
        return 0
    return 0 if run_all(chosen, given.workers) else 1


if __name__ == "__main__":
    sys.exit(main())
