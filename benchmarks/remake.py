"""Make the pages in docs/benchmarks from the problem set again, and check what other pages claim.

    python -m benchmarks.remake

runs, one after the other, the commands that the pages state near their tops, and then compares the
claims of `benchmarks/claims.py` with the tables. `--page gap --page ompl` runs these alone.
`--list` shows pages, commands and how long each took last time; `--check` only compares. The status
is 1 if a command failed or a claim differs.
"""

import argparse
import json
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

from benchmarks.claim_check import RESULTS, ROOT, check, page_text
from benchmarks.claims import CLAIMS

PAGES = (
    "base_reaction", "gap", "least_fuel", "certification", "ompl", "clearance_weight",
    "flights_and_fuel", "smooth_curves", "refinement", "anytime", "scaling", "fuel_ants",
    "problem_set",
)  # fmt: skip
"""Pages that are made from the problem set."""
SECONDS = Path("benchmarks/remake_seconds.json")
"""Wall-clock time of the last run of each command, beside the command [s]."""
_COMMAND = re.compile(r"python (-m benchmarks\.studies\.[\w.]+(?: +-[-\w]+(?: +[\w.]+)?)*)")
_TOP = 8  # lines


def command_of(page: str, root: Path = ROOT) -> list[str]:
    """The arguments for Python that a page states as its command.

    Args:
        page: name in docs/benchmarks, without `.md`.
        root: of the repository.

    Raises:
        ValueError: the page states none near its top.
    """
    top = " ".join(page_text(root, page).splitlines()[:_TOP])
    found = _COMMAND.search(top)
    if found is None:
        raise ValueError(f"{RESULTS}/{page}.md: no command in its first {_TOP} lines")
    return shlex.split(found[1])


def remake(page: str) -> bool:
    """Run the command of a page, keep how long it took, and tell whether it succeeded.

    Args:
        page: name in docs/benchmarks, without `.md`.
    """
    words = command_of(page)
    print(f"{page}: python {shlex.join(words)}", flush=True)
    begin = time.monotonic()
    code = subprocess.run([sys.executable, *words], cwd=ROOT, check=False).returncode
    seconds = time.monotonic() - begin
    print(f"{page}: status {code} after {seconds / 60.0:.1f} minutes", flush=True)
    if code == 0:
        kept = times() | {page: {"command": shlex.join(words), "seconds": round(seconds)}}
        text = json.dumps({name: kept[name] for name in sorted(kept)}, indent=2)
        (ROOT / SECONDS).write_text(text + "\n", encoding="utf-8")
    return code == 0


def times() -> dict[str, dict[str, str | float]]:
    """By page, `command` and `seconds` of its last run."""
    path = ROOT / SECONDS
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def listing() -> str:
    """A line for each page: its command and the time of the last run of it."""
    known, lines = times(), []
    for page in PAGES:
        words = shlex.join(command_of(page))
        last = known.get(page, {})
        took = f"{float(last['seconds']) / 60.0:5.1f} min" if last.get("command") == words else "-"
        lines.append(f"{page:17} {took:>9}  python {words}")
    return "\n".join(lines)


def report() -> bool:
    """Print each number of each claim; whether all agree."""
    outcomes = check(CLAIMS)
    print("\n".join(map(str, outcomes)))
    wrong = sum(not outcome.agree for outcome in outcomes)
    print(f"{len(outcomes)} numbers in {len(CLAIMS)} claims, {wrong} differ")
    return wrong == 0


def main() -> None:
    """Run commands, check claims."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--page", action="append", choices=PAGES, help="only this; may be repeated")
    parser.add_argument("--list", action="store_true", help="show commands and their last times")
    parser.add_argument("--check", action="store_true", help="only compare claims with the tables")
    args = parser.parse_args()
    if args.list:
        print(listing())
        return
    made = [remake(page) for page in ([] if args.check else args.page or PAGES)]
    agree = report()
    sys.exit(0 if all(made) and agree else 1)


if __name__ == "__main__":
    main()
