"""Comparison of speed with a baseline, as ratios to `pin.computeDistances`.

    python -m benchmarks.speed.compare                  # runs pytest benchmarks, then compares
    python -m benchmarks.speed.compare benchmarks.json  # compares what --benchmark-json wrote
    python -m benchmarks.speed.compare --update         # makes what was measured the baseline

Ratios depend less on the machine than seconds do. The exit status is 1 if a ratio grew by more than
--limit. Measure a baseline on an idle machine only.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
BASELINE = HERE / "baseline.json"


def measured(file: Path) -> dict[str, float]:
    """Ratios by name of benchmark, from the JSON of pytest-benchmark."""
    report = json.loads(file.read_text(encoding="utf-8"))
    return {b["name"]: float(b["extra_info"]["ratio"]) for b in report["benchmarks"]}


def measure() -> dict[str, float]:
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
    now = measured(args.file) if args.file else measure()
    before = {}
    if args.baseline.exists():
        before = json.loads(args.baseline.read_text(encoding="utf-8"))
    print("\n".join(report(before, now, args.limit)))
    if args.update:
        rounded = {name: float(f"{ratio:.4g}") for name, ratio in now.items()}
        args.baseline.write_text(json.dumps(rounded, indent=2) + "\n", encoding="utf-8")
        print(f"wrote {args.baseline}")
        return 0
    return int(any(factor > args.limit for factor in changes(before, now).values()))


if __name__ == "__main__":
    sys.exit(main())
