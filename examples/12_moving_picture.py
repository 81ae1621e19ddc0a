"""Write a plan as an animated GIF for slides and web pages.

The picture shows the robot among its obstacles, the trails of the ants, and in the panel below the
rotation of the base and the clearance. No browser is needed.

Writes `debris.gif`: through two thousand pieces of debris.
"""

import ffsr_plan as fp


def main() -> None:
    """Plan through debris and write the moving picture."""
    plan = fp.plan(fp.load_scenario("debris"), seed=0)
    print(f"{len(plan.problem.scene)} obstacles, length {plan.length:.2f} m")
    plan.write_gif("debris.gif", frames=60, width=720)


if __name__ == "__main__":
    main()
