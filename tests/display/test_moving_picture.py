"""The moving picture of a plan repeats, moves, stays small and is reproducible."""

import numpy as np
import pytest
from PIL import Image, ImageSequence

import ffsr_plan as fp
from ffsr_plan.display.moving_picture import write_gif


def pictures(path):
    return [
        np.array(f.convert("RGB")).astype(int) for f in ImageSequence.Iterator(Image.open(path))
    ]


@pytest.fixture(scope="module")
def gif(fig2a_plan, tmp_path_factory):
    path = tmp_path_factory.mktemp("gif") / "plan.gif"
    write_gif(fig2a_plan, path, frames=12)
    return path


def test_the_picture_repeats_for_ever_and_is_small(gif):
    picture = Image.open(gif)
    assert picture.info["loop"] == 0
    assert picture.n_frames == 12
    assert picture.width == 720
    assert gif.stat().st_size < 1_500_000


def test_the_robot_moves_from_left_to_right(gif):
    first, *_, last = pictures(gif)
    columns = np.flatnonzero(np.abs(first - last).sum(axis=2)[:380].max(axis=0) > 150)
    assert columns[0] < 100
    assert columns[-1] > 600
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 60


def test_the_same_plan_gives_the_same_picture(fig2a_plan, gif, tmp_path):
    write_gif(fig2a_plan, tmp_path / "again.gif", frames=12)
    assert (tmp_path / "again.gif").read_bytes() == gif.read_bytes()


def test_scenes_without_obstacles_can_be_drawn(point, tmp_path):
    start, goal = point.configuration(), point.configuration((4, 0, 0))
    lattice = fp.Lattice(4, fp.Axis(1, 0.5))
    plan = fp.plan(fp.Problem(point, fp.Scene(), start, goal, lattice=lattice))
    for view in ("path", "side"):
        write_gif(plan, tmp_path / f"{view}.gif", frames=3, width=400, view=view)
        assert len(pictures(tmp_path / f"{view}.gif")) == 3


@pytest.mark.parametrize(
    "wrong", [{"frames": 1}, {"width": 10}, {"view": "top"}, {"path": "missing/plan.gif"}], ids=str
)
def test_invalid_arguments_are_refused(fig2a_plan, tmp_path, wrong):
    given = {"frames": 2, "width": 300, "path": "plan.gif", **wrong}
    with pytest.raises(fp.InvalidInput, match=next(iter(wrong))):
        write_gif(fig2a_plan, tmp_path / given.pop("path"), **given)
