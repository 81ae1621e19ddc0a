"""The package as its users get it: import, typing, wheel."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
HEAVY = (
    "matplotlib",
    "meshcat",
    "yourdfpy",
    "pydantic",
    "typer",
    "rich",
    "numba",
    "trimesh",
    "ruckig",
)


def test_importing_the_package_leaves_heavy_libraries_alone():
    code = f"import sys, ffsr_plan; print([m for m in {HEAVY!r} if m in sys.modules])"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


def test_what_the_package_promises_is_there():
    import ffsr_plan

    for name in ffsr_plan.__all__:
        assert getattr(ffsr_plan, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'fly'"):
        _ = ffsr_plan.fly
    assert (Path(ffsr_plan.__file__).parent / "py.typed").exists()


OUTSIDE = """
import ffsr_plan as fp, pathlib, sys
assert pathlib.Path(fp.__file__).is_relative_to(sys.prefix), fp.__file__
assert fp.robot_names() == ["planar_dual_arm", "point", "satellite_ur5", "spatial_dual_arm"]
scenario = fp.Scenario.load("fig2b")
plan = fp.plan(scenario.problem, fp.AntSystem(cycles=2), 0)
assert plan.verify(20).ok
plan.write_html("plan.html")
"""


@pytest.mark.slow
def test_the_built_wheel_plans_in_a_new_environment(tmp_path):
    quiet = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}

    def run(*command):
        subprocess.run(command, check=True, cwd=tmp_path, env=quiet, capture_output=True)

    run(sys.executable, "-m", "build", "--wheel", "--outdir", tmp_path, ROOT)
    (wheel,) = tmp_path.glob("*.whl")
    run(sys.executable, "-m", "venv", tmp_path / "venv")
    run(tmp_path / "venv/bin/pip", "install", "--quiet", "--no-compile", wheel)
    run(tmp_path / "venv/bin/python", "-c", OUTSIDE)
    run(tmp_path / "venv/bin/ffsr-plan", "plan", "fig2b", "--out", "results")
    assert (tmp_path / "results" / "path.png").stat().st_size > 1000
