"""The best plans known: their figures in `best.json`, their trajectories beside it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

from ffsr_plan.core.checks import one_of, text
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text, write_text
from ffsr_plan.formats.numpy_trajectories import read_numpy, write_numpy
from ffsr_plan.trajectory.trajectory import Trajectory

BEST, FORMAT = "best.json", "ffsr-plan best plans 1"


@dataclass(frozen=True)
class BestPlan:
    """What is known of a problem.

    Attributes:
        problem: its name.
        bound: F that no motion falls below [length units].
        bound_by: how the bound was made.
        length: L of the best plan [m]; None where no plan is known, like all that follows.
        objective: F of its whole motion [length units].
        delta_v: its change of velocity, in its own time [m/s].
        clearance: its least sampled clearance [m].
        planner: name of the planner.
        seed: of its random numbers.
        seconds: that it took [s].
        version: of the package.
        lattice_objective: F of Eq. 8 of its path on the problem's lattice; None without a lattice.
        lattice_optimum: F of Eq. 8 of the exact optimum of the lattice, where that is known.
        sha256: of the file of its trajectory.
        tried: seconds that were spent on the problem in all [s].
        verified: whether `Plan.verify` found nothing wrong with it; None if nobody asked.
    """

    problem: str
    bound: float
    bound_by: str
    length: float | None = None
    objective: float | None = None
    delta_v: float | None = None
    clearance: float | None = None
    planner: str | None = None
    seed: int | None = None
    seconds: float | None = None
    version: str | None = None
    lattice_objective: float | None = None
    lattice_optimum: float | None = None
    sha256: str | None = None
    tried: float = 0.0
    verified: bool | None = None

    @property
    def gap(self) -> float | None:
        """(objective - bound) / bound; None without a plan or with a bound of zero."""
        if self.objective is None or self.bound <= 0.0:
            return None
        return self.objective / self.bound - 1.0


class BestPlans:
    """All best plans of a set.

    Attributes:
        folder: of the set's data.
    """

    def __init__(self, folder: Path) -> None:
        """Read what is there.

        Args:
            folder: of the set's data.

        Raises:
            InvalidInput: a file of another format.
        """
        self.folder = folder
        self._plans = _read(folder / BEST)

    def get(self, name: str) -> BestPlan | None:
        """What is known of a problem, or None if nobody looked.

        Args:
            name: of the problem.

        Raises:
            InvalidInput: a name that is no text.
        """
        return self._plans.get(text("name", name))

    def trajectory(self, name: str) -> Trajectory:
        """The trajectory of the best plan of a problem.

        Args:
            name: of the problem.

        Raises:
            InvalidInput: no plan is known, or its file has changed.
        """
        known = [each for each, row in self._plans.items() if row.sha256 is not None]
        path = self._file(one_of("problem with a known plan", name, known))
        if file_digest(path) != self._plans[name].sha256:
            raise InvalidInput(f"trajectory '{path}'", "contents that changed", "an unchanged file")
        return read_numpy(path)

    def put(self, row: BestPlan, trajectory: Trajectory | None) -> None:
        """Keep what is known of a problem; the file with all of them is written anew.

        Args:
            row: its figures, without a digest.
            trajectory: of a better plan; None leaves the one that is there.
        """
        self._plans = _read(self.folder / BEST)  # another process may have written meanwhile
        digest = row.sha256
        if trajectory is not None:
            path = self._file(row.problem)
            path.parent.mkdir(parents=True, exist_ok=True)
            write_numpy(path, trajectory)
            digest = file_digest(path)
        self._plans[row.problem] = BestPlan(**(asdict(row) | {"sha256": digest}))
        lines = [json.dumps(asdict(self._plans[name])) for name in sorted(self._plans)]
        head = f'{{\n  "format": {json.dumps(FORMAT)},\n  "plans": [\n    '
        write_text("best plans", self.folder / BEST, head + ",\n    ".join(lines) + "\n  ]\n}\n")

    def _file(self, name: str) -> Path:
        return self.folder / "best" / f"{name}.npz"


def _read(path: Path) -> dict[str, BestPlan]:
    """The rows of a file; none where there is no file."""
    if not path.exists():
        return {}
    data = json.loads(read_text("best plans", path))
    if data.get("format") != FORMAT:
        raise InvalidInput(f"best plans '{path}'", data.get("format"), f"'{FORMAT}'")
    return {row["problem"]: BestPlan(**row) for row in data["plans"]}


def file_digest(path: Path) -> str:
    """SHA-256 of a file.

    Args:
        path: of the file.

    Raises:
        InvalidInput: it cannot be read.
    """
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise InvalidInput("file", str(path), f"a file that can be read ({error})") from None
