"""Fold the arms to pass a gate that is too narrow for the spread arms.

Posture axes let the search displace the joints as well as the base. Here one axis folds the arms
towards the named posture `stowed`, a second one moves both elbows, and the goal demands an attitude
that only the motion of the arms can bring about.

Writes `gate.html` (page) and `gate.png` (figure).
"""

import numpy as np

import ffsr_plan as fp
from ffsr_plan.display import path_figure


def main() -> None:
    """Plan the scenario `gate`, with and without posture axes."""
    problem = fp.load_scenario("gate")
    plan = fp.plan(problem, seed=0)
    error = plan.arrival_attitude_error or 0.0
    print(f"length {plan.length:.2f} m, goal attitude missed by {np.degrees(error):.1e} degrees")
    plan.write_html("gate.html", title="Through the gate with folded arms")
    path_figure(plan).savefig("gate.png", dpi=120)

    straight = fp.Lattice(problem.lattice.divisions, problem.lattice.lateral)
    spread = fp.Problem(problem.robot, problem.scene, problem.start, problem.goal, lattice=straight)
    try:
        fp.plan(spread)
    except fp.NoPath as reason:
        print(f"without posture axes: {reason}")


if __name__ == "__main__":
    main()
