"""Run every notebook from top to bottom, without saving.

Usage: `python -m tools.run_notebooks`.
"""

import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient

FOLDER = Path(__file__).parent.parent / "notebooks"


def main() -> int:
    """Return 0 if there are notebooks and all of them run."""
    notebooks = sorted(FOLDER.glob("*.ipynb"))
    for path in notebooks:
        begin = time.monotonic()
        notebook = nbformat.read(path, as_version=4)
        client = NotebookClient(notebook, timeout=900, resources={"metadata": {"path": FOLDER}})
        client.execute()
        print(f"{path.name}: {time.monotonic() - begin:.0f} s")
    return 0 if notebooks else 1


if __name__ == "__main__":
    sys.exit(main())
