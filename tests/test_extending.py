"""A new quantity is one function and one row, a new parameter one row; nothing else is touched."""

from concurrent.futures import ThreadPoolExecutor

import h5py
import jax.numpy as jnp
import numpy as np
import pytest

import standfast as sf
from standfast.figures.atlas_figures import plot
from standfast.parameters import PARAMETERS, STIFFNESS_UNIT, Parameter
from standfast.quantities import QUANTITIES, Quantity

FLOOR = Parameter(
    "floor_stiffness",
    "K_f",
    STIFFNESS_UNIT,
    "rotational stiffness of the floor under both feet",
    0.0,
    1e6,
    section="floor",
    key="stiffness",
    default=1e5,
    unwritten=True,
)


def on_floor(person):
    """The ankle's and the floor's springs in series."""
    ankle, floor = person.stiffness.ankle, person.given["floor_stiffness"]
    return ankle * floor / (ankle + floor)


ROWS = (
    Quantity("stiffness_on_floor", "K_{af}", STIFFNESS_UNIT, "ankle and floor in series", on_floor,
             without=("knee_stiffness", "hip_stiffness")),
    Quantity("soft_share", "", "1", "what the floor takes", on_floor,
             lambda one, found: 1.0 - found / one.stiffness.ankle, dtype="float32"),
    Quantity("firm", "", "1", "the floor is the stiffer", on_floor,
             lambda one, found: jnp.where(found > 0.5 * one.stiffness.ankle, 1, 0),
             dtype="uint8", flags=("soft", "firm")),
)  # fmt: skip
STUDY = {
    "title": "On foam",
    "gravity": 9.81,
    "body": {"height": 1.7, "mass": 70.0},
    "stiffness": {
        "ankle": {"start": 100, "stop": 2000, "num": 13},
        "knee": [900.0, 2000.0],
        "hip": {"start": 100, "stop": 900, "num": 5},
    },
    "floor": {"stiffness": [500.0, 1000.0, 20_000.0]},
    "output": {"quantities": ["stable", *(row.name for row in ROWS)]},
}


@pytest.fixture(autouse=True)
def extended(monkeypatch):
    monkeypatch.setitem(PARAMETERS, FLOOR.name, FLOOR)
    for row in ROWS:
        monkeypatch.setitem(QUANTITIES, row.name, row)


def test_they_are_swept_stored_read_and_drawn(tmp_path):
    study = sf.Study.from_dict(STUDY)
    assert study.axes_of("stiffness_on_floor") == ("ankle_stiffness", "floor_stiffness")
    atlas = sf.sweep(study, tmp_path / "foam.h5")
    ankle = study.axes["ankle_stiffness"][:, None]
    floor = study.axes["floor_stiffness"][None, :]
    series = ankle * floor / (ankle + floor)
    np.testing.assert_allclose(np.asarray(atlas["stiffness_on_floor"]), series, rtol=1e-15)
    share = np.asarray(atlas["soft_share"])
    assert share.dtype == np.float32
    assert share.shape == (13, 2, 5, 3)
    wanted = np.broadcast_to((1.0 - series / ankle)[:, None, None, :], share.shape)
    np.testing.assert_allclose(share, wanted, rtol=1e-6)
    firm = np.asarray(atlas["firm"])
    assert firm.dtype == np.uint8
    assert np.array_equal(firm[:, 1, 2, :], series > 0.5 * ankle)
    with h5py.File(atlas.path) as file:
        assert file["firm"].attrs["flag_meanings"] == b"soft firm"
        assert file["floor_stiffness"].attrs["units"] == STIFFNESS_UNIT.encode()
    assert atlas.to_xarray().firm.dims[-1] == "floor_stiffness"
    assert sf.compute(study).identical(atlas.to_xarray().load())
    drawn = plot(atlas, tmp_path)
    names = {path.name for drawing in drawn for path in drawing.paths}
    assert {"foam-soft_share.png", "foam-stiffness_on_floor.png"} <= names


def test_a_study_that_does_not_name_it_is_as_before(tmp_path):
    """Its canonical text, so its fingerprint, and the default."""
    content = {key: value for key, value in STUDY.items() if key != "floor"}
    study = sf.Study.from_dict(content)
    assert "floor_stiffness" not in study.canonical
    assert sf.Study.from_canonical(study.canonical) == study
    atlas = sf.sweep(study, tmp_path / "a.h5")
    ankle = study.axes["ankle_stiffness"]
    series = ankle * 1e5 / (ankle + 1e5)
    np.testing.assert_allclose(np.asarray(atlas["stiffness_on_floor"]), series, rtol=1e-15)


def test_a_wrong_value_gets_its_sentence():
    with pytest.raises(sf.InputError, match=r"floor.stiffness = -1 is outside the allowed range"):
        sf.Study.from_dict({**STUDY, "floor": {"stiffness": -1.0}})
    with pytest.raises(sf.InputError, match=r"\[floor\] has no key 'stifness'; did you mean"):
        sf.Study.from_dict({**STUDY, "floor": {"stifness": 1.0}})


def hip_moment(person):
    """What the hip bears where the upper body leans forward by one degree."""
    loads = sf.stiffness_matrix(person.body, sf.Stiffness(0.0, 0.0, 0.0), person.gravity)
    return -loads[2, 2] * jnp.pi / 180.0


