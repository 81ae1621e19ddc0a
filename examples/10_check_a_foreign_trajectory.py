"""Check a joint trajectory of another program, base reaction included.

Only joint angles are given, as from a fixed-base planner. In the mode free-floating the motion of
the base follows from the conservation of momentum. `certify_edge` proves each piece and returns the
configuration that is really reached, from which the next piece starts.

Writes `check.csv`: for each piece the proven clearance, or the pair that collides.
"""

import csv

import numpy as np

import ffsr_plan as fp


def foreign_trajectory(samples: int = 60) -> np.ndarray:
    """(samples, 2) angles of the left shoulder and elbow [rad], as another program gives them."""
    s = np.linspace(0.0, 1.0, samples)
    return np.column_stack([-0.8 + 1.8 * s, -1.6 + 1.5 * np.sin(np.pi * s)])


def main() -> None:
    """Prove the pieces one after the other, up to the first collision."""
    robot = fp.load_robot("planar_dual_arm")
    scene = fp.Scene(centers=[[0.75, 1.15, 0.0], [0.0, -1.9, 0.0]], radii=[0.2, 0.3])
    names = ("left_1", "left_2")
    rows = foreign_trajectory()
    q = robot.configuration(joints=dict(zip(names, rows[0], strict=True)))

    with open("check.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["sample", "free", "proven clearance [m]", "link", "obstacle"])
        for k, values in enumerate(rows[1:], start=1):
            wanted = robot.configuration(joints=dict(zip(names, values, strict=True)))
            proof = fp.certify_edge(robot, scene, q, wanted, mode="free-floating")
            row = [k, proof.free, f"{proof.proven_clearance:.4f}", proof.link, proof.obstacle]
            table.writerow(row)
            if not proof.free:
                print(f"sample {k}: {proof.link} collides with obstacle {proof.obstacle}")
                return
            q = proof.arrival
    print(f"all {len(rows) - 1} pieces are proven free")


if __name__ == "__main__":
    main()
