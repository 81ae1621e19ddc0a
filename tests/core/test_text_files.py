"""Text files: read with a clear error, written whole or not at all."""

import pytest

import ffsr_plan as fp
from ffsr_plan.core.text_files import read_text, write_text


def test_a_written_text_is_read_again(tmp_path):
    write_text("path", tmp_path / "a.txt", "zwölf\n")
    assert read_text("path", tmp_path / "a.txt") == "zwölf\n"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_a_failed_write_keeps_the_previous_file(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("before")
    (tmp_path / "a.txt.part").mkdir()
    with pytest.raises(fp.InvalidInput, match=r"path: got '.*a\.txt'; allowed: a file that can be"):
        write_text("path", path, "after")
    assert path.read_text() == "before"


def test_a_failed_write_leaves_no_unfinished_file(tmp_path):
    (tmp_path / "folder").mkdir()
    with pytest.raises(fp.InvalidInput, match="path"):
        write_text("path", tmp_path / "folder", "after")
    assert [p.name for p in tmp_path.iterdir()] == ["folder"]


def test_unreadable_files_are_named(tmp_path):
    (tmp_path / "latin.txt").write_bytes(b"\xff")
    for name, reason in (("none.txt", "No such file"), ("latin.txt", "utf-8")):
        with pytest.raises(fp.InvalidInput, match=f"srdf: got '.*{name}'; .*{reason}"):
            read_text("srdf", tmp_path / name)
