"""Locks: by flock, by link where there is none, and never through what lies in the way."""

import errno
import fcntl
import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

import standfast as sf
from standfast.files import is_running
from standfast.run.folder import parts_of
from standfast.run.lock import BusyError, holders, locked

GONE = 2**22 + 1  # a process number that no process has
WITHOUT_FLOCK = [errno.ENOTSUP, errno.ENOLCK, 524]


@pytest.fixture(params=[None, *WITHOUT_FLOCK])
def disk(request, monkeypatch):
    """A file system with flock, or one that answers that it has none."""
    if request.param is not None:

        def refuse(file, operation):
            raise OSError(request.param, "no locks here")

        monkeypatch.setattr(fcntl, "flock", refuse)
    return request.param


def test_one_alone_or_many_together(disk, tmp_path):
    lock, target = tmp_path / "parts" / "lock", tmp_path / "a.h5"
    with locked(lock, target):
        for shared in (False, True):
            with (
                pytest.raises(BusyError, match="by another run"),
                locked(lock, target, shared=shared),
            ):
                pass
    with (
        locked(lock, target, shared=True),
        locked(lock, target, shared=True),
        pytest.raises(BusyError, match="by another run"),
        locked(lock, target),
    ):
        pass
    with locked(lock, target):
        pass


def test_who_holds_a_lock_is_named(disk, tmp_path):
    lock, target = tmp_path / "lock", tmp_path / "a.h5"
    name = f"process {os.getpid()} on {socket.gethostname()}"
    assert holders(tmp_path) == []
    with locked(lock, target):
        assert holders(tmp_path) == [name]
        with pytest.raises(BusyError, match=name), locked(lock, target):
            pass
    assert holders(tmp_path) == []


@pytest.mark.parametrize("code", WITHOUT_FLOCK)
def test_a_lock_by_link_outlives_no_process_of_this_host(code, tmp_path, monkeypatch):
    script = (
        "import fcntl, os, sys\n"
        f"def refuse(*_): raise OSError({code}, 'no locks here')\n"
        "fcntl.flock = refuse\n"
        "from pathlib import Path\n"
        "from standfast.run.lock import locked\n"
        "with locked(Path('lock'), Path('a.h5')): os.kill(os.getpid(), 9)\n"
    )
    subprocess.run([sys.executable, "-c", script], cwd=tmp_path, check=False)
    assert (tmp_path / "lock.alone").exists()  # it was killed while it held the lock
    monkeypatch.setattr(fcntl, "flock", lambda *_: (_ for _ in ()).throw(OSError(code, "no locks")))
    with locked(tmp_path / "lock", tmp_path / "a.h5"):
        assert holders(tmp_path) == [f"process {os.getpid()} on {socket.gethostname()}"]
    assert not (tmp_path / "lock.alone").exists()


@pytest.mark.parametrize("holder", [
    f"elsewhere {GONE} 5", "elsewhere.example 1 77", "nothing that we know",
])  # fmt: skip
def test_a_run_of_another_host_is_not_judged_dead(holder, tmp_path, monkeypatch):
    monkeypatch.setattr(
        fcntl, "flock", lambda *_: (_ for _ in ()).throw(OSError(errno.ENOLCK, "no locks"))
    )
    (tmp_path / "lock.alone").write_text(holder)
    with (
        pytest.raises(BusyError, match=r"certainly dead, remove .*lock\.alone"),
        locked(tmp_path / "lock", tmp_path / "a.h5"),
    ):
        pass
    (tmp_path / "lock.alone").write_text(f"{socket.gethostname()} {GONE} 5")  # it can pass
    with locked(tmp_path / "lock", tmp_path / "a.h5"):
        pass


def test_a_process_number_that_was_given_again_is_told_apart(tmp_path, monkeypatch):
    assert is_running(os.getpid())
    assert not is_running(GONE)
    monkeypatch.setattr(
        fcntl, "flock", lambda *_: (_ for _ in ()).throw(OSError(errno.ENOLCK, "no locks"))
    )
    # this process's number, but of a process that began at another time
    (tmp_path / "lock.alone").write_text(f"{socket.gethostname()} {os.getpid()} 12")
    with locked(tmp_path / "lock", tmp_path / "a.h5"):
        pass


def test_an_error_under_the_lock_is_itself(disk, tmp_path):
    for error in (FileNotFoundError("gone"), sf.InputError("no"), BlockingIOError(11, "busy")):
        with pytest.raises(type(error)) as caught, locked(tmp_path / "lock", tmp_path / "a.h5"):
            raise error
        assert caught.value is error


def test_a_lock_is_taken_through_no_link_pipe_or_folder(tmp_path):
    precious, lock = tmp_path / "precious", tmp_path / "lock"
    precious.write_text("my only copy")
    for make in (lambda: lock.symlink_to(precious), lambda: os.mkfifo(lock), lock.mkdir):
        make()
        with (
            pytest.raises(sf.InputError, match="is not the file of a lock; remove it"),
            locked(lock, tmp_path / "a.h5"),
        ):
            pass
        lock.rmdir() if lock.is_dir() else lock.unlink()
    assert precious.read_text() == "my only copy"


def test_a_sweep_without_flock_is_the_same_file(disk, study, whole, tmp_path):
    path = tmp_path / "a.h5"
    sf.sweep(study, path, part=(1, 2))
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]
    assert not parts_of(path).exists()
    assert [found.name for found in Path(tmp_path).iterdir() if found.suffix != ".json"] == ["a.h5"]
