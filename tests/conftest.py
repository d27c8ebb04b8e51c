"""Double precision for all tests, and one atlas of several shards for those of the store."""

import os
import shutil
import subprocess
import tempfile

import jax
import pytest

import standfast as sf
from studies import several_shards

# The package touches no flag of JAX; a program that traces it asks for double precision itself.
jax.config.update("jax_enable_x64", True)
# Commands that the tests run neither use nor fill the user's cache of compiled programs.
os.environ["STANDFAST_COMPILE_CACHE"] = "off"
FOLDER_OF_JAX = "JAX_COMPILATION_CACHE_DIR"


def pytest_configure(config):
    """What one process compiles the others load: workers of pytest, commands, executors.

    Only within a run, so that no program is older than the code under test.
    """
    if not hasattr(config, "workerinput"):
        os.environ[FOLDER_OF_JAX] = tempfile.mkdtemp(prefix="standfast-tests-")
        os.environ["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "0.05"
        os.environ["JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES"] = "-1"
        # OpenBLAS waits by spinning, so workers take the cores from each other: three files
        # of tests/stability on two cores beside other work took 33 s of CPU, and 14 s with one.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    jax.config.update("jax_compilation_cache_dir", os.environ[FOLDER_OF_JAX])
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.05)
    jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config):
    """One more than cores: tests wait for browsers, for disks, and for processes of their own."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return (cores or 1) + 1


def pytest_unconfigure(config):
    if not hasattr(config, "workerinput"):
        shutil.rmtree(os.environ[FOLDER_OF_JAX], ignore_errors=True)


@pytest.fixture(scope="session")
def study():
    return sf.Study.from_dict(several_shards())


@pytest.fixture(scope="session")
def whole(study, tmp_path_factory):
    """An uninterrupted run's file, and its bytes."""
    path = tmp_path_factory.mktemp("whole") / "atlas.h5"
    sf.sweep(study, path)
    return path, path.read_bytes()


@pytest.fixture
def begun(study, whole, tmp_path):
    """A folder with all shards but no finished file."""
    path = tmp_path / "a.h5"
    for part in (1, 2):
        sf.sweep(study, path, part=(part, 2))
    return path


@pytest.fixture
def small_disk(tmp_path):
    """A file system of its own, of 120 MB."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=120m", "tmpfs", str(place)],
        capture_output=True, check=False,
    )  # fmt: skip
    if mount.returncode != 0:
        pytest.skip("may not mount a file system here")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)
