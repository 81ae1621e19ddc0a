"""Plan files of scenes with shapes and zones: bit for bit, and refused where they are wrong."""

import copy
import json
from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.plans import plan_file

FAR = (1.0 / 3.0, 40.0, 0.1)
BOX, BALL = fp.Box([0.1, 2.0 / 3.0, 0.0], FAR, [0.5, 0.1, 1e-9], "panel"), fp.Ball(0.7, FAR)
OTHERS = (
    fp.Capsule(0.2, 1.5, FAR, [0.1, 0.2, 0.3]),
    fp.Cylinder(0.2, 1.5, FAR, [0.4, 0.2, 0.3], "tank"),
    fp.Ellipsoid([0.2, 0.3, 1.0 / 7.0], FAR),
    fp.Hull(np.random.default_rng(3).normal(size=(40, 3)), FAR, [0.1, 0.2, 0.3], "rock"),
)
ZONES = (
    fp.Box([90.0, 99.0, 90.0], name="laboratory"),
    fp.Ball(80.0),
    fp.HalfSpace([0.3, 0.2, -0.4], [0.0, 0.0, -70.0]),
)


def with_scene(plan, **given):
    """The plan with other obstacles, far from its motion."""
    old = plan.problem.scene
    scene = fp.Scene(old.centers, old.radii, old.excess, old.sources, **given)
    return replace(plan, problem=replace(plan.problem, scene=scene))


@pytest.fixture(scope="module")
def shaped(fig2a_plan):
    return with_scene(fig2a_plan, shapes=[BOX, BALL, *OTHERS], keep_in=ZONES)


def test_shapes_and_zones_are_saved_bit_for_bit(shaped, tmp_path):
    shaped.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded.problem.scene == shaped.problem.scene
    assert loaded == shaped
    plan_file.write(loaded, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "plan.json").read_bytes()


def test_the_growth_of_shapes_is_saved(fig2a_plan):
    grown = with_scene(fig2a_plan, shapes=[BOX], growth=0.1)
    again = fp.Plan.from_dict(json.loads(json.dumps(grown.to_dict())))
    assert again.problem.scene.growth == 0.1
    assert again.problem.scene == grown.problem.scene


def test_files_of_spheres_alone_have_no_new_keys(fig2a_plan, shaped):
    scene = fig2a_plan.to_dict()["problem"]["scene"]
    assert list(scene) == ["centers", "radii", "excess", "sources"]
    assert list(shaped.to_dict()["problem"]["scene"]) == [*scene, "shapes", "keep_in"]
    (entry,) = with_scene(fig2a_plan, keep_in=ZONES[1:2]).to_dict()["problem"]["scene"]["keep_in"]
    assert entry == {"kind": "ball", "radius": 80.0, "position": [0.0, 0.0, 0.0], "name": ""}


WRONG = [
    (lambda s: s["shapes"][0].update(kind="cube"), r"shapes\.0\.kind: got 'cube'"),
    (lambda s: s["shapes"][0].pop("kind"), r"shapes\.0\.kind: got None"),
    (lambda s: s["shapes"][0]["size"].pop(), r"shapes\.0\.size"),
    (lambda s: s["shapes"][1].update(radius=-1.0), r"shapes\.1\.radius: got -1"),
    (lambda s: s["shapes"][1].update(radios=1.0), r"shapes\.1\.radios"),
    (lambda s: s["shapes"][0]["attitude"].__setitem__(0, 9.0), r"shapes\.0\.attitude"),
    (lambda s: s["shapes"][5]["points"].__setitem__(0, [0.0]), r"shapes\.5\.points"),
    (lambda s: s["shapes"].__setitem__(2, 3), r"shapes\.2: got 3"),
    (lambda s: s.update(shapes={}), r"shapes: got"),
    (lambda s: s.update(shapes="box"), r"shapes: got 'box'"),
    (lambda s: s["keep_in"][2].update(direction=[0.0, 0.0, 0.0]), r"keep_in\.2\.direction"),
    (lambda s: s["keep_in"][0].update(kind="capsule"), r"keep_in\.0\.kind: got 'capsule'"),
    (lambda s: s.update(growth=-0.1), r"growth: got -0\.1"),
]


@pytest.mark.parametrize(("change", "message"), WRONG, ids=[message for _, message in WRONG])
def test_wrong_shapes_are_refused_by_name(shaped, change, message):
    data = copy.deepcopy(shaped.to_dict())
    change(data["problem"]["scene"])
    with pytest.raises(fp.InvalidInput, match=rf"problem\.scene\.{message}"):
        fp.Plan.from_dict(data)
