"""The one way to write a file: whole, or not there."""

import os
import socket

import pytest

from standfast.files import partial_name, whole_file


def test_a_failed_block_leaves_nothing_and_the_old_file(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("before")

    def fail():
        with whole_file(path) as partial:
            partial.write_text("half")
            raise RuntimeError("no")

    with pytest.raises(RuntimeError, match="no"):
        fail()
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_two_writers_at_once_do_not_meet(tmp_path):
    path = tmp_path / "a.txt"
    with whole_file(path, synced=True) as one:
        with whole_file(path) as other:
            assert one != other
            one.write_text("first")
            other.write_text("second")
        assert path.read_text() == "second"
    assert path.read_text() == "first"
    assert list(tmp_path.iterdir()) == [path]


def test_a_partial_name_carries_host_process_and_a_random_part(tmp_path):
    names = {partial_name(tmp_path / "a.h5").name for _ in range(10)}
    assert len(names) == 10
    for name in names:
        assert name.startswith(".a.h5.")
        assert f".{socket.gethostname().partition('.')[0]}.{os.getpid()}." in name
        assert name.endswith(".partial")
