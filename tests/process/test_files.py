"""Watched files and folders of the user's cache (file_watch, cache_folder)."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from nau_py.process.cache_folder import make_cache_folder
from nau_py.process.file_watch import FileWatch


def test_changes_are_taken_once(tmp_path: Path) -> None:
    kept, later = tmp_path / "kept.txt", tmp_path / "later.txt"
    kept.write_text("a")
    watch = FileWatch({kept: "shader", later: "model"})
    assert not watch.has_changes()
    assert watch.take_settled_changes() == {}
    later.write_text("b")
    assert watch.has_changes()
    assert watch.take_changes() == {later: "model"}
    assert watch.take_changes() == {}
    kept.unlink()
    assert watch.take_settled_changes(lambda seconds: None) == {kept: "shader"}


def test_changes_survive_other_files(tmp_path: Path) -> None:
    """A change of a file that is still followed is not lost; a new file is no change."""
    one, two = tmp_path / "one", tmp_path / "two"
    one.write_text("a")
    watch = FileWatch({one: "x"})
    one.write_text("bb")
    two.write_text("c")
    watch.follow({one: "x", two: "y"})
    assert watch.take_changes() == {one: "x"}
    two.write_text("dd")
    watch.accept()
    assert watch.take_changes() == {}


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    return tmp_path / "home"


def test_the_cache_is_private(home: Path) -> None:
    old = home / ".cache" / "nau_py" / "things"
    old.mkdir(parents=True)
    old.chmod(0o777)
    folder = make_cache_folder("things")
    assert folder == old
    for path in (folder, folder.parent):
        assert stat.S_IMODE(path.stat().st_mode) == 0o700


def test_the_cache_is_absolute(home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert make_cache_folder("things") == home / ".cache" / "nau_py" / "things"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "elsewhere"))
    assert make_cache_folder("things") == tmp_path / "elsewhere" / "nau_py" / "things"


def test_a_cache_of_another_user_is_not_used(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert make_cache_folder("things") is not None
    monkeypatch.setattr(os, "getuid", lambda: os.stat(home).st_uid + 1)
    assert make_cache_folder("things") is None


def test_no_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert make_cache_folder("things") is None
