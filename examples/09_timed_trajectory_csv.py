"""Turn a path into a trajectory with limits, and write it as a table for a controller.

The robot moves from rest to rest as fast as the limits allow. Every row of the table holds the
time, the base pose, the joints, their rates and accelerations, the thrust and the joint torques.

Writes `trajectory.csv` and `speeds.png`.
"""

import numpy as np
from matplotlib.figure import Figure

import ffsr_plan as fp


def main() -> None:
    """Plan, apply limits, write the table and draw the speeds."""
    plan = fp.plan(fp.load_scenario("fig2a"), seed=0)
    flight = plan.timed(joint_acceleration=0.1, thruster_acceleration=0.05, joint_velocity=0.2)
    print(f"duration {flight.duration:.1f} s, delta-v {flight.delta_v:.2f} m/s")
    flight.to_csv("trajectory.csv", rate=2.0)

    times = flight.clock(2.0)
    states = flight.at(times)
    figure = Figure(figsize=(7.0, 4.4), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(times, np.linalg.norm(states.velocities[:, :3], axis=1))
    upper.set_ylabel("speed of the base [m/s]")
    lower.plot(times, states.velocities[:, 6:], label=plan.problem.robot.joint_names)
    lower.set_ylabel("joint rates [rad/s]")
    lower.set_xlabel("time [s]")
    lower.legend(frameon=False, ncols=3, fontsize=8)
    figure.savefig("speeds.png", dpi=120)


if __name__ == "__main__":
    main()
