"""Plans touch nothing when they are flown by a small integrator and sampled densely."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.rotations import angle_between
from tests.helpers.dense_flight import flown, least_gap
from tests.helpers.free_scenes import beside_a_box, cup, gap, scattered


def problems():
    planar, arm = fp.load_robot("planar_dual_arm"), fp.load_robot("satellite_ur5")
    for seed in range(5):
        yield scattered(planar, 10 + seed)
    for seed in range(3):
        yield gap(planar, 10 + seed)
        yield beside_a_box(arm, 10 + seed)
    yield cup(planar)
    yield scattered(planar, 20, "attitude-held")


@pytest.mark.parametrize("until", ["first", "end"])
def test_flown_plans_touch_nothing(until):
    for seed, problem in enumerate(problems()):
        plan = fp.plan(problem, fp.TreePlanner(checks=400_000), seed, until=until)
        if problem.mode == "attitude-held":
            path = plan.at(np.linspace(0.0, 1.0, 24 * plan.motion.edges))
        else:
            path, arrival = flown(plan)
            assert angle_between(arrival, plan.configurations[-1, 3:7]) < 1e-6
            assert np.abs(path[-2, :3] - path[-1, :3]).max() < 0.2
        least, touching = least_gap(plan, path)
        assert not touching
        assert least > 0.0
        assert plan.certificate.least_clearance <= least + 1e-6
