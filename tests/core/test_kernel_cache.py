"""Machine code of kernels: never stale, in the cache directory, and no need for one."""

import os
import subprocess
import sys

import pytest

from ffsr_plan.core.kernels.kernel_cache import digest

TEXTS = {
    "low": "K = 1\n",
    "middle": "from ffsr_plan.low import K\nfrom ffsr_plan.constants import (\n    C,\n)\n",
    "high": "import ffsr_plan.middle\n",
    "side": "from ffsr_plan import high\n",
    "constants": "C = 1\n",
    "lazy": "def f():\n    from ffsr_plan.low import K\n",
}


@pytest.mark.parametrize(
    ("changed", "stale"),
    [
        ("low", {"low", "middle", "high", "side"}),
        ("middle", {"middle", "high", "side"}),
        ("high", {"high", "side"}),
        ("constants", {"constants", "middle", "high", "side"}),
        ("lazy", {"lazy"}),
    ],
)
def test_a_change_makes_all_kernels_above_it_stale(tmp_path, changed, stale):
    package = tmp_path / "ffsr_plan"
    package.mkdir()
    for name, text in TEXTS.items():
        (package / f"{name}.py").write_text(text)
    files = {name: str(package / f"{name}.py") for name in TEXTS}
    before = {name: digest(file, package) for name, file in files.items()}
    (package / f"{changed}.py").write_text(TEXTS[changed] + "# changed\n")
    digest.cache_clear()
    after = {name: digest(file, package) for name, file in files.items()}
    assert {name for name in TEXTS if after[name] != before[name]} == stale


KERNEL = """
from ffsr_plan.core.kernels.compilation import kernel
@kernel
def doubled(x):
    return 2.0 * x
print(doubled(4.0))
"""
PROGRAM = """
import importlib.util, sys
spec = importlib.util.spec_from_file_location("ffsr_plan.made", sys.argv[1])
module = sys.modules["ffsr_plan.made"] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)
"""


def run(folder, cache=None):
    """Run a module of the package with a kernel of its own."""
    (folder / "made.py").write_text(KERNEL)
    environment = {**os.environ, "XDG_CACHE_HOME": str(cache or folder / "cache")}
    environment.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, "-c", PROGRAM, str(folder / "made.py")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "8.0\n"), done.stderr
    return done.stderr


def test_code_is_kept_in_the_cache_directory_alone(tmp_path):
    assert "once after an installation" in run(tmp_path)
    assert run(tmp_path) == ""
    kept = [path for path in tmp_path.rglob("*") if path.suffix in (".nbi", ".nbc")]
    assert {path.suffix for path in kept} == {".nbi", ".nbc"}
    for path in kept:
        assert path.relative_to(tmp_path).parts[:3] == ("cache", "ffsr-plan", "kernels")


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
def test_damaged_code_is_compiled_again(tmp_path, suffix):
    run(tmp_path)
    for path in tmp_path.rglob(f"*.{suffix}"):
        path.write_bytes(path.read_bytes()[:40])
    assert "compiling" in run(tmp_path)
    assert run(tmp_path) == ""


def test_without_a_cache_directory_kernels_still_work(tmp_path):
    place = tmp_path / "file"
    place.write_text("")  # no folder can be made below it
    assert run(tmp_path, place).count("at every start") == 1
