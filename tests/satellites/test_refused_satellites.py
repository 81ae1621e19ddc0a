"""Satellites that cannot be composed or saved are refused by name."""

import numpy as np
import pytest

import ffsr_plan as fp

BUS = fp.Bus(
    (1.0, 0.8, 1.2),
    150.0,
    inertia=(20.0, 25.0, 30.0),
    center_of_mass=(0.02, -0.01, 0.05),
    panels=[fp.Panel((0.7, 2.0, 0.02), (0.0, 1.5, 0.1), 9.0, (0.3, -0.2, 0.1))],
)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fp.compose(BUS, [fp.Mount("so100")] * 2), "so100, prefix '', links: got 'base,"),
        (lambda: fp.compose(BUS, [fp.Mount("pandas")]), "arm: got 'pandas'.*kinova.*mean 'panda'"),
        (lambda: fp.compose(BUS, [fp.Mount("nowhere/arm.urdf")]), "arm: got 'nowhere/arm.urdf'"),
        (lambda: fp.compose(BUS, [("so100", (0, 0, 0))]), r"arms: got .*Mount\('ur5', position="),
        (lambda: fp.compose(BUS, ["so100"]), "arms: got 'so100'"),
        (lambda: fp.compose(3, []), "bus: got 3"),
        (lambda: fp.compose(BUS, fp.Mount("so100")), "arms: got Mount"),
        (lambda: fp.compose(BUS, [], postures=["up"]), "postures: got"),
        (lambda: fp.compose(BUS, [], postures={"up": 3}), "postures: got"),
        (lambda: fp.compose(BUS, [], may_touch=[(1, 2)]), "may_touch: got"),
        (lambda: fp.compose(BUS, [], ""), "name: got ''"),
        (lambda: fp.compose(BUS, [], shapes="hulls"), "shapes: got 'hulls'; allowed: boxes"),
        (lambda: fp.compose(BUS, [], postures={"up": {"j": 0}}), "state 'up', joint: got 'j'"),
        (lambda: fp.compose(BUS, [], may_touch=[("bus", "arm")]), "link2: got 'arm'"),
        (lambda: fp.Mount("ur5", (0, np.nan, 0)), "position of a mount: .*finite"),
        (lambda: fp.Mount("ur5", (0, 2000, 0)), "position of a mount: .*at most 1000"),
        (lambda: fp.Mount("ur5", attitude=(0, np.inf, 0)), "attitude of a mount: .*finite"),
        (lambda: fp.Mount("ur5", prefix=3), "prefix of a mount: got 3"),
        (lambda: fp.Mount(3), "arm of a mount: got 3"),
        (lambda: fp.Mount("ur5", locked=["j"]), "locked of a mount: got"),
        (lambda: fp.Bus((1, 1, 1), 0.0), "mass of the bus: got 0.0; .*greater than 0"),
        (lambda: fp.Bus((1, 0, 1), 1.0), "size of the bus: .*greater than 0"),
        (lambda: fp.Bus((1, 1), 1.0), "size of the bus"),
        (lambda: fp.Bus((1, 1, 1), 1.0, (1, 1, 2.1)), "inertia of the bus: .*no two sum to less"),
        (lambda: fp.Bus((1, 1, 1), 1.0, (1, -1, 1)), "inertia of the bus: .*above 0"),
        (lambda: fp.Bus((1, 1, 1), 1.0, [[1, 1, 0], [0, 1, 1], [0, 0, 1]]), "bus: .*symmetric"),
        (lambda: fp.Bus((1, 1, 1), 1.0, panels=[3]), "panels.0 of the bus: got 3"),
        (lambda: fp.Bus((1, 1, 1), 1.0, [[1], [1, 2]]), "inertia of the bus: got"),
        (lambda: fp.Bus((1, 1, 1), 1.0, panels=3), "panels of the bus: got 3"),
        (lambda: fp.Panel((1, 1, 0.1), (0, 0, 0), -1.0), "mass of a panel: got -1.0"),
        (lambda: fp.Panel((1, 1, 0.0), (0, 0, 0), 1.0), "size of a panel"),
    ],
)
def test_what_cannot_be_composed_is_refused_by_name(make, message):
    with pytest.raises(fp.InvalidInput, match=message):
        make()


def test_a_panel_that_takes_a_links_name_is_refused():
    panel = fp.Panel((1, 1, 0.1), (0, 1, 0), 1.0, name="base")
    with pytest.raises(fp.InvalidInput, match="arm so100, prefix '', links: got 'base'"):
        fp.compose(fp.Bus((1, 1, 1), 10.0, panels=[panel]), [fp.Mount("so100")])


def test_robots_are_saved_only_as_urdf_files_that_can_be_written(tmp_path):
    robot = fp.compose(fp.Bus((1, 1, 1), 10.0), [])
    with pytest.raises(fp.InvalidInput, match=r"path: got .*ends in \.urdf"):
        robot.save(tmp_path / "robot.xml")
    with pytest.raises(fp.InvalidInput, match=r"path: got .*nowhere"):
        robot.save(tmp_path / "nowhere" / "robot.urdf")
    assert list(tmp_path.iterdir()) == []
