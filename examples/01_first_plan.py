"""Plan a bundled scenario and write a page that plays the motion.

A robot with two arms passes six spheres. Thrusters move its base, the arms rotate it. The plan is
checked again by independent code before the page is written.

Writes `first_plan.html`: open it in a browser.
"""

import ffsr_plan as fp


def main() -> None:
    """Plan, verify and write the page."""
    problem = fp.load_scenario("fig2a")
    plan = fp.plan(problem, seed=0)
    print(f"length {plan.length:.2f} m, F {plan.objective:.1f}")
    print(f"gap to the exact optimum of the lattice: {plan.gap:.2%}")
    print(f"proven clearance along the whole motion: {plan.certificate.least_clearance:.3f} m")

    report = plan.verify()
    print(f"verified: {report.ok}, {report.samples} configurations checked")

    plan.write_html("first_plan.html", title="Past six spheres")


if __name__ == "__main__":
    main()
