"""Files: text read with a clear error; files written whole or not at all, and together."""

import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

import ffsr_plan as fp
from ffsr_plan.core import text_files
from ffsr_plan.core.text_files import read_text, write_files, write_text


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_written_text_is_read_again(tmp_path):
    write_text("path", tmp_path / "a.txt", "zwölf\n")
    assert read_text("path", tmp_path / "a.txt") == "zwölf\n"
    assert names(tmp_path) == ["a.txt"]


def test_a_failed_write_changes_no_file_of_its_set(tmp_path):
    (tmp_path / "a.txt").write_text("before")
    (tmp_path / "folder").mkdir()
    contents = {tmp_path / "a.txt": "after", tmp_path / "new": b"x", tmp_path / "folder": "x"}
    with pytest.raises(fp.InvalidInput, match=r"path: got '.*folder'; .*\(Is a directory\)"):
        write_files("path", contents)
    assert (tmp_path / "a.txt").read_text() == "before"
    assert names(tmp_path) == ["a.txt", "folder"]


def test_a_full_disk_keeps_the_previous_file(tmp_path):
    code = (
        "import resource, pathlib\n"
        "from ffsr_plan.core.text_files import write_text\n"
        "import signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        "write_text('path', pathlib.Path('a.txt'), 'after' * 1000)\n"
    )
    (tmp_path / "a.txt").write_text("before")
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True
    )
    assert "InvalidInput: path: got 'a.txt'" in done.stderr
    assert "File too large" in done.stderr
    assert (tmp_path / "a.txt").read_text() == "before"
    assert names(tmp_path) == ["a.txt"]


def test_new_files_have_the_permissions_of_the_umask(tmp_path):
    before = os.umask(0o027)
    try:
        write_text("path", tmp_path / "a.txt", "text")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.txt").stat().st_mode) == 0o640


def test_a_replaced_file_keeps_its_permissions(tmp_path):
    (tmp_path / "a.txt").write_text("before")
    (tmp_path / "a.txt").chmod(0o604)
    write_text("path", tmp_path / "a.txt", "after")
    assert stat.S_IMODE((tmp_path / "a.txt").stat().st_mode) == 0o604


def test_a_symbolic_link_stays_one(tmp_path):
    (tmp_path / "folder").mkdir()
    for name, target in (("link", "folder/a.txt"), ("dangling", "folder/b.txt")):
        (tmp_path / name).symlink_to(target)
        write_text("path", tmp_path / name, name)
        assert (tmp_path / name).is_symlink()
        assert (tmp_path / target).read_text() == name


def test_streams_are_written_to_and_stay(tmp_path):
    write_text("path", Path(os.devnull), "text")
    assert stat.S_ISCHR(os.stat(os.devnull).st_mode)
    code = "import pathlib; from ffsr_plan.core.text_files import write_text\n"
    code += "write_text('path', pathlib.Path('/dev/stdout'), 'text')"
    with (tmp_path / "out").open("wb") as out:
        subprocess.run([sys.executable, "-c", code], stdout=out, check=True)
    assert (tmp_path / "out").read_text() == "text"


WRITER = """
import sys, pathlib
from ffsr_plan.core.text_files import write_text
while True:
    write_text("path", pathlib.Path("a.txt"), sys.argv[1] * 200_000)
"""


@pytest.fixture
def writer(tmp_path):
    """Starts processes that write a file `a.txt` for ever; they are killed in the end."""
    started = []

    def start(letter):
        process = subprocess.Popen(
            [sys.executable, "-c", WRITER, letter], cwd=tmp_path, stderr=subprocess.PIPE
        )
        started.append(process)
        while not (tmp_path / "a.txt").exists():
            time.sleep(0.01)
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()


def test_two_writers_of_one_file_neither_fail_nor_mix(tmp_path, writer):
    processes = [writer(letter) for letter in "xy"]
    until, seen = time.monotonic() + 2.0, set()
    while time.monotonic() < until:
        seen.add((tmp_path / "a.txt").read_text())
    assert seen <= {"x" * 200_000, "y" * 200_000}
    assert [process.poll() for process in processes] == [None, None]


def test_a_killed_writer_leaves_a_whole_file(tmp_path, writer):
    for _ in range(5):
        process = writer("x")
        time.sleep(0.05)
        process.kill()
        process.wait()
        assert (tmp_path / "a.txt").read_text() == "x" * 200_000
        (tmp_path / "a.txt").unlink()


def test_only_what_killed_writers_left_is_removed(tmp_path):
    old = time.time() - 3600.0
    for name in (".ffsr-plan-0123456789abcdef.part", ".ffsr-plan-mine.part", "notes.part"):
        (tmp_path / name).write_text("")
        os.utime(tmp_path / name, (old, old))
    (tmp_path / ".ffsr-plan-fedcba9876543210.part").write_text("being written")
    write_text("path", tmp_path / "a.txt", "text")
    expected = [".ffsr-plan-fedcba9876543210.part", ".ffsr-plan-mine.part", "a.txt", "notes.part"]
    assert names(tmp_path) == expected


def test_a_file_that_another_process_writes_is_not_removed(tmp_path):
    name = tmp_path / ".ffsr-plan-0123456789abcdef.part"
    with name.open("wb") as file:
        text_files._write(file, b"slowly", str(tmp_path / "a.txt"))
        os.utime(name, (0, 0))
        write_text("path", tmp_path / "b.txt", "text")
        assert name.exists()
    text_files._remove_stale.cache_clear()
    write_text("path", tmp_path / "b.txt", "text")
    assert not name.exists()


def test_ctrl_c_does_not_divide_a_set_of_files(tmp_path, monkeypatch):
    def interrupted(*arguments, replace=os.replace):
        signal.raise_signal(signal.SIGINT)
        replace(*arguments)

    monkeypatch.setattr(os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_files("path", {tmp_path / name: name for name in "abc"})
    assert names(tmp_path) == ["a", "b", "c"]


def test_ctrl_c_while_a_file_is_written_leaves_no_part_of_it(tmp_path, monkeypatch):
    def interrupted(*arguments, write=text_files._write):
        signal.raise_signal(signal.SIGINT)
        write(*arguments)

    monkeypatch.setattr(text_files, "_write", interrupted)
    handler = signal.signal(signal.SIGINT, lambda *_: ended.append(names(tmp_path)))
    ended: list[list[str]] = []
    try:
        write_files("path", {tmp_path / name: name for name in "ab"})
    finally:
        signal.signal(signal.SIGINT, handler)
    assert ended == [["a", "b"]]


def test_unreadable_files_are_named(tmp_path):
    (tmp_path / "latin.txt").write_bytes(b"\xff")
    for name, reason in (("none.txt", "No such file"), ("latin.txt", "utf-8")):
        with pytest.raises(fp.InvalidInput, match=f"srdf: got '.*{name}'; .*{reason}"):
            read_text("srdf", tmp_path / name)
