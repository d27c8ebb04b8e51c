"""Planes of an atlas as the page asks for them, and the part of it that a page holds."""

import base64
import threading
import zlib
from concurrent.futures import CancelledError

import numpy as np
import pytest

import standfast as sf
from standfast.explore import embedding, opening, planes
from standfast.explore.planes import Planes

ANKLE, KNEE, HIP = "ankle_stiffness", "knee_stiffness", "hip_stiffness"
LENGTHS = {KNEE: 70, HIP: 71, ANKLE: 72, "gravity": 2}
SECONDS = 20.0  # after which a test that waits fails
QUANTITIES = ("stable", "safety_factor", "critical_ankle_stiffness")


@pytest.fixture(scope="module")
def atlas(tmp_path_factory):
    """An atlas of several chunks, of four axes, in which a threshold depends on three."""

    def axis(start, stop, name):
        return {"start": start, "stop": stop, "num": LENGTHS[name]}

    content = {
        "body": {"model": "edwards2007", "height": 1.753, "mass": 75.3},
        "gravity": [3.71, 9.81],
        "stiffness": {
            "knee": axis(800.0, 4000.0, KNEE),
            "hip": axis(100.0, 1500.0, HIP),
            "ankle": axis(300.0, 2000.0, ANKLE),
        },
        "output": {"quantities": list(QUANTITIES)},
    }
    return sf.sweep(content, tmp_path_factory.mktemp("planes") / "atlas.h5")


@pytest.fixture
def shown(atlas):
    found = Planes(atlas)
    yield found
    found.close()


def by_xarray_rules(atlas, quantity, x, y, at):
    """The plane out of the whole array, by the names of its axes."""
    variable = atlas[quantity]
    whole = np.asarray(variable)
    index = tuple(slice(None) if n in (x, y) else at[n] for n in variable.dims)
    left = [n for n in variable.dims if n in (x, y)]
    plane = np.zeros((len(atlas.axes[y]), len(atlas.axes[x])), whole.dtype)
    part = whole[index]
    for row in range(plane.shape[0]):
        for column in range(plane.shape[1]):
            place = {y: row, x: column}
            plane[row, column] = part[tuple(place[n] for n in left)]
    return plane


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize(("x", "y"), [(ANKLE, HIP), (HIP, ANKLE), (KNEE, HIP), ("gravity", ANKLE)])
def test_a_plane_is_that_of_the_whole_array(atlas, shown, quantity, x, y):
    assert atlas["safety_factor"].group.tile_count > 1
    at = {name: LENGTHS[name] - 1 for name in LENGTHS if name not in (x, y)}
    found = shown.plane(quantity, x, y, at)
    assert found.dtype == atlas[quantity].dtype
    np.testing.assert_array_equal(found, by_xarray_rules(atlas, quantity, x, y, at))


def test_every_place_of_a_slider_is_right_there_and_back(atlas, shown, monkeypatch):
    # room for two slabs of a few planes: others are read anew, and read ahead
    monkeypatch.setattr(planes, "SLAB_BYTES", 8 * 70 * 71 * 9)
    monkeypatch.setattr(planes, "KEPT_BYTES", 2 * 8 * 70 * 71 * 9)
    whole = np.asarray(atlas["safety_factor"])
    dims = atlas["safety_factor"].dims
    order = [dims.index(name) for name in ("gravity", ANKLE, HIP, KNEE)]
    whole = whole.transpose(order)
    for place in [*range(72), *range(71, -1, -1)]:
        found = shown.plane("safety_factor", KNEE, HIP, {ANKLE: place, "gravity": 1})
        np.testing.assert_array_equal(found, whole[1, place])
        assert shown.kept_bytes() <= planes.KEPT_BYTES


def test_the_slab_beside_is_read_ahead_where_the_slider_goes(shown):
    reads = []
    shown.reader.submit = lambda function, variable, slab, future: reads.append(slab[3])
    for place in (20, 19, 20):
        shown.plane("safety_factor", KNEE, HIP, {ANKLE: place, "gravity": 0})
    half = LENGTHS[ANKLE] // 2  # of a chunk
    assert [sorted(slab) for slab in reads] == [[(0, 2), (half, 2 * half)]]


def test_a_read_that_fails_once_is_done_again(shown, monkeypatch):
    read = planes.Variable.__getitem__
    failures = [OSError("the disk was asleep")]

    def once(variable, box):
        if failures:
            raise failures.pop()
        return read(variable, box)

    monkeypatch.setattr(planes.Variable, "__getitem__", once)
    asked = "stable", KNEE, HIP, {ANKLE: 3, "gravity": 0}
    with pytest.raises(OSError, match="asleep"):
        shown.plane(*asked)
    assert shown.plane(*asked).shape == (LENGTHS[HIP], LENGTHS[KNEE])


