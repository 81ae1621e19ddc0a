"""Exact lattice optimum by brute force: all edges certified, then a shortest path."""

import numpy as np


def optimum(roadmap):
    """Least F and its path over fully certified edges; (inf, None) if there is no path."""
    m, n, origin = roadmap.lattice.divisions, roadmap.lattice.size, roadmap.lattice.origin
    unit, near = roadmap.problem.length_unit, roadmap.node_costs()
    cost, paths = {origin: 0.0}, {origin: [origin]}
    for i in range(m):
        reached, ways = {}, {}
        for head in [origin] if i == m - 1 else range(n):
            if not roadmap.admissible[i + 1, head]:
                continue
            for tail, so_far in cost.items():
                if not roadmap.certify(i, tail, head).free:
                    continue
                new = so_far + roadmap.lattice.steps[tail, head] / unit
                new += near[i + 1, head] if i < m - 1 else 0.0
                if new < reached.get(head, np.inf):
                    reached[head], ways[head] = new, [*paths[tail], head]
        cost, paths = reached, ways
    return (cost[origin], np.array(paths[origin])) if origin in cost else (np.inf, None)


def first_layer_out_of_reach(roadmap):
    """The first layer of which no node can be reached over free edges, or None."""
    m, n, origin = roadmap.lattice.divisions, roadmap.lattice.size, roadmap.lattice.origin
    reached = {origin}
    for i in range(m):
        heads = [origin] if i == m - 1 else range(n)
        reached = {
            head
            for head in heads
            for tail in reached
            if roadmap.admissible[i + 1, head] and roadmap.certify(i, tail, head).free
        }
        if not reached:
            return i + 1
    return None
