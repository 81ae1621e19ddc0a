"""Files of moving pictures: animated GIF and PNG, and MP4 by the program ffmpeg."""

from __future__ import annotations

import io
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import write_files

if TYPE_CHECKING:
    from PIL import Image

    from ffsr_plan.core.arrays import Array

MOVIES = (".gif", ".png", ".mp4")
LAST = 1400  # [ms] for which the last picture is shown before all begins anew
_NO_FFMPEG = (
    ".gif or .png: MP4 needs the program ffmpeg, which is not found on this machine (on Debian and "
    "Ubuntu: apt install ffmpeg)"
)
_OF_FFMPEG = "-c:v libx264 -crf 18 -preset medium -pix_fmt yuv420p -movflags +faststart"
_SAME_BYTES = "-fflags +bitexact -flags:v +bitexact -threads 1"


def check_program(path: Path) -> None:
    """Check that a movie can be made, before it is drawn.

    Args:
        path: of the file.

    Raises:
        InvalidInput: MP4 on a machine without ffmpeg.
    """
    if path.suffix.lower() == ".mp4" and shutil.which("ffmpeg") is None:
        raise InvalidInput("path", str(path), _NO_FFMPEG)


def write_movie(path: Path, pictures: list[Image.Image], step: int, colours: Array) -> None:
    """Write pictures as a file that repeats for ever; an MP4 repeats if its player wants so.

    Args:
        path: of the file, with one of the endings `MOVIES`; an existing file is replaced.
        pictures: all of one size.
        step: time between two of them [ms].
        colours: (n, 3) that a palette has to hold, in [0, 1].

    Raises:
        InvalidInput: a file that cannot be written.
    """
    kind = path.suffix.lower()
    check_program(path)
    content = _mp4(pictures, step) if kind == ".mp4" else _animated(pictures, step, colours, kind)
    write_files("path", {path: content})


def _animated(pictures: list[Image.Image], step: int, colours: Array, kind: str) -> bytes:
    """An animated GIF or PNG."""
    from PIL.Image import Dither

    palette = _palette(pictures, colours)
    first, *rest = [picture.quantize(palette=palette, dither=Dither.NONE) for picture in pictures]
    durations = [step] * len(rest) + [LAST]
    content = io.BytesIO()
    first.save(
        content, format=kind[1:], save_all=True, append_images=rest, duration=durations, loop=0
    )
    return content.getvalue()


def _palette(pictures: list[Image.Image], colours: Array) -> Image.Image:
    """One palette for all pictures, so that the file stores static parts only once."""
    from PIL import Image

    fixed = np.unique(np.round(255.0 * colours).astype(int), axis=0)[:64]
    width, height = pictures[0].size
    chosen = pictures[:: max(1, len(pictures) // 6)]
    sheet = Image.new("RGB", (width, height * len(chosen)))
    for k, picture in enumerate(chosen):
        sheet.paste(picture, (0, k * height))
    common = sheet.quantize(190, method=Image.Quantize.MEDIANCUT).getpalette() or []
    palette = Image.new("P", (1, 1))
    palette.putpalette((fixed.ravel().tolist() + common)[: 3 * 256])
    return palette


def _mp4(pictures: list[Image.Image], step: int) -> bytes:
    """An MP4 of H.264, which has even numbers of pixels, with the last picture shown longer."""
    width, height = (2 * (length // 2) for length in pictures[0].size)
    frames = [picture.crop((0, 0, width, height)).tobytes() for picture in pictures]
    frames += frames[-1:] * round(LAST / step)
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "movie.mp4"
        raw = f"-f rawvideo -pix_fmt rgb24 -s {width}x{height} -r 1000/{step} -i -"
        command = ["ffmpeg", "-loglevel", "error", *raw.split(), *_OF_FFMPEG.split()]
        command += [*_SAME_BYTES.split(), str(target)]
        done = subprocess.run(command, input=b"".join(frames), capture_output=True)
        if done.returncode or not target.exists():
            reason = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
            allowed = f".gif or .png: ffmpeg failed ({' '.join(reason) or done.returncode})"
            raise InvalidInput("path", ".mp4", allowed)
        return target.read_bytes()
