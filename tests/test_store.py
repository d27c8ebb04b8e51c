"""The atlas file: same bytes always, whole or not there, readable anywhere, trusting nothing."""

import contextlib
import errno
import hashlib
import itertools
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5netcdf
import h5py
import netCDF4
import numpy as np
import pytest
import xarray

import standfast as sf
from standfast.engine import evaluator
from standfast.quantities import PARAMETERS, QUANTITIES
from standfast.store import workplace
from standfast.store.shards import is_valid, shard_path
from standfast.store.workplace import parts_of
from studies import GOOD, UNEQUAL, changed, several_shards

VERSION = sf.__version__
KILLS = 6
TESTS = Path(__file__).parent

RUN = (
    "import sys; sys.path.insert(0, {tests!r}); import studies, standfast as sf\n"
    "sf.sweep(sf.Study.from_dict(studies.several_shards()), sys.argv[1], {arguments})"
)


def process(output: Path, arguments: str = "") -> subprocess.Popen[bytes]:
    code = RUN.format(tests=str(TESTS), arguments=arguments)
    return subprocess.Popen([sys.executable, "-c", code, str(output)], stderr=subprocess.PIPE)


@pytest.fixture(scope="module")
def study():
    return sf.Study.from_dict(several_shards())


@pytest.fixture(scope="module")
def whole(study, tmp_path_factory):
    """An uninterrupted run's file, and its bytes."""
    path = tmp_path_factory.mktemp("whole") / "atlas.h5"
    sf.sweep(study, path)
    return path, path.read_bytes()


def test_nothing_but_the_atlas_and_its_story_is_left(whole):
    path, _ = whole
    assert {item.name for item in path.parent.iterdir()} == {"atlas.h5", "atlas.run.json"}
    story = json.loads((path.parent / "atlas.run.json").read_text())
    assert story["values"] == sf.open_atlas(path).study.points
    assert {"seconds", "machine", "versions", "values_per_second"} <= set(story)


def test_the_same_call_returns_the_finished_atlas(study, whole):
    path, content = whole
    before = path.stat().st_mtime_ns
    assert sf.sweep(study, path).study == study
    assert path.stat().st_mtime_ns == before
    assert path.read_bytes() == content


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_thread_count_is_irrelevant(study, whole, tmp_path, threads):
    sf.sweep(study, tmp_path / "a.h5", threads=threads)
    assert (tmp_path / "a.h5").read_bytes() == whole[1]


def test_order_of_parts_is_irrelevant_and_a_later_call_finishes_the_rest(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    for part in (3, 1):
        assert sf.sweep(study, path, part=(part, 3)) is None
        assert not path.exists()
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]
    assert not parts_of(path).exists()


