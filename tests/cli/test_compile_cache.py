"""Compiled programs kept between commands: private, sound, and never in the way."""

import os
import random
import stat

import pytest

from standfast.cli import compile_cache
from standfast.cli.compile_cache import CHECKSUMS, FOLDER_OF_JAX, SWITCH, compiled_programs_kept


@pytest.fixture
def caches(tmp_path, monkeypatch):
    monkeypatch.delenv(FOLDER_OF_JAX, raising=False)
    monkeypatch.setenv(SWITCH, str(tmp_path / "caches"))
    monkeypatch.setattr(os, "environ", os.environ.copy())  # what a block sets ends with the test
    return tmp_path / "caches"


def folder_of_one_run(*written):
    """Enter and leave the block once; JAX would write ``written`` meanwhile."""
    os.environ.pop(FOLDER_OF_JAX, None)
    with compiled_programs_kept():
        folder = compile_cache.Path(os.environ[FOLDER_OF_JAX])
        there = {path.name: path.read_bytes() for path in folder.glob("*-cache")}
        for name, content in written:
            (folder / name).write_bytes(content)
    return folder, there


@pytest.mark.filterwarnings("ignore")
def test_what_is_written_is_there_the_next_time(caches):
    folder, there = folder_of_one_run(("a-cache", b"program"))
    assert there == {}
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert folder_of_one_run() == (folder, {"a-cache": b"program"})


@pytest.mark.parametrize("damage", ["bit", "cut", "empty", "stranger", "list"])
def test_what_is_not_as_it_was_written_is_removed(caches, damage):
    content = random.Random(7).randbytes(5000)  # noqa: S311 - a test's draws
    folder, _ = folder_of_one_run(("a-cache", content), ("b-cache", b"sound"))
    entry = folder / "a-cache"
    if damage == "bit":
        entry.write_bytes(bytes([content[0] ^ 1]) + content[1:])
    elif damage == "cut":
        os.truncate(entry, 4000)
    elif damage == "empty":
        os.truncate(entry, 0)
    elif damage == "stranger":  # written by a run that was killed
        entry.rename(folder / "c-cache")
    else:
        (folder / CHECKSUMS).write_bytes(b"\xff\xfe words")
    _, there = folder_of_one_run(("a-cache", b"compiled anew"))
    assert there == ({} if damage == "list" else {"b-cache": b"sound"})
    assert folder_of_one_run()[1]["a-cache"] == b"compiled anew"


def test_the_oldest_go_when_there_is_too_much(caches, monkeypatch):
    folder, _ = folder_of_one_run(*((f"{n}-cache", bytes(100)) for n in range(5)))
    for n in range(5):
        os.utime(folder / f"{n}-cache", (n, n))
    monkeypatch.setattr(compile_cache, "LARGEST_BYTES", 250)
    assert set(folder_of_one_run()[1]) == {"3-cache", "4-cache"}


def test_a_folder_that_is_not_the_users_alone_is_not_used(caches, tmp_path):
    folder, _ = folder_of_one_run(("a-cache", b"program"))
    folder.chmod(0o777)
    os.environ.pop(FOLDER_OF_JAX)
    with compiled_programs_kept():
        assert FOLDER_OF_JAX not in os.environ
    folder.chmod(0o700)
    folder.rename(tmp_path / "elsewhere")
    folder.symlink_to(tmp_path / "elsewhere")
    with compiled_programs_kept():
        assert FOLDER_OF_JAX not in os.environ


@pytest.mark.parametrize("setting", ["off", "/dev/null/no/folder"])
def test_it_can_be_switched_off_and_does_without_a_folder(caches, setting):
    os.environ[SWITCH] = setting
    with compiled_programs_kept():
        assert FOLDER_OF_JAX not in os.environ
    assert not caches.exists()


def test_a_users_own_folder_for_jax_is_left_alone(caches):
    os.environ[FOLDER_OF_JAX] = "mine"
    with compiled_programs_kept():
        assert os.environ[FOLDER_OF_JAX] == "mine"
    assert not caches.exists()