def test_who_waits_for_what_is_read_ahead_ends_with_the_planes(shown):
    def plane(place):
        return shown.plane("safety_factor", KNEE, HIP, {ANKLE: place, "gravity": 0})

    go = threading.Event()
    shown.reader.submit(go.wait, SECONDS)
    ended = []

    def wait():
        with pytest.raises(CancelledError):
            plane(LENGTHS[ANKLE] - 1)
        ended.append(True)

    for place in (0, 1):
        plane(place)
    waiting = threading.Thread(target=wait, daemon=True)
    waiting.start()
    waiting.join(0.2)
    assert waiting.is_alive()
    shown.close()
    waiting.join(SECONDS)
    go.set()
    assert ended


@pytest.mark.parametrize(("asked", "words"), [
    (("stabel", ANKLE, HIP, {}), "did you mean 'stable'"),
    (("stable", "ankle", HIP, {}), "no axis 'ankle'; did you mean 'ankle_stiffness'"),
    (("stable", HIP, HIP, {}), "given twice"),
    (("stable", ANKLE, HIP, {KNEE: 1}), "axis gravity is missing"),
    (("stable", ANKLE, HIP, {KNEE: 70, "gravity": 0}), "from 0 to 69"),
    (("stable", ANKLE, HIP, {KNEE: -1, "gravity": 0}), "-1 is not a place"),
    (("stable", ANKLE, HIP, {KNEE: 1.0, "gravity": 0}), "1.0 is not a place"),
    (("stable", ANKLE, HIP, {KNEE: True, "gravity": 0}), "True is not a place"),
    (("stable", ANKLE, HIP, {"height": 1}), "no axis 'height'"),
])  # fmt: skip
def test_what_cannot_be_shown_is_said(shown, asked, words):
    with pytest.raises(sf.InputError, match=words):
        shown.plane(*asked)


def start_in(study, place):
    return {name: axis[min(place, len(axis) - 1)].item() for name, axis in study.axes.items()}


def test_a_small_atlas_is_embedded_whole(atlas, shown):
    start = start_in(atlas.study, 0)
    places = embedding.thinned(atlas.study, QUANTITIES, (ANKLE, HIP), 10**9, start=start)
    assert opening.thinned_words(atlas.study, places, "1 GB") == ""
    texts = embedding.embedded(shown, QUANTITIES, (ANKLE, HIP), places)
    for name in QUANTITIES:
        raw = zlib.decompress(base64.b64decode(texts[name]))
        values = np.frombuffer(raw, atlas[name].dtype.newbyteorder("<")).reshape(atlas[name].shape)
        np.testing.assert_array_equal(values, np.asarray(atlas[name]))


def test_a_large_atlas_is_thinned_evenly_beside_its_map(atlas, shown):
    most = 2_000_000
    start = start_in(atlas.study, 0)
    places = embedding.thinned(atlas.study, QUANTITIES, (ANKLE, HIP), most, start=start)
    assert len(places[ANKLE]) == 72
    assert len(places[HIP]) == 71
    knees = places[KNEE]
    assert knees[0] == 0
    assert knees[-1] == 69
    assert np.ptp(np.diff(knees)) <= 1
    words = opening.thinned_words(atlas.study, places, "2 MB")
    assert words.startswith("To fit into 2 MB this page holds ")
    assert f"knee stiffness at {len(knees)} of 70 values" in words
    texts = embedding.embedded(shown, QUANTITIES, (ANKLE, HIP), places)
    size = 0
    for name in QUANTITIES:
        raw = zlib.decompress(base64.b64decode(texts[name]))
        size += len(raw)
        part = np.asarray(atlas[name])[np.ix_(*(places[axis] for axis in atlas[name].dims))]
        np.testing.assert_array_equal(np.frombuffer(raw, part.dtype).reshape(part.shape), part)
    assert 0.8 * most < size <= most


def test_a_plane_that_is_too_large_is_thinned_last(atlas):
    start, most = start_in(atlas.study, 50), 8 * 60 * 60
    places = embedding.thinned(atlas.study, ["safety_factor"], (ANKLE, HIP), most, start=start)
    # where one value is left it is that of the start, and not the first, at which most fall
    assert places[KNEE].tolist() == [50]
    assert places["gravity"].tolist() == [1]
    assert 50 < len(places[ANKLE]) < 72