def test_a_quantity_of_ones_own_by_the_public_way(tmp_path, monkeypatch):
    row = sf.add_quantity(
        "hip_moment", hip_moment, unit="N·m", meaning="moment at the hip at a lean of 1°",
        without=("stiffness", "damping", "feedback"),
    )  # fmt: skip
    monkeypatch.setitem(QUANTITIES, "hip_moment", row)  # and gone after the test
    content = {
        "body": {"height": [1.5, 1.8], "mass": 70.0},
        "stiffness": {"ankle": [900.0, 1200.0], "knee": 1500.0, "hip": 400.0},
        "output": {"quantities": ["hip_moment", "stable"]},
    }
    found = sf.sweep(content, tmp_path / "a.h5").to_xarray()
    assert found.hip_moment.dims == ("height",)
    assert found.hip_moment.attrs["units"] == "N·m"
    for height in (1.5, 1.8):
        body = sf.Body.from_height_mass(height, 70.0)
        upper = 9.80665 * body.segment_mass[2] * body.segment_com[2]
        at = float(found.hip_moment.sel(height=height))
        np.testing.assert_allclose(at, np.radians(upper), rtol=1e-14)
    assert sf.compute(content).hip_moment.equals(found.hip_moment.load())
    again = sf.add_quantity("hip_moment", hip_moment, unit="N·m", meaning="the same, said anew")
    assert QUANTITIES["hip_moment"] is again


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"name": "stable"}, "stable is a quantity of standfast already; choose another name"),
        ({"name": "height"}, "height is a parameter; give the quantity another name"),
        ({"name": "hip moment"}, "name = 'hip moment' is not a name of a quantity"),
        ({"function": 3}, "function = 3 is not a function of a person"),
        ({"unit": None}, "unit = None is not one line of text"),
        ({"dtype": "int"}, "dtype = 'int' is not one of float64, float32, uint8"),
        ({"without": ("body",)}, "without has body, and every person has body and gravity"),
        ({"without": ("ankel_stiffness",)}, "without has 'ankel_stiffness', which is no parameter"),
    ],
)
def test_a_wrong_quantity_gets_its_sentence(changes, sentence):
    given = {"name": "mine", "function": hip_moment, "unit": "1", "meaning": "x", **changes}
    with pytest.raises(sf.InputError, match=sentence):
        sf.add_quantity(**given)
    assert "mine" not in QUANTITIES


GRID = {
    "body": {"height": [1.5, 1.8], "mass": 70.0},
    "stiffness": {"ankle": [900.0, 1200.0], "knee": 1500.0, "hip": 400.0},
    "output": {"quantities": ["mine"]},
}


@pytest.fixture
def mine():
    yield lambda function, **more: sf.add_quantity("mine", function, unit="1", meaning="x", **more)
    QUANTITIES.pop("mine", None)


@pytest.mark.parametrize(
    ("function", "more", "sentence"),
    [
        (lambda p: p.body.segment_mass, {}, r"mine: .* an array of shape \(3,\).* one number"),
        (lambda p: None, {}, "mine: its function returns NoneType; it must return one number"),
        (lambda p: "1", {}, "mine: its function returns str"),
        (lambda p: np.array("1"), {}, "mine: its function returns an array of <U1"),
        (lambda p: sf.modes(p.body, p.stiffness), {}, "mine: its function returns Modes"),
        (lambda p: float(p.gravity), {}, "of mine asks for the value of a traced.*jax.numpy"),
        (lambda p: 1.0 if p.gravity > 9 else 0.0, {}, "of mine asks for the value"),
        (lambda p: np.sin(p.stiffness.ankle), {}, "of mine asks for the value"),
        (lambda p: p.gravity * 1j, {}, "mine: its function returns a complex number"),
        (lambda p: -1.5, {"dtype": "uint8"}, "mine: its function returns float64, and dtype uint8"),
        (lambda p: p.nobody, {}, "the function of mine raises AttributeError"),
        (lambda p: 2.0 * p.stiffness.ankle, {"without": ("ankle_stiffness",)},
         "of mine raises TypeError: .*it is given no ankle_stiffness, which without names"),
    ],
)  # fmt: skip
def test_a_function_that_gives_no_number_is_refused_before_anything_is_stored(
    mine, tmp_path, function, more, sentence
):
    mine(function, **more)
    with pytest.raises(sf.InputError, match=sentence):
        sf.sweep(GRID, tmp_path / "a.h5")
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(sf.InputError, match=sentence):
        sf.compute(GRID)


def test_a_function_of_two_is_refused(mine):
    with pytest.raises(sf.InputError, match="of mine cannot be called with a person alone"):
        mine(lambda body, stiffness: 1.0)
    assert "mine" not in QUANTITIES


def test_truth_values_and_whole_numbers_are_stored(mine):
    mine(lambda p: p.stiffness.ankle > 1000.0, dtype="uint8", without=("hip_stiffness",))
    assert sf.compute(GRID).mine.values.tolist() == [[0, 1], [0, 1]]


def test_a_name_keeps_its_function(mine):
    """A file would not tell the two apart; the same lines run again are the same function."""
    one, again, other = (eval(f"lambda p: {number}") for number in (1.0, 1.0, 2.0))  # noqa: S307
    mine(one)
    mine(again)
    with pytest.raises(sf.InputError, match="mine has been added with another function"):
        mine(other)
    assert QUANTITIES["mine"].reference is again


def test_where_it_is_not_known_its_atlas_says_so(mine, tmp_path):
    mine(lambda p: p.gravity)
    atlas = sf.sweep(GRID, tmp_path / "a.h5")
    del QUANTITIES["mine"]
    with pytest.raises(sf.InputError, match=r"'mine' is no quantity of standfast.*sf.add_quantity"):
        sf.open_atlas(atlas.path)


def test_workers_of_an_executor_do_not_know_it(mine, tmp_path):
    mine(lambda p: p.gravity)
    with (
        ThreadPoolExecutor(1) as executor,
        pytest.raises(sf.InputError, match="mine is a quantity of your own, which workers"),
    ):
        sf.sweep(GRID, tmp_path / "a.h5", executor=executor)
    assert list(tmp_path.iterdir()) == []
