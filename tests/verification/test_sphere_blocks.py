"""Spheres in blocks: none that can be the nearest one is passed over."""

import numpy as np
import pytest

from ffsr_plan.verification.distances.solid_distance_kernels import near_spheres
from ffsr_plan.verification.distances.sphere_blocks import BLOCK, sphere_blocks


def clustered(rng, count):
    """Dust in a few clusters of very different sizes, some large bodies, some at one place."""
    scales = 10.0 ** rng.uniform(-4, 1, (5, 1))
    which = rng.integers(0, 5, count)
    centers = rng.uniform(-8, 8, (5, 3))[which] + scales[which] * rng.normal(size=(count, 3))
    centers[rng.random(count) < 0.1] = centers[0]
    return centers, np.exp(rng.uniform(np.log(1e-3), np.log(2.0), count))


@pytest.mark.parametrize("count", [0, 1, BLOCK, BLOCK + 1, 5000])
def test_blocks_hold_every_sphere_once(count):
    centers, radii = clustered(np.random.default_rng(count), max(count, 1))
    centers, radii = centers[:count], radii[:count]
    blocks = sphere_blocks(centers, radii)
    rows = np.column_stack([centers, radii])
    own = np.column_stack([blocks.centers, blocks.radii])
    assert sorted(own.tolist()) == sorted(rows.tolist())
    assert len(blocks.largest) == -(-count // BLOCK)


@pytest.mark.parametrize("count", [1, BLOCK, BLOCK + 1, 5000])
def test_the_lists_are_those_of_all_spheres(count):
    rng = np.random.default_rng(count)
    centers, radii = clustered(rng, count)
    blocks = sphere_blocks(centers, radii)
    middles = np.vstack([rng.uniform(-9, 9, (40, 3)), centers[rng.integers(0, count, 10)]])
    reaches, sizes = rng.uniform(0, 0.5, 50), rng.uniform(0, 0.5, 50)
    numbers, starts = near_spheres(middles, reaches, sizes, blocks)
    for t, middle in enumerate(middles):
        distances = np.linalg.norm(blocks.centers - middle, axis=1) - blocks.radii
        limit = distances.min() + 2.0 * reaches[t] + sizes[t]
        found = numbers[starts[t] : starts[t + 1]]
        assert set(np.flatnonzero(distances < limit - 1e-12)) <= set(found)
        assert set(found) <= set(np.flatnonzero(distances < limit + 1e-12))
        assert len(set(found)) == len(found)


def test_neighbours_share_a_block():
    """In a cube of a hundred thousand spheres, blocks are hundreds of times smaller than it."""
    centers = np.random.default_rng(1).uniform(-1, 1, (100_000, 3))
    blocks = sphere_blocks(centers, np.ones(len(centers)))
    volumes = np.prod(blocks.highs - blocks.lows, axis=1)
    assert np.median(volumes) < 8.0 / 500.0
