"""A file that brings HDF5 down costs a child its life, and the user one sentence."""

import subprocess
import sys

import pytest

import standfast as sf
from studies import changed

# What stands for a file that HDF5 fails on: the opening itself fails so.
SCRIPT = """
import os, signal, sys
from standfast.atlas import opening
from standfast.cli import app, first_look
first_look.MOST_SECONDS = 1
whole = opening.open_atlas
parent = os.getpid()

def crash(path):
    os.kill(os.getpid(), signal.SIGSEGV)

def loop(path):
    while True:
        pass

def take(path):
    with opening.opened(path):
        bytearray(3 * 2**30)

def fine(path):
    return whole(path)

def open_atlas(path):
    return whole(path) if os.getpid() == parent else globals()[sys.argv.pop()](path)

opening.open_atlas = open_atlas
app.run()
"""


@pytest.fixture(scope="module")
def small_atlas(tmp_path_factory):
    path = tmp_path_factory.mktemp("small") / "a.h5"
    sf.sweep(sf.Study.from_dict(changed("stiffness.hip", [100.0, 500.0])), path)
    return path


@pytest.mark.skipif(sys.platform != "linux", reason="limits a process as Linux does")
@pytest.mark.parametrize(
    ("how", "code", "said"),
    [
        ("crash", 2, "is damaged in a way that brings HDF5 down (SIGSEGV)"),
        ("loop", 2, "is damaged in a way that brings HDF5 down (SIGKILL)"),
        ("take", 2, "is damaged or cut short (MemoryError)"),
        ("fine", 0, ""),
    ],
)
def test_a_file_that_brings_hdf5_down_gets_a_sentence(small_atlas, how, code, said):
    script = SCRIPT.replace("sys.argv.pop()", repr(how))
    found = subprocess.run(
        [sys.executable, "-c", script, "info", str(small_atlas)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert found.returncode == code
    assert found.stderr == (f"standfast: {small_atlas} {said}\n" if said else "")
    assert bool(found.stdout) == (code == 0)
