"""Moving pictures of a flight keep its time, state their speed and are reproducible."""

import os
import shutil
import stat
import sys

import numpy as np
import pytest
from PIL import Image, ImageSequence

import ffsr_plan as fp
from ffsr_plan.display.flights import flight_movie
from ffsr_plan.display.flights.flight_samples import FlownProblem
from ffsr_plan.display.movie_files import LAST

PROGRAM = """#!{python}
import sys
data = sys.stdin.buffer.read()
size = sys.argv[sys.argv.index("-s") + 1]
rate = sys.argv[sys.argv.index("-r") + 1]
with open(sys.argv[-1], "wb") as file:
    file.write(f"{{len(data)}} {{size}} {{rate}}".encode())
sys.exit({code})
"""


@pytest.fixture
def program(tmp_path, monkeypatch):
    """A program by the name of ffmpeg that writes down what it is given, and may fail."""

    def install(code=0):
        path = tmp_path / "bin" / "ffmpeg"
        path.parent.mkdir(exist_ok=True)
        path.write_text(PROGRAM.format(python=sys.executable, code=code))
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("PATH", f"{path.parent}:{os.environ['PATH']}")

    return install


def durations(path):
    return [frame.info["duration"] for frame in ImageSequence.Iterator(Image.open(path))]


@pytest.mark.parametrize("suffix", ["gif", "png"])
@pytest.mark.parametrize("speed", [20, 37.5])
def test_a_movie_takes_the_time_of_the_flight_over_the_speed(flight, tmp_path, suffix, speed):
    path = tmp_path / f"flight.{suffix}"
    flight.write_movie(path, speed=speed, width=300)
    taken = 1e-3 * (sum(durations(path)) - LAST)
    assert taken == pytest.approx(flight.duration / speed, abs=0.05)
    picture = Image.open(path)
    assert picture.info["loop"] == 0
    assert picture.width == 300


def test_without_a_speed_a_movie_takes_at_most_twelve_seconds(flight, tmp_path):
    path = tmp_path / "flight.gif"
    flight.write_gif(path, width=300)
    assert flight.duration / 20 < 1e-3 * (sum(durations(path)) - LAST) + 0.05 <= 12.05


@pytest.mark.parametrize(
    ("speed", "stated"), [(1.0, ", true time"), (20.0, ", 20 × true time"), (0.5, "0.5 × true")]
)
def test_the_title_states_the_speed_and_the_curves_their_peaks(flight, speed, stated):
    flown = FlownProblem(flight.problem, flight.limits, flight)
    samples = flight_movie.sample_flight(flown, np.linspace(0.0, flight.duration, 5))
    scene = flight_movie._scene(flown, samples, np.eye(3), speed)
    assert stated in scene.title
    assert [curve.label.split(", ")[0] for curve in scene.curves] == [
        "speed of the base", "thrust / mass",
    ]  # fmt: skip
    assert scene.curves[1].label.endswith("up to 9.99 mm/s²")
    end = f"{flight.duration:.0f}"
    assert [row[0].text for row in scene.words][::4] == [f"0 of {end} s", f"{end} of {end} s"]


def test_the_same_flight_gives_the_same_movie_and_it_moves(flight, tmp_path):
    for name in ("a.gif", "b.gif"):
        flight.write_gif(tmp_path / name, speed=50)
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()
    first, *_, last = [
        np.array(frame.convert("RGB")).astype(int)
        for frame in ImageSequence.Iterator(Image.open(tmp_path / "a.gif"))
    ]
    columns = np.flatnonzero(np.abs(first - last).sum(axis=2)[:380].max(axis=0) > 150)
    assert columns[0] < 100
    assert columns[-1] > 600


def test_ffmpeg_receives_all_pictures_in_their_size_and_rate(flight, tmp_path, program):
    program()
    flight.write_movie(tmp_path / "flight.mp4", speed=50, width=301)
    flight.write_movie(tmp_path / "flight.gif", speed=50, width=301)
    count = Image.open(tmp_path / "flight.gif").n_frames + round(LAST / 80)
    size, sides, rate = (tmp_path / "flight.mp4").read_text().split()
    width, height = map(int, sides.split("x"))
    assert width == 300
    assert height % 2 == 0
    assert int(size) == count * 3 * width * height
    assert rate == "1000/80"


def test_an_ffmpeg_that_fails_is_reported(flight, tmp_path, program):
    program(code=3)
    with pytest.raises(fp.InvalidInput, match="ffmpeg failed"):
        flight.write_movie(tmp_path / "flight.mp4", speed=50, width=300)
    assert not (tmp_path / "flight.mp4").exists()


def test_mp4_without_ffmpeg_is_refused_before_anything_is_drawn(flight, tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(fp.InvalidInput, match="apt install ffmpeg"):
        flight.write_movie(tmp_path / "flight.mp4", speed=1e-9)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"path": "flight.avi"}, r"\.gif or \.png or \.mp4"),
        ({"speed": 0}, "speed"),
        ({"speed": 0.01}, "speed.*1200 pictures"),
        ({"width": 10}, "width"),
        ({"view": "top"}, "view.*path, side"),
    ],
)
def test_invalid_arguments_are_refused(flight, tmp_path, given, message):
    arguments = {"path": "flight.gif", **given}
    with pytest.raises(fp.InvalidInput, match=message):
        flight.write_movie(tmp_path / arguments.pop("path"), **arguments)


def test_a_gif_ends_in_gif(flight, tmp_path):
    with pytest.raises(fp.InvalidInput, match=r"ends in \.gif"):
        flight.write_gif(tmp_path / "flight.mp4")
