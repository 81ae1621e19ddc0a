"""Compiled functions: lazy, callable from one another, with one notice per process."""

import os
import subprocess
import sys
import threading
import time

from ffsr_plan.core.kernels.compilation import inlined_kernel, kernel, notify_after


@inlined_kernel
def doubled(x: float) -> float:
    """Twice a number."""
    return 2.0 * x


@kernel
def incremented(x: float) -> float:
    """One more than twice a number."""
    return doubled(x) + 1.0


@kernel
def summed(count: int) -> float:
    """Sum of the above over the numbers below `count`."""
    total = 0.0
    for k in range(count):
        total += incremented(float(k))
    return total


@kernel
def factorial(n: int) -> int:
    """A kernel that calls itself."""
    return 1 if n < 2 else n * factorial(n - 1)


def test_kernels_call_one_another():
    assert summed(4) == 16.0
    assert incremented(2.0) == 5.0
    assert doubled(2) == 4.0
    assert factorial(5) == 120


def test_kernels_keep_name_and_documentation():
    assert summed.__name__ == "summed"
    assert summed.__doc__.startswith("Sum of")
    assert summed.py_func(4) == 16.0


def test_kernels_release_the_gil():
    summed(4)
    counted, done = 0, threading.Event()

    def work():
        summed(300_000_000)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        counted += 1
        time.sleep(0.001)
    thread.join()
    assert counted > 10


PROGRAM = """
import os, sys
from ffsr_plan.collision import nearest_obstacle_kernels
from ffsr_plan.collision.distances import ObstacleQuery
assert "numba" not in sys.modules
import numpy as np
import ffsr_plan as fp
robot = fp.load_robot("point")
scene = fp.Scene([[1, 0, 0], [2, 0, 0]], [0.1, 0.1])
for _ in range(2):
    fp.clearance(robot, scene, robot.neutral())
frame = np.zeros(15)
nearest_obstacle_kernels.distance_to_sphere(0, frame, np.zeros(3), scene.tree.spheres, 0)
"""


def test_the_notice_is_shown_once_and_only_to_compile(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    runs = [
        subprocess.run(
            [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True
        )
        for _ in range(2)
    ]
    assert [run.returncode for run in runs] == [0, 0], runs[0].stderr
    assert runs[0].stderr.count("ffsr-plan: compiling numerical kernels") == 1
    assert runs[1].stderr == ""


def test_a_notice_is_shown_after_a_while(capfd):
    with notify_after(0.05, "solving"):
        time.sleep(0.3)
    assert capfd.readouterr().err == "ffsr-plan: solving\n"
    with notify_after(60.0, "solving"):
        pass
    assert capfd.readouterr().err == ""
