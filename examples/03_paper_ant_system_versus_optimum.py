"""Compare the ant system of the paper with two other planners on the same problem.

`AntSystem` is the planner of the paper, `MaxMinAntSystem` the default one, and `LatticeOptimum`
finds the exact optimum of the lattice. All of them search the same lattice without refinement.
With other settings than the default ones, pass an object, for example `fp.AntSystem(ants=60)`.

Writes `convergence.png`: F of the paper's ant system over its cycles, against the optimum.
"""

import ffsr_plan as fp
from ffsr_plan.display import convergence_figure


def main() -> None:
    """Run three planners and draw the convergence of the first."""
    problem = fp.load_scenario("fig2a")
    names = ("ant-system", "max-min-ant-system", "lattice-optimum")
    plans = [fp.plan(problem, name, seed=0, refine=False) for name in names]

    print("planner                  L [m]       F      gap   time [s]")
    for plan in plans:
        print(
            f"{plan.planner.name:20} {plan.length:9.3f} {plan.objective:7.2f} "
            f"{plan.gap:8.2%} {plan.seconds:10.2f}"
        )
    convergence_figure(plans[0]).savefig("convergence.png", dpi=120)


if __name__ == "__main__":
    main()
