"""The one way to write a file: whole, or not there."""

import os
import socket

import pytest

import standfast as sf
from standfast.files import nearest_file, partial_name, whole_file


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


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("atlas.tml", "atlas.toml"), ("atlas", "atlas.toml"), ("alas.toml", "atlas.toml"),
        ("us_adults.toml", "us-adults.toml"), ("coupling.toml", None), ("[!a].toml", None),
        ("elsewhere/atlas.toml", None),
    ],
)  # fmt: skip
def test_the_nearest_file_of_its_kind_is_named(tmp_path, given, meant):
    for name in ("atlas.toml", "atlas.h5", "us-adults.toml"):
        (tmp_path / name).touch()
    near = f"; did you mean {str(tmp_path / meant)!r}?" if meant else ""
    assert nearest_file(tmp_path / given, ".toml") == near


def test_what_is_not_there_is_looked_for_among_its_like(tmp_path):
    """A study among studies, an atlas among atlases, people among people's files."""
    for name in ("women.toml", "women.h5", "women.csv"):
        (tmp_path / name).touch()
    reading = {".toml": sf.Study.from_toml, ".h5": sf.open_atlas, ".csv": sf.assess}
    for suffix, read in reading.items():
        with pytest.raises(sf.InputError) as raised:
            read(tmp_path / f"womn{suffix}")
        sentence = str(raised.value)
        assert "there is no such" in sentence
        assert sentence.endswith(f"did you mean {str(tmp_path / f'women{suffix}')!r}?")
