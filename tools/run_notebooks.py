"""Run notebooks from top to bottom: `python -m tools.run_notebooks [NAME ...]`.

Without names, all notebooks of the folder `notebooks` are run. Nothing is saved.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient

FOLDER = Path(__file__).parent.parent / "notebooks"
_CELL_TIMEOUT = 900  # [s]


def main(names: list[str]) -> int:
    """Run the notebooks.

    Args:
        names: file names without `.ipynb`; all notebooks if there are none.

    Returns:
        0 if all of them run, 1 if there is no notebook. A cell that fails raises an error.
    """
    notebooks = sorted(path for path in FOLDER.glob("*.ipynb") if path.stem in names or not names)
    for path in notebooks:
        begin = time.monotonic()
        notebook = nbformat.read(path, as_version=4)
        resources = {"metadata": {"path": FOLDER}}
        NotebookClient(notebook, timeout=_CELL_TIMEOUT, resources=resources).execute()
        print(f"{path.name}: {time.monotonic() - begin:.0f} s")
    return 0 if notebooks else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
