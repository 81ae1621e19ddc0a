"""Plan files of scenes with bodies that move."""

import json
from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.plans import plan_file

FAR = (1.0 / 3.0, 400.0, 0.1)
SHAPES = [fp.Box([0.1, 2.0 / 3.0, 0.0], name="panel"), fp.Ball(0.7, (0.1, 0.0, 0.0))]
TIMES = np.linspace(0.0, 100.0, 4)
BODIES = (
    fp.MovingBody(SHAPES, fp.Drift((0.1, 1.0 / 7.0, 0.0)), FAR, (0.1, 0.2, 0.3), "debris"),
    fp.MovingBody(SHAPES, fp.Spin((0.0, 0.1, 1.0 / 7.0)), FAR),
    fp.MovingBody(SHAPES, fp.Tumble((1.0, 2.0, 2.5), (0.01, 1.0 / 30.0, 0.0)), FAR, name="target"),
    fp.MovingBody(
        SHAPES, fp.Track(TIMES, np.full((4, 3), 300.0), np.tile([0.0, 0.0, 0.6, 0.8], (4, 1)))
    ),
)


def moved(plan, bodies):
    scene = replace(plan.problem.scene, bodies=bodies)
    return replace(plan, problem=replace(plan.problem, scene=scene, duration=90.0, ramp=0.2))


def test_bodies_and_pace_are_saved_bit_for_bit(fig2a_plan, tmp_path):
    plan = moved(fig2a_plan, BODIES)
    plan.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded.problem.scene == plan.problem.scene
    assert (loaded.problem.duration, loaded.problem.ramp) == (90.0, 0.2)
    assert loaded == plan
    plan_file.write(loaded, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "plan.json").read_bytes()


def test_files_without_bodies_have_no_new_keys(fig2a_plan):
    data = fig2a_plan.to_dict()
    assert "bodies" not in data["problem"]["scene"]
    assert "duration" not in data["problem"]


def test_a_motion_that_is_a_function_is_not_saved(fig2a_plan):
    still = fp.PoseFunction(lambda _: (np.array(FAR), np.array([0.0, 0.0, 0.0, 1.0])), 0.0)
    with pytest.raises(fp.InvalidInput, match="a Track of sampled poses"):
        moved(fig2a_plan, [fp.MovingBody(SHAPES, still)]).to_dict()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda body: body["motion"].update(kind="drift"), "inertia"),
        (lambda body: body["motion"].update(kind="fall"), "kind"),
        (lambda body: body["motion"].update(inertia=[1.0, 1.0, 9.0]), "inertia"),
        (lambda body: body.update(motion=3), "a table with a kind"),
        (lambda body: body.update(shapes=[]), "shapes"),
        (lambda body: body.update(attitude=[0.0, 0.0, 0.0, 2.0]), "attitude"),
        (lambda body: body.pop("motion"), "motion"),
    ],
)
def test_a_body_that_is_wrong_is_refused(fig2a_plan, change, words):
    data = json.loads(json.dumps(moved(fig2a_plan, BODIES).to_dict()))
    change(data["problem"]["scene"]["bodies"][2])
    with pytest.raises(fp.InvalidInput, match=words):
        fp.Plan.from_dict(data)
