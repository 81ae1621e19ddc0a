"""The certificate of a path: what is said when its deadline passes."""

import numpy as np

import ffsr_plan as fp
from ffsr_plan.lattice.certificate import proven_clearance
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.proof.prover import Prover
from ffsr_plan.time_limit.deadline import Deadline


def test_a_clearance_that_is_cut_short_is_none_and_marked():
    problem, stopped = fp.load_scenario("fig2a"), []
    motion = LayeredLattice(problem).nominal
    deadline = Deadline(stop_requested=lambda: bool(stopped))
    prover = Prover(motion, problem.scene, problem.tolerance, deadline)
    still, clearances = np.zeros((motion.edges + 1, 3)), np.full(motion.edges + 1, 0.7)
    least, cut = proven_clearance(prover, still, clearances)
    assert 0.0 < least <= 0.7
    assert not cut
    stopped.append(True)
    assert proven_clearance(prover, still, clearances) == (0.0, True)
