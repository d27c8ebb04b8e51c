"""A disk that is full: one sentence with the name that the user gave, and nothing left over."""

import errno
import shutil
import subprocess
import sys

import pytest

import standfast as sf
from populations import changed, of

STUDY = """
gravity = 9.8
[body]
model = "edwards2007"
height = 1.753
mass = 75.3
[stiffness]
ankle = { start = 0, stop = 2000, num = 101 }
knee = { start = 600, stop = 2000, num = 500 }
hip = { start = 0, stop = 2000, num = 101 }
"""


def leave(disk, size):
    """Fill a disk but for some bytes."""
    free = shutil.disk_usage(disk).free
    (disk / "ballast").write_bytes(bytes(free - size))


def full(disk, *arguments):
    """Run a command, in a process that may die of it; return its sentence."""
    result = subprocess.run(
        [sys.executable, "-m", "standfast", *arguments],
        cwd=disk.parent, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert result.returncode == 1, result.stderr
    assert result.stderr.startswith("standfast: No space left on device (disk/")
    assert result.stderr.count("\n") == 1
    assert ".partial" not in result.stderr
    assert [path.name for path in disk.iterdir()] == ["ballast"]
    return result.stderr


@pytest.mark.parametrize("left", [0, 300_000, 700_000, 1_300_000, 2_000_000])
def test_thresholds(small_disk, left):
    """HDF5 fails late, where h5py cannot raise, and may take the process down."""
    (small_disk.parent / "study.toml").write_text(STUDY)
    leave(small_disk, left)
    assert "study-thresholds." in full(small_disk, "thresholds", "study.toml", "-o", "disk")


def test_plot(small_disk):
    (small_disk.parent / "study.toml").write_text(STUDY.replace("500", "5"))
    sf.sweep(sf.Study.from_toml(small_disk.parent / "study.toml"), small_disk.parent / "a.h5")
    leave(small_disk, 20_000)
    assert "disk/a-limits.png" in full(small_disk, "plot", "a.h5", "-o", "disk")


def test_assess(small_disk):
    (small_disk.parent / "people.csv").write_text("height,mass\n" + "1.7,70\n" * 1000)
    leave(small_disk, 20_000)
    assert "disk/out.csv" in full(small_disk, "assess", "people.csv", "-o", "disk/out.csv")


@pytest.mark.parametrize("left", [300_000, 1_700_000, 2_300_000, 2_900_000])
def test_population(small_disk, left, capfd):
    """The disk fills up after the forecast; nothing is said but the error, and the run goes on."""
    study = of(changed("output.persons", True), size=40_000)
    path = small_disk / "a.h5"
    with pytest.raises(OSError, match=r".") as caught:
        sf.simulate(study, path, estimate=lambda forecast: leave(small_disk, left))
    assert caught.value.errno == errno.ENOSPC
    assert capfd.readouterr().err == ""
    assert not path.exists()
    assert not list(small_disk.rglob("*.partial"))
    (small_disk / "ballast").unlink()
    sf.simulate(study, path)
    sf.simulate(study, small_disk / "b.h5")
    assert path.read_bytes() == (small_disk / "b.h5").read_bytes()
