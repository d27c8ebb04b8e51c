"""Files that are damaged, hostile or no files at all: one sentence, no wait, no gigabytes."""

import os
import shutil
import subprocess
import sys
import zlib

import h5py
import numpy as np
import pytest

import standfast as sf
from standfast.atlas.checking import reading
from standfast.atlas.encoding import decoded, encoded
from standfast.atlas.opening import open_atlas
from standfast.population.people.csv_table import read_table
from standfast.population.summary.file import is_population, open_population
from standfast.study.toml import read_toml
from studies import changed

READERS = [open_atlas, open_population, read_toml, read_table, sf.Study.from_toml]


@pytest.fixture(scope="module")
def small_atlas(tmp_path_factory):
    path = tmp_path_factory.mktemp("small") / "a.h5"
    content = changed("output.quantities", ["stable", "frequency"])
    sf.sweep(sf.Study.from_dict(changed("stiffness.hip", [100.0, 500.0, 900.0], content)), path)
    return path


@pytest.mark.parametrize("kind", ["pipe", "folder", "device"])
@pytest.mark.parametrize("read", READERS)
def test_what_is_no_plain_file_is_refused_at_once(tmp_path, read, kind):
    path = tmp_path / "x"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to("/dev/zero")
    with pytest.raises(sf.InputError, match=r"not a plain file|a folder"):
        read(path)
    assert not is_population(path)


LOCKER = """
import fcntl, sys
file = open(sys.argv[1], "rb")
fcntl.flock(file, fcntl.LOCK_EX)
print("locked", flush=True)
sys.stdin.read()
"""


def test_a_file_that_others_lock_is_read(small_atlas):
    command = [sys.executable, "-c", LOCKER, str(small_atlas)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as locker:
        assert locker.stdout.readline() == b"locked\n"
        with pytest.raises(OSError, match="lock"):
            h5py.File(small_atlas, "r")
        assert np.asarray(open_atlas(small_atlas)["stable"]).size
        locker.stdin.close()


def test_a_file_is_read_beside_other_readers(small_atlas):
    for locking in (None, False):
        with h5py.File(small_atlas, "r", locking=locking), open_atlas(small_atlas) as atlas:
            assert np.asarray(atlas["stable"]).size
            with reading(small_atlas):
                pass


def test_a_chunk_is_never_inflated_beyond_its_size():
    values = np.arange(1000.0)
    raw = encoded(values)
    np.testing.assert_array_equal(decoded(raw, values.dtype, values.shape), values)
    for wrong in (500, 999, 1001, 2000):
        with pytest.raises(ValueError, match="not of its size"):
            decoded(raw, values.dtype, (wrong,))
    with pytest.raises(ValueError, match="not of its size"):
        decoded(raw[:-4], values.dtype, values.shape)  # without its checksum


READ_WITHIN = """
import resource, sys
import numpy as np
import standfast as sf
from standfast.atlas.opening import open_atlas
atlas = open_atlas(sys.argv[1])
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 2**29, -1))
for index in (..., ([0, 1],), (0, [1])):
    try:
        atlas["stable"][index]
    except sf.InputError as error:
        print(error)
"""


def zeros_deflated(megabytes):
    """What zlib makes of so many megabytes of zeros; one is deflated, and its blocks repeated."""
    stream = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    one = stream.compress(bytes(2**20)) + stream.flush(zlib.Z_FULL_FLUSH)
    # the header, the blocks, an empty last block, and the checksum of Adler of zeros
    checksum = (megabytes * 2**20 % 65521 << 16) + 1
    return b"\x78\xda" + megabytes * one + stream.flush() + checksum.to_bytes(4, "big")


def test_zeros_deflated_are_what_zlib_reads():
    assert zlib.decompress(zeros_deflated(megabytes=3)) == bytes(3 * 2**20)


@pytest.mark.skipif(sys.platform != "linux", reason="limits memory as Linux does")
def test_a_chunk_of_gigabytes_is_refused_within_half_of_one(small_atlas, tmp_path):
    path = tmp_path / "bomb.h5"
    shutil.copy(small_atlas, path)
    bomb = zeros_deflated(megabytes=1536)
    assert len(bomb) < 2**21
    with h5py.File(path, "r+") as file:
        file["stable"].id.write_direct_chunk((0,) * file["stable"].ndim, bomb)
    found = subprocess.run(
        [sys.executable, "-c", READ_WITHIN, path], capture_output=True, text=True, check=True
    )
    said = f"{path} is damaged or cut short (a chunk is not of its size)\n"
    assert found.stdout == 3 * said


@pytest.mark.parametrize("storage", [{}, {"shuffle": True}, {"compression": "lzf"}])
def test_numbers_that_are_stored_another_way_are_refused(small_atlas, tmp_path, storage):
    path = tmp_path / "other.h5"
    shutil.copy(small_atlas, path)
    with h5py.File(path, "r+") as file:
        values, sides = file["frequency"][...], file["frequency"].chunks
        del file["frequency"]
        file.create_dataset("frequency", data=values, chunks=sides, **storage)
    with pytest.raises(sf.InputError, match="'frequency' is not as its study says"):
        open_atlas(path)


@pytest.mark.parametrize("left_out", [0b10, 0b01, 0b11])
def test_a_chunk_that_was_stored_without_deflating_is_read(small_atlas, tmp_path, left_out):
    """As HDF5 itself stores one that would grow; any other omission is refused."""
    path = tmp_path / "stored.h5"
    shutil.copy(small_atlas, path)
    values = np.asarray(open_atlas(path)["frequency"])
    with h5py.File(path, "r+") as file:
        dataset = file["frequency"]
        chunk = np.zeros(dataset.chunks)
        chunk[tuple(map(slice, values.shape))] = values
        planes = chunk[..., None].view(np.uint8).reshape(-1, 8).T
        dataset.id.write_direct_chunk((0,) * values.ndim, planes.tobytes(), left_out)
    if left_out == 0b10:
        np.testing.assert_array_equal(np.asarray(open_atlas(path)["frequency"]), values)
    else:
        with pytest.raises(sf.InputError, match="not shuffled"):
            np.asarray(open_atlas(path)["frequency"])


@pytest.mark.parametrize(
    "index",
    [
        [0, 2], [2, 0, 0], (slice(None), [5, 1, 800], 1), (0, slice(3, 900, 2), [0, 3]),
        (..., [-1, 0]), [True, False, True], (0, [1, 5, 9], 2, slice(None, None, -1)), (1, []),
    ],
)  # fmt: skip
def test_a_list_picks_what_numpy_picks(whole, index):
    variable = sf.open_atlas(whole[0])["stability_determinant"]
    everything = np.asarray(variable)
    items = index if isinstance(index, tuple) else (index,)
    wanted = everything
    if Ellipsis not in items:
        for axis in reversed(range(len(items))):  # one axis after the other, from the last
            item = np.array(items[axis], int) if items[axis] == [] else items[axis]
            wanted = wanted[(*(slice(None),) * axis, item)]
    else:
        wanted = everything[index]
    np.testing.assert_array_equal(variable[index], wanted)


def test_a_mask_of_all_values_picks_them(small_atlas):
    variable = open_atlas(small_atlas)["stable"]
    everything = np.asarray(variable)
    mask = everything == 1
    np.testing.assert_array_equal(variable[mask], everything[mask])


@pytest.mark.parametrize("index", [([0], [1]), (99, 0, [0]), [99], [0.5], [[0]], True])
def test_a_list_that_picks_nothing_sensible_is_an_index_error(whole, index):
    with pytest.raises(IndexError):
        sf.open_atlas(whole[0])["stable"][index]
