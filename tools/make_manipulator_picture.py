"""Draw the picture of the manipulator's tutorial: its plan at three times, in Chromium.

`python -m tools.make_manipulator_picture docs/manipulator.png`
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
import tempfile
import time
from pathlib import Path

from PIL import Image

from tests.helpers import chromium
from tests.helpers.documentation_pages import ROOT, blocks

SHARES = (0.0, 0.62, 1.0)  # of the motion at which it is drawn
WIDTH, GAP = 480, 8  # of a picture, and between two [px]
_SEEN = (0.18, 0.0, 0.78, 1.0)  # part of the window: left, top, right, bottom
_VIEW = """
for (const panel of document.querySelectorAll(".panel")) panel.style.display = "none";
viewer.set_property(["meshcat", "ghosts"], "visible", false);
viewer.camera.clearViewOffset();
viewer.camera.position.set(-0.8, 1.0, 1.9);
viewer.controls.target.set(0.1, 0.1, 0);
viewer.controls.update();
"""


def main(picture: str) -> None:
    """Run the tutorial, open the page that it writes, and write a picture of it to a file."""
    target = Path(picture).resolve()
    with tempfile.TemporaryDirectory() as folder:
        _run_tutorial(Path(folder))
        page = (Path(folder) / "grasp.html").as_uri()
        with chromium.opened(page, Path(folder)) as tab:
            tab.wait_until("document.title.startsWith('ready')")
            tab.ask(_VIEW)
            pictures = [_shot(tab, share, Path(folder) / "shot.png") for share in SHARES]
    height = pictures[0].height
    strip = Image.new("RGB", (len(pictures) * (WIDTH + GAP) - GAP, height), "white")
    for k, shot in enumerate(pictures):
        strip.paste(shot, (k * (WIDTH + GAP), 0))
    strip.save(target, optimize=True)


def _shot(tab: chromium.Tab, share: float, path: Path) -> Image.Image:
    """The seen part of the page at a share of the motion."""
    tab.ask(f"show({share}); viewer.set_dirty();")
    time.sleep(5.0)  # until it is drawn, by software
    tab.shoot(path)
    shot = Image.open(path).convert("RGB")
    left, top, right, bottom = _SEEN
    part = shot.crop((round(left * shot.width), round(top * shot.height),
                      round(right * shot.width), round(bottom * shot.height)))  # fmt: skip
    return part.resize((WIDTH, round(WIDTH * part.height / part.width)), Image.Resampling.LANCZOS)


def _run_tutorial(folder: Path) -> None:
    """Run the code of the page up to the one that writes the plan's page, in a folder."""
    names: dict[str, object] = {}
    before = Path.cwd()
    os.chdir(folder)
    try:
        for block in blocks(ROOT / "docs" / "howto" / "manipulator.md", "python"):
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile(block.text, "manipulator.md", "exec"), names)
            if "write_html" in block.text:
                return
    finally:
        os.chdir(before)


if __name__ == "__main__":
    main(sys.argv[1])
