"""Of all paths that are proven free, the best one is kept."""

import numpy as np

from ffsr_plan.time_limit.deadline import Deadline
from ffsr_plan.tree_search.proven_paths import ProvenPaths
from tests.helpers.free_scenes import scattered
from tests.tree_search.test_path_improvement import found


def test_the_best_proven_path_is_kept(robot):
    space, path, random = found(scattered(robot, 0))
    proven, worse = ProvenPaths(space, Deadline()), found(scattered(robot, 0))[1]
    path.move(random, 8000)
    assert proven.take(worse)
    first = proven.best.objective
    assert proven.take(path)
    assert proven.best.objective < first
    assert proven.take(worse)
    assert proven.best.objective < first
    assert np.isfinite(proven.reserve())
