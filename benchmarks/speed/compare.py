"""Comparison of speed with a baseline, as ratios to `pin.computeDistances`, and with limits.

    python -m benchmarks.speed.compare                  # runs pytest benchmarks, then compares
    python -m benchmarks.speed.compare benchmarks.json  # compares what --benchmark-json wrote
    python -m benchmarks.speed.compare --update         # makes what was measured the baseline

Ratios depend less on the machine than seconds do. The exit status is 1 if a ratio grew by more than
--limit since the baseline, or if one is above what `limits.json` allows. Measure a baseline on an
idle machine only.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).parent
BASELINE, LIMITS = HERE / "baseline.json", HERE / "limits.json"
_SPREAD = 1.5  # of a time from one machine to another


class Speed(NamedTuple):
    """What was measured: the median time [s], and its ratio to the reference."""

    seconds: float
    ratio: float


class Limit(NamedTuple):
    """A row of `limits.json`: what is timed, what it took, what is allowed."""

    what: str
    found: str
    allowed: str
    kept: bool


def measured(file: Path) -> dict[str, Speed]:
    """Speeds by name of benchmark, from the JSON of pytest-benchmark."""
    report = json.loads(file.read_text(encoding="utf-8"))
    return {
        b["name"]: Speed(float(b["stats"]["median"]), float(b["extra_info"]["ratio"]))
        for b in report["benchmarks"]
    }


def limits(now: dict[str, Speed]) -> list[Limit]:
    """All rows of `limits.json`; a time may be above its limit by half."""
    rows = []
    for row in json.loads(LIMITS.read_text(encoding="utf-8")):
        speed, unit = now.get(row["benchmark"]), "ratio" if "ratio" in row else "seconds"
        allowed = row[unit] * (1.0 if unit == "ratio" else _SPREAD)
        found = getattr(speed, unit) if speed else None
        shown = "not measured" if found is None else f"{found:.3g}"
        rows.append(
            Limit(row["what"], shown, f"{row[unit]:g} {unit}", found is None or found <= allowed)
        )
    return rows


def measure() -> dict[str, Speed]:
    """Run the benchmarks now."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "benchmarks.json"
        command = ["-m", "pytest", str(HERE), "-q", "--benchmark-columns=median,rounds"]
        subprocess.run([sys.executable, *command, f"--benchmark-json={file}"], check=True)
        return measured(file)


def changes(before: dict[str, float], now: dict[str, float]) -> dict[str, float]:
    """Factor by which each ratio grew, for the benchmarks that are in both."""
    return {name: now[name] / before[name] for name in before if name in now}


def report(before: dict[str, float], now: dict[str, float], limit: float) -> list[str]:
    """One line for each benchmark: ratio before, ratio now, factor."""
    grown = changes(before, now)
    width = max(map(len, {*before, *now}))
    lines = [f"{'ratio to pin.computeDistances':{width}}   before      now   factor"]
    for name in {**before, **now}:
        numbers = "".join(
            f"{ratios[name]:9.3f}" if name in ratios else f"{'-':>9}" for ratios in (before, now)
        )
        factor = f"{grown[name]:9.2f}" if name in grown else f"{'-':>9}"
        mark = "  slower" if grown.get(name, 0.0) > limit else ""
        lines.append(f"{name:{width}}{numbers}{factor}{mark}")
    return lines


def main() -> int:
    """Compare and print; the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("file", type=Path, nargs="?", help="JSON of pytest-benchmark")
    parser.add_argument("--baseline", type=Path, default=BASELINE)
    parser.add_argument("--update", action="store_true", help="rewrite the baseline")
    parser.add_argument("--limit", type=float, default=1.5, help="factor that counts as slower")
    args = parser.parse_args()
    speeds = measured(args.file) if args.file else measure()
    now = {name: speed.ratio for name, speed in speeds.items()}
    before = {}
    if args.baseline.exists():
        before = json.loads(args.baseline.read_text(encoding="utf-8"))
    print("\n".join(report(before, now, args.limit)), end="\n\n")
    rows = limits(speeds)
    width = max(len(row.what) for row in rows)
    for row in rows:
        mark = "" if row.kept else "  above"
        print(f"{row.what:{width}}  {row.found:>12} of {row.allowed}{mark}")
    if args.update:
        rounded = {name: float(f"{ratio:.4g}") for name, ratio in now.items()}
        args.baseline.write_text(json.dumps(rounded, indent=2) + "\n", encoding="utf-8")
        print(f"wrote {args.baseline}")
        return 0
    slower = any(factor > args.limit for factor in changes(before, now).values())
    return int(slower or not all(row.kept for row in rows))


if __name__ == "__main__":
    sys.exit(main())
