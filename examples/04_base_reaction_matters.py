"""Fly a plan that was made for a held base with a base that reacts to the arms.

The plan is proven free if reaction wheels hold the attitude of the base. Without wheels the arms
rotate the base, so that the same joint and base motion sweeps other points, and collides.

Writes `base_reaction.png`: the clearance along the motion in both cases.
"""

import numpy as np
from matplotlib.figure import Figure

import ffsr_plan as fp

FOLDED = {"left_1": -0.6, "left_2": -0.9, "right_1": 0.6, "right_2": 0.9}


def main() -> None:
    """Plan with the attitude held, then prove each edge with the attitude free."""
    robot = fp.load_robot("planar_dual_arm")
    scene = fp.generators.scatter(9, (4, 9), (1.5, -2.0), (6.5, 2.0), (0.1, 0.35))
    start = robot.configuration(joints=FOLDED)
    goal = robot.configuration((8.0, 0.0, 0.0), joints=FOLDED | {"left_1": 0.7, "left_2": -1.7})
    lattice = fp.Lattice(32, fp.Axis(20, 0.1))
    problem = fp.Problem(robot, scene, start, goal, mode="attitude-held", lattice=lattice)
    plan = fp.plan(problem, fp.LatticeOptimum())

    flown = [plan.configurations[0]]
    for goal in plan.configurations[1:]:
        proof = fp.certify_edge(robot, scene, flown[-1], goal, mode="free-flying")
        if not proof.free:
            print(f"edge {len(flown)}: {proof.link} against obstacle {proof.obstacle}")
        flown.append(proof.arrival)

    figure = Figure(figsize=(7.0, 3.4), layout="constrained")
    axes = figure.add_subplot(xlabel="node", ylabel="clearance [m]")
    for name, nodes in (("attitude held", plan.configurations), ("attitude free", flown)):
        clearances = [float(fp.clearance(robot, scene, q)) for q in nodes]
        print(f"{name}: least clearance at a node {min(clearances):.3f} m")
        axes.plot(np.arange(len(clearances)), clearances, label=name)
    axes.axhline(0.0, color="black", lw=0.8)
    axes.legend(frameon=False)
    figure.savefig("base_reaction.png", dpi=120)


if __name__ == "__main__":
    main()