def test_two_processes_share_the_work(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    runs = [process(path, f"part=({number}, 2)") for number in (1, 2)]
    for run in runs:
        _, message = run.communicate(timeout=120)
        assert run.returncode == 0, message.decode()
    calls = []
    sf.sweep(study, path, progress=lambda done, total: calls.append((done, total)))
    assert calls == []  # nothing was left to compute
    assert path.read_bytes() == whole[1]


def test_kills_at_random_moments_leave_no_trace(study, whole, tmp_path):
    """SIGKILL, resume, and again: the long form is benchmarks/kill.py."""
    rng = random.Random(7)  # noqa: S311 - a test's draws
    path = tmp_path / "a.h5"
    killed = finished = 0
    while killed < KILLS:
        run = process(path)
        deadline = time.monotonic() + rng.uniform(0.8, 4.0)
        while time.monotonic() < deadline and run.poll() is None:
            time.sleep(0.01)
            if path.exists():
                assert path.read_bytes() == whole[1]  # never a torn file under the final name
        run.kill()
        run.communicate()
        killed += run.returncode == -signal.SIGKILL
        if path.exists():
            finished += 1
            assert path.read_bytes() == whole[1]
            path.unlink()
            shutil.rmtree(parts_of(path), ignore_errors=True)
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


def damaged(path: Path, how: str) -> None:
    content = bytearray(path.read_bytes())
    if how == "torn":
        content = content[: len(content) // 2]
    elif how == "emptied":
        content = bytearray()
    elif how == "flipped":
        content[len(content) // 3] ^= 4
    elif how == "flipped header":
        content[30] ^= 1
    elif how == "longer":
        content += b"x"
    path.write_bytes(content)


@pytest.fixture
def begun(study, whole, tmp_path):
    """A folder with all shards but no finished file."""
    path = tmp_path / "a.h5"
    for part in (1, 2):
        sf.sweep(study, path, part=(part, 2))
    return path


@pytest.mark.parametrize("how", ["torn", "emptied", "flipped", "flipped header", "longer"])
def test_a_damaged_shard_is_detected_and_recomputed(study, whole, begun, how):
    folder = parts_of(begun)
    damaged(shard_path(folder, 2), how)
    assert not is_valid(folder, study, VERSION, 2)
    assert is_valid(folder, study, VERSION, 1)
    calls = []
    sf.sweep(study, begun, progress=lambda done, total: calls.append(total))
    inside = sum(study.groups[t.group].points for t in study.shard(2)[:1])
    assert 0 < calls[-1] < inside
    assert begun.read_bytes() == whole[1]


def test_a_foreign_shard_is_detected_and_recomputed(study, whole, begun, tmp_path):
    folder = parts_of(begun)
    other = sf.Study.from_dict(changed("gravity", 9.8, several_shards()))
    sf.sweep(other, tmp_path / "other.h5", part=(1, 1))
    shutil.copy(shard_path(parts_of(tmp_path / "other.h5"), 0), shard_path(folder, 0))
    shutil.copy(shard_path(folder, 1), shard_path(folder, 2))  # another place's shard
    assert not is_valid(folder, study, VERSION, 0)
    assert not is_valid(folder, study, VERSION, 2)
    sf.sweep(study, begun)
    assert begun.read_bytes() == whole[1]


def test_a_changed_study_is_refused_naming_what_changed(begun):
    content = several_shards()
    content["stiffness"]["knee"] = [700.0, 950.0]
    other = sf.Study.from_dict(content)
    with pytest.raises(sf.InputError) as caught:
        sf.sweep(other, begun)
    assert (
        "(knee_stiffness: [700, 900, 2000, inf] there, [700, 950] here); finish that one, "
        "remove the folder, or choose another output"
    ) in str(caught.value)


def test_another_studys_atlas_is_not_overwritten(whole, tmp_path):
    path = tmp_path / "a.h5"
    shutil.copy(whole[0], path)
    with pytest.raises(sf.InputError, match="is the atlas of another study"):
        sf.sweep(sf.Study.from_dict(GOOD), path)
    assert path.read_bytes() == whole[1]


def test_any_other_file_is_not_overwritten(study, tmp_path):
    path = tmp_path / "a.h5"
    path.write_text("my only copy")
    with pytest.raises(sf.InputError, match="is not an HDF5 file"):
        sf.sweep(study, path)
    assert path.read_text() == "my only copy"


def test_a_second_run_is_refused_while_the_first_holds_its_lock(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    refused = []

    def intrude(done, total):
        if refused:
            return
        for part in (None, (1, 2)):
            with pytest.raises(sf.InputError, match=r"is being written by another run \(process"):
                sf.sweep(study, path, part=part)
        refused.append(done)

    sf.sweep(study, path, progress=intrude)
    assert refused
    assert path.read_bytes() == whole[1]


def test_the_same_part_twice_is_refused(study, tmp_path):
    path = tmp_path / "a.h5"

    def intrude(forecast):
        with pytest.raises(sf.InputError, match="is being written by another run"):
            sf.sweep(study, path, part=(1, 3))

    sf.sweep(study, path, part=(1, 3), announce=intrude)


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


def test_a_full_disk_is_one_error_and_can_be_resumed(study, whole, small_disk):
    path = small_disk / "a.h5"
    ballast = small_disk / "ballast"

    def fill(forecast):
        free = shutil.disk_usage(small_disk).free
        ballast.write_bytes(b"x" * (free - 20_000_000))

    with pytest.raises(OSError, match=r".") as caught:
        sf.sweep(study, path, announce=fill)
    assert caught.value.errno == errno.ENOSPC
    assert not path.exists()
    assert not list(parts_of(path).glob("*.partial"))
    ballast.unlink()
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


def test_a_full_disk_at_the_very_end(study, whole, small_disk):
    """Room for the shards but not for the finished file beside them."""
    path = small_disk / "a.h5"
    ballast = small_disk / "ballast"
    sf.sweep(study, path, part=(1, 1))
    free = shutil.disk_usage(small_disk).free
    ballast.write_bytes(b"x" * (free - 10_000_000))
    with pytest.raises(OSError, match="no space left") as caught:
        sf.sweep(study, path)
    assert caught.value.errno == errno.ENOSPC
    assert not path.exists()
    ballast.unlink()
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


def test_a_study_that_does_not_fit_the_disk_is_refused_with_the_numbers(study, small_disk):
    (small_disk / "ballast").write_bytes(b"x" * 60_000_000)
    with pytest.raises(sf.InputError, match=r"needs about .* MB of disk .* and .* MB are free"):
        sf.sweep(study, small_disk / "a.h5")


def test_values_are_those_of_the_engine(study, whole):
    atlas = sf.open_atlas(whole[0])
    evaluate = evaluator(study)
    for index, group in enumerate(study.groups):
        for number in {0, group.tile_count - 1}:
            tile = study.tile(index, number)
            region = tuple(
                slice(first, first + side)
                for first, side in zip(group.start(tile), group.chunk_shape, strict=True)
            )
            for quantity, values in zip(group.quantities, evaluate(tile), strict=True):
                piece = atlas[quantity][region]
                inside = tuple(slice(0, n) for n in piece.shape)
                np.testing.assert_array_equal(piece, values[inside])


def readers(path: Path):
    """The same file through every program at hand: name, and a mapping of arrays."""
    with h5py.File(path, "r") as file:
        yield "h5py", {name: file[name][()] for name in file}
    for engine in ("h5netcdf", "netcdf4"):
        with xarray.open_dataset(path, engine=engine) as dataset:
            yield engine, {name: np.asarray(dataset[name]) for name in dataset.variables}
    with netCDF4.Dataset(path) as dataset:
        yield "netCDF4", {name: np.asarray(dataset[name][...]) for name in dataset.variables}
    with h5netcdf.File(path) as file:
        yield "h5netcdf", {name: file[name][...] for name in file.variables}


@pytest.fixture(scope="module")
def everything_in(tmp_path_factory):
    """An atlas of every quantity on axes of every kind."""
    return sf.sweep(sf.Study.from_dict(UNEQUAL), tmp_path_factory.mktemp("every") / "a.h5")


def test_other_programs_read_the_same_numbers(everything_in):
    atlas, study = everything_in, everything_in.study
    for program, arrays in readers(atlas.path):
        for quantity in study.quantities:
            np.testing.assert_array_equal(
                np.asarray(arrays[quantity]), np.asarray(atlas[quantity]), err_msg=program
            )
        for name, values in study.axes.items():
            if name != "body_model":
                np.testing.assert_array_equal(arrays[name], values, err_msg=program)


def test_labels_follow_the_conventions(everything_in):
    path, study = everything_in.path, everything_in.study
    with xarray.open_dataset(path, engine="h5netcdf") as dataset:
        assert dataset.attrs["Conventions"] == "CF-1.11"
        assert dataset.attrs["title"] == study.title
        assert dataset.attrs["study_sha256"] == study.fingerprint
        assert json.loads(dataset.attrs["study"]) == json.loads(study.canonical)
        for name in study.quantities:
            variable = dataset[name]
            assert variable.dims == study.axes_of(name)
            assert variable.attrs["units"] == QUANTITIES[name].unit
            assert variable.attrs["long_name"] == QUANTITIES[name].meaning
        for name in set(study.axes) - {"body_model"}:
            assert dataset[name].attrs["units"] == PARAMETERS[name].unit
        np.testing.assert_array_equal(dataset["stable"].attrs["flag_values"], [0, 1])
        assert dataset["stable"].attrs["flag_meanings"] == "unstable stable"
        assert list(dataset["body_model"].values) == ["de-leva-female", "winter"]


def test_single_values_are_scalar_coordinates(whole):
    with xarray.open_dataset(whole[0], engine="h5netcdf") as dataset:
        assert float(dataset["stable"].coords["height"]) == 1.75
        assert (
            float(dataset["stable"].coords["gravity"])
            == sf.Study.from_dict(GOOD | {"gravity": 9.80665}).fixed["gravity"]
        )


def test_only_built_in_filters_and_sensible_chunks(study, whole):
    with h5py.File(whole[0], "r") as file:
        for group in study.groups:
            for name in group.quantities:
                dataset = file[name]
                assert dataset.compression == "gzip"
                assert dataset.shuffle == (dataset.dtype.itemsize > 1)
                assert not dataset.fletcher32
                chunk = int(np.prod(dataset.chunks)) * dataset.dtype.itemsize
                assert chunk <= 2 * 2**20
                if group.tile_count > 1:
                    assert chunk >= 2**20


def test_h5dump_reads_it(whole):
    program = shutil.which("h5dump")
    if program is None:
        pytest.skip("h5dump is not installed")
    result = subprocess.run(
        [program, "-d", "/critical_hip_stiffness", "-s", "0,100,0", "-c", "1,1,1", str(whole[0])],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    with h5py.File(whole[0], "r") as file:
        value = float(file["critical_hip_stiffness"][0, 100, 0])
    shown = result.stdout.split("(0,100,0):")[1].split()[0]
    assert float(shown) == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize(
    "index",
    [
        ..., 0, -1, (0, 1), (slice(None), 2), (..., slice(100, 900, 7)), (slice(1, 3), slice(0, 0)),
        (0, slice(500, 20), 3), (slice(None, None, 2), ..., 5), (2, slice(None, None, -1)),
        (0, 0, 0, 0), (0, [1, 5, 9]), (0, slice(None), 1, slice(890, 2000)),
    ],
)  # fmt: skip
def test_pieces_are_those_h5py_reads(whole, index):
    variable = sf.open_atlas(whole[0])["stability_determinant"]
    with h5py.File(whole[0], "r") as file:
        everything = file["stability_determinant"][...]
    np.testing.assert_array_equal(variable[index], everything[index])


@pytest.mark.parametrize("index", [7, (-9, 0), (0, 0, 0, 0, 0), "x", (..., ...), 2.5])
def test_an_impossible_index_is_an_index_error(whole, index):
    with pytest.raises(IndexError):
        sf.open_atlas(whole[0])["stable"][index]


def test_planes_go_through_the_whole_grid(whole):
    variable = sf.open_atlas(whole[0])["stable"]
    everything = np.asarray(variable)
    seen = 0
    for at, plane in variable.slabs(along=("ankle_stiffness", "hip_stiffness")):
        np.testing.assert_array_equal(plane, everything[at["bmi"], :, at["knee_stiffness"]])
        seen += 1
    assert seen == 3 * 4


def test_to_xarray_is_lazy_and_labelled(whole):
    dataset = sf.open_atlas(whole[0]).to_xarray()
    assert not dataset["stability_determinant"]._in_memory
    near = (
        dataset["critical_ankle_stiffness"]
        .sel(bmi=25.0, knee_stiffness=np.inf)
        .isel(hip_stiffness=-1)
    )
    assert float(near) == pytest.approx(
        float(sf.open_atlas(whole[0])["critical_ankle_stiffness"][1, 3, -1])
    )
    dataset.close()


def test_an_unknown_quantity_gets_a_sentence(whole):
    with pytest.raises(sf.InputError, match="did you mean 'stable'"):
        sf.open_atlas(whole[0])["stabel"]


@pytest.fixture(scope="module")
def small_atlas(tmp_path_factory):
    path = tmp_path_factory.mktemp("small") / "a.h5"
    content = changed("output.quantities", ["stable", "frequency"])
    sf.sweep(sf.Study.from_dict(changed("stiffness.hip", [100.0, 500.0, 900.0], content)), path)
    return path


def test_a_truncated_or_altered_file_gets_a_sentence_or_is_read(small_atlas, tmp_path):
    content = small_atlas.read_bytes()
    rng = random.Random(3)  # noqa: S311 - a test's draws
    path = tmp_path / "broken.h5"
    broken = [content[: int(len(content) * share / 40)] for share in range(40)]
    for _ in range(300):
        altered = bytearray(content)
        for _ in range(rng.randint(1, 4)):
            altered[rng.randrange(len(altered))] = rng.randrange(256)
        broken.append(bytes(altered))
    refused = 0
    for data in broken:
        path.write_bytes(data)
        try:
            atlas = sf.open_atlas(path)
            for quantity in atlas.quantities:
                np.asarray(atlas[quantity])
        except sf.InputError as error:
            refused += 1
            assert "\n" not in str(error)
    assert refused >= 40


def _rewrite(file: h5py.File, old: str, new: str) -> None:
    text = bytes(file.attrs["study"]).decode()
    assert old in text
    file.attrs["study"] = np.bytes_(text.replace(old, new).encode())


def hostile(path: Path, how: str) -> None:
    with h5py.File(path, "r+") as file:
        shape = file["stable"].shape
        if how in REPLACEMENTS:
            del file["stable"]
        REPLACEMENTS.get(how, ALTERATIONS.get(how))(file, shape)


def _virtual(file, shape):
    layout = h5py.VirtualLayout(shape, np.uint8)
    layout[...] = h5py.VirtualSource("/etc/passwd", "x", shape)
    file.create_virtual_dataset("stable", layout)


def _dataset(dtype="u1", grow=0, **storage):
    def make(file, shape):
        wider = tuple(n + grow for n in shape)
        file.create_dataset("stable", data=np.zeros(wider, dtype), chunks=wider, **storage)

    return make


# What takes the place of the dataset "stable".
REPLACEMENTS = {
    "missing": lambda file, shape: None,
    "external link": lambda file, shape: file.update(
        {"stable": h5py.ExternalLink("/etc/passwd", "/x")}
    ),
    "soft link": lambda file, shape: file.update({"stable": h5py.SoftLink("/frequency")}),
    "shape": _dataset(grow=1),
    "type": _dataset("f4"),
    "filter": _dataset(compression="lzf"),
    "holes": lambda file, shape: file.create_dataset("stable", shape, "u1", chunks=shape),
    "virtual": _virtual,
}
# What is done to the file's attributes.
ALTERATIONS = {
    "study": lambda file, shape: _rewrite(file, "winter", "summer"),
    "fingerprint": lambda file, shape: _rewrite(file, "A small", "A large"),
    "version": lambda file, shape: file.attrs.update({"format_version": 99}),
    "other format": lambda file, shape: file.attrs.update({"format": "something else"}),
    "study is a number": lambda file, shape: file.attrs.update({"study": 5}),
}


@pytest.mark.parametrize("how", [*REPLACEMENTS, *ALTERATIONS])
def test_a_hostile_file_is_refused_with_a_sentence(small_atlas, tmp_path, how):
    path = tmp_path / "hostile.h5"
    shutil.copy(small_atlas, path)
    hostile(path, how)
    with pytest.raises(sf.InputError) as caught:
        sf.open_atlas(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_every_quantity_alone_makes_an_atlas(tmp_path):
    for quantity in QUANTITIES:
        study = sf.Study.from_dict(changed("output.quantities", [quantity]))
        atlas = sf.sweep(study, tmp_path / f"{quantity}.h5")
        values = np.asarray(atlas[quantity])
        assert values.shape == tuple(len(study.axes[axis]) for axis in study.axes_of(quantity))


def test_shards_in_any_order_make_the_same_file(study, whole, tmp_path):
    count = len(study.shards)
    for number, order in enumerate(
        itertools.islice(itertools.permutations(range(1, count + 1)), 1, 700, 350)
    ):
        path = tmp_path / f"{number}.h5"
        for part in order:
            sf.sweep(study, path, part=(part, count))
        sf.sweep(study, path)
        assert path.read_bytes() == whole[1]


def test_an_interrupted_run_goes_on_where_it_was(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    half = study.points // 2

    def interrupt(done, total):
        if done > half:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sf.sweep(study, path, progress=interrupt)
    totals = []
    sf.sweep(study, path, progress=lambda done, total: totals.append(total))
    assert totals[-1] < study.points
    assert path.read_bytes() == whole[1]


def test_the_lock_goes_with_the_process(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    run = process(path)
    while not (parts_of(path) / "lock").exists() and run.poll() is None:
        time.sleep(0.01)
    os.kill(run.pid, signal.SIGKILL)
    run.communicate()
    with contextlib.suppress(FileNotFoundError):
        path.unlink()
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]


def test_what_a_failed_finish_left_is_swept_away(study, whole, begun, monkeypatch):
    """Also when there is room for the file only once the leftover is gone."""
    folder = parts_of(begun)
    for name in (".atlas.partial", ".shard-000001.h5.99.partial"):
        (folder / name).write_bytes(b"x" * 1000)
    seen = []
    require = workplace._require_room
    monkeypatch.setattr(
        workplace, "_require_room",
        lambda place, size: seen.append(list(place.glob(".*.partial"))) or require(place, size),
    )  # fmt: skip
    sf.sweep(study, begun)
    assert seen == [[]]
    assert begun.read_bytes() == whole[1]


def test_a_finish_that_fails_leaves_the_shards_and_no_partial(study, whole, begun, monkeypatch):
    def fail(path):
        raise OSError(errno.EIO, "the disk said no")

    with monkeypatch.context() as patch:
        patch.setattr(workplace, "_sync_file", fail)
        with pytest.raises(OSError, match="the disk said no"):
            sf.sweep(study, begun)
    assert not begun.exists()
    assert not list(parts_of(begun).glob(".*.partial"))
    sf.sweep(study, begun)
    assert begun.read_bytes() == whole[1]


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"{}"])
def test_a_spoilt_study_file_is_written_again(study, whole, begun, content):
    (parts_of(begun) / "study.json").write_bytes(content)
    calls = []
    sf.sweep(study, begun, progress=lambda done, total: calls.append(total))
    assert calls == []  # the shards were still good
    assert begun.read_bytes() == whole[1]


def test_the_leftover_folder_of_a_finished_file_is_removed(study, whole, tmp_path):
    path = tmp_path / "a.h5"
    sf.sweep(study, path, part=(1, 3))
    shutil.copy(whole[0], path)
    assert parts_of(path).is_dir()
    sf.sweep(study, path)
    assert not parts_of(path).exists()


def test_a_newcomer_during_the_tidying_finds_a_lock_of_its_own(study, whole, tmp_path, monkeypatch):
    """The lock goes last; who opened it before it went must take a new one."""
    path = tmp_path / "a.h5"
    tidy = workplace._tidy

    def locked(folder):
        return workplace._locked(folder / "lock", workplace.fcntl.LOCK_EX, path)

    def crowded(folder):
        with pytest.raises(sf.InputError, match="is being written by another run"), locked(folder):
            pass
        tidy(folder)
        with locked(folder):
            assert (folder / "lock").read_text() == str(os.getpid())
            tidy(folder)

    monkeypatch.setattr(workplace, "_tidy", crowded)
    sf.sweep(study, path)
    assert path.read_bytes() == whole[1]
    assert not parts_of(path).exists()


def test_a_stale_lock_does_not_name_a_process_that_is_gone(study, tmp_path):
    path = tmp_path / "a.h5"

    def intrude(forecast):
        (parts_of(path) / "lock").write_text("99999999")
        with pytest.raises(sf.InputError, match="by another run; wait"):
            sf.sweep(study, path)

    sf.sweep(study, path, part=(1, 3), announce=intrude)


def test_ctrl_c_is_one_sentence_and_exit_code_1(tmp_path):
    big = tmp_path / "big.toml"
    big.write_text(
        "[body]\nheight = 1.75\nmass = 80\n[stiffness]\nknee = 2000\n"
        "ankle = { start = 0, stop = 2000, num = 9000 }\n"
        "hip = { start = 0, stop = 999, num = 9000 }"
        '\n[output]\nquantities = ["frequency"]\n'
    )
    command = [sys.executable, "-m", "standfast", "sweep", "big.toml"]
    for wait in (0.3, 1.5):
        run = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE)
        while not (tmp_path / "big.h5.parts" / "study.json").exists() and run.poll() is None:
            time.sleep(0.01)
        time.sleep(wait)
        run.send_signal(signal.SIGINT)
        _, message = run.communicate(timeout=60)
        assert run.returncode == 1
        assert b"Traceback" not in message
        assert b"stopped; what is done is kept in big.h5.parts. To go on: standfast" in message


@pytest.mark.parametrize("name", ["gravity", "body_model"])
def test_a_file_whose_study_lacks_a_parameter_is_refused(small_atlas, tmp_path, name):
    path = tmp_path / "hostile.h5"
    shutil.copy(small_atlas, path)
    with h5py.File(path, "r+") as file:
        content = json.loads(bytes(file.attrs["study"]))
        del content["parameters"][name]
        text = json.dumps(content, separators=(",", ":")).encode()
        file.attrs["study"] = np.bytes_(text)
        file.attrs["study_sha256"] = np.bytes_(hashlib.sha256(text).hexdigest().encode())
    with pytest.raises(sf.InputError, match="the study inside the file cannot be read"):
        sf.open_atlas(path)


def test_arrays_and_masks_index_as_in_h5py(whole):
    variable = sf.open_atlas(whole[0])["stable"]
    everything = np.asarray(variable)
    np.testing.assert_array_equal(variable[np.array([0, 2])], everything[[0, 2]])
    np.testing.assert_array_equal(variable[:, np.arange(5), 1], everything[:, :5, 1])


def test_no_threads_gets_a_sentence(study, tmp_path):
    with pytest.raises(sf.InputError, match="threads = 0 is not a number of threads"):
        sf.sweep(study, tmp_path / "a.h5", threads=0)
