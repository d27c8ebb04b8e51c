"""Reading an atlas: other programs, pieces, and files that cannot be trusted."""

import hashlib
import json
import random
import shutil
import subprocess
from pathlib import Path

import h5netcdf
import h5py
import netCDF4
import numpy as np
import pytest
import xarray

import standfast as sf
from standfast.engine.grid import Evaluator
from standfast.parameters import PARAMETERS
from standfast.quantities import QUANTITIES
from studies import GOOD, UNEQUAL, changed


def test_values_are_those_of_the_engine(study, whole):
    atlas = sf.open_atlas(whole[0])
    evaluate = Evaluator(study)
    for index, group in enumerate(study.grid.groups):
        for number in {0, group.tile_count - 1}:
            tile = study.grid.tile(index, number)
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
            assert variable.attrs["comment"] == QUANTITIES[name].meaning
            assert variable.attrs["long_name"] == name.replace("_", " ")
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
        for group in study.grid.groups:
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
    for at, plane in variable.planes(along=("ankle_stiffness", "hip_stiffness")):
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


def test_a_variable_says_what_it_is_in_one_line(whole):
    atlas = sf.open_atlas(whole[0])
    variable = atlas["stable"]
    text = repr(variable)
    assert "\n" not in text
    assert text.startswith(f"<Variable stable ({variable.dims[0]} {variable.shape[0]}")
    assert str(atlas.path) in text
    assert len(variable) == variable.shape[0]
    with pytest.raises(IndexError, match="indices are too many for"):
        variable[(0,) * (len(variable.shape) + 1)]
