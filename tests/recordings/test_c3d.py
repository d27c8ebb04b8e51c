"""A person's centre of pressure comes back out of a C3D file, however its plates lie."""

import io
import re

import numpy as np
import pytest

import standfast as sf
from c3d_files import MATRIX, Plate, person, write_c3d

c3d = pytest.importorskip("c3d")
ezc3d = pytest.importorskip("ezc3d")

TIME, FORCE, POINT = person()
# m: moments of 300,000 N·mm have half of 0.03 N·mm in float32, over 700 N; sums of two plates, of
# matrices and of sensors some of them
FLOAT32 = 2e-6
SHARE = 0.5 + 0.2 * np.sin(0.9 * TIME)
ASIDE = np.array([0.0, 0.15, 0.0])[:, None]
# Both feet: parallel forces F_k at points p_k with Σ F_k = F and Σ F_k p_k = F p.
FEET = [(SHARE * FORCE, POINT + (1 - SHARE) * 2 * ASIDE), ((1 - SHARE) * FORCE, POINT - SHARE * 2 * ASIDE)]  # fmt: skip
APART = ((0.0, 0.3, 0.0), (0.0, -0.3, 0.0))  # middles of two plates

ALONE = {
    "type 1": Plate(type=1),
    "type 2": Plate(),
    "type 3": Plate(type=3),
    "type 4": Plate(type=4),
    "turned": Plate(turned=0.7),
    "turned, of type 4, away from the laboratory's origin": Plate(4, (0.3, -0.2, 0.0), -2.1),
    "turned, of type 1": Plate(1, (0.05, -0.1, 0.0), 1.2),
    "turned, of type 3": Plate(3, (0.05, -0.1, 0.0), 2.5),
    "with transducers that are not below its middle": Plate(aside=(0.02, -0.03)),
}


def is_the_persons(found, ap=POINT[0], ml=POINT[1]):
    assert found.rate == 1000.0
    np.testing.assert_allclose(found.ap, ap, rtol=0, atol=FLOAT32)
    np.testing.assert_allclose(found.ml, ml, rtol=0, atol=FLOAT32)


@pytest.mark.parametrize("unit", ["mm", "m"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("name", ALONE)
def test_one_plate(tmp_path, name, sign, unit):
    path = write_c3d(tmp_path / "a.c3d", [ALONE[name]], [(FORCE, POINT)], sign=sign, unit=unit)
    is_the_persons(sf.read_recording(path))


def test_a_file_is_known_by_its_content_and_may_come_through_a_pipe(tmp_path, monkeypatch):
    path = write_c3d(tmp_path / "a.c3d", [Plate()], [(FORCE, POINT)])
    is_the_persons(sf.read_recording(path.rename(tmp_path / "recording.csv")))
    raw = (tmp_path / "recording.csv").read_bytes()
    monkeypatch.setattr("builtins.open", lambda *_, **__: io.BytesIO(raw))
    is_the_persons(sf.read_recording("-"))


TWO = {
    "side by side": [Plate(middle=APART[0]), Plate(middle=APART[1])],
    "turned to each other": [Plate(middle=APART[0]), Plate(middle=APART[1], turned=np.pi)],
    "turned at will": [Plate(4, APART[0], 0.4), Plate(2, APART[1], -1.1)],
    "of types 3 and 1": [Plate(3, APART[0], 0.1), Plate(1, APART[1])],
}


@pytest.mark.parametrize("name", TWO)
def test_two_plates_need_no_option(tmp_path, name):
    found = sf.read_recording(write_c3d(tmp_path / "a.c3d", TWO[name], FEET))
    is_the_persons(found)
    assert any("all that stands on plates 1 (" in remark for remark in found.remarks)


def test_a_plate_that_lies_elsewhere_would_be_noticed(tmp_path):
    moved = [TWO["side by side"][0], Plate(middle=(0.0, -0.301, 0.0))]
    path = write_c3d(
        tmp_path / "a.c3d", TWO["side by side"], FEET,
        CORNERS=np.stack([1e3 * plate.corners.T for plate in moved], axis=-1),
    )  # fmt: skip
    with pytest.raises(AssertionError):
        is_the_persons(sf.read_recording(path))


def test_one_plate_alone_and_plates_on_which_nobody_stands(tmp_path):
    nobody = (0.001 * FORCE, POINT - [[0.0], [0.3], [0.0]])
    path = write_c3d(tmp_path / "a.c3d", TWO["side by side"], [(FORCE, POINT + ASIDE), nobody])
    found = sf.read_recording(path)
    is_the_persons(found, ml=POINT[1] + 0.15)
    assert any("nobody stands are left out (0.7 N on 2" in remark for remark in found.remarks)
    is_the_persons(sf.read_recording(path, plate="1"), ml=POINT[1] + 0.15)
    with pytest.raises(sf.InputError, match=r"Fz is 0\.7 N in the median, so nobody stands"):
        sf.read_recording(path, plate="2")


def test_which_axis_is_anterior_posterior_is_said_and_can_be_given(tmp_path):
    path = write_c3d(tmp_path / "a.c3d", [Plate()], [(FORCE, POINT)])
    found = sf.read_recording(path)
    assert any("x of the laboratory is taken as anterior-pos" in remark for remark in found.remarks)
    for given in ({"ap": "y"}, {"ml": "X"}):
        turned = sf.read_recording(path, **given)
        np.testing.assert_array_equal(turned.ap, found.ml)
        assert not any("of the laboratory" in remark for remark in turned.remarks)


def test_the_floor_of_a_laboratory_whose_y_points_up_is_x_and_z(tmp_path):
    x, y, z = POINT
    fx, fy, fz = FORCE
    up = (np.stack([fx, fz, -fy]), np.stack([x, z, -y]))
    path = write_c3d(tmp_path / "a.c3d", [Plate(turned=0.5, y_up=True)], [up])
    is_the_persons(sf.read_recording(path), ml=-y)
    with pytest.raises(sf.InputError, match="ap=y: y points up; give x or z"):
        sf.read_recording(path, ap="y")


def test_units_of_channels_are_as_they_say(tmp_path):
    """Moments in N·m beside lengths in mm, as some programs write them."""
    units = ["N", "N", "N", "Nm", "Nm", "Nm"]
    path = write_c3d(tmp_path / "a.c3d", [Plate(turned=0.7)], [(FORCE, POINT)], units=units)
    file = ezc3d.c3d(str(path))
    file["data"]["analogs"][:, 3:] /= 1e3
    del file["data"]["meta_points"]
    file.write(str(path))
    is_the_persons(sf.read_recording(path))


def test_an_origin_that_points_down_is_turned(tmp_path):
    path = write_c3d(
        tmp_path / "a.c3d", [Plate()], [(FORCE, POINT)], ORIGIN=np.array([[0.0, 0.0, 40.0]]).T
    )
    is_the_persons(sf.read_recording(path))


@pytest.mark.parametrize("name", [*ALONE, *TWO])
def test_it_is_what_the_filter_of_ezc3d_finds(tmp_path, name):
    plates = TWO.get(name) or [ALONE[name]]
    parts = FEET if name in TWO else [(FORCE, POINT)]
    path = write_c3d(tmp_path / "a.c3d", plates, parts)
    found = ezc3d.c3d(str(path), extract_forceplat_data=True)["data"]["platform"]
    load = sum(each["force"][2] for each in found)
    x, y, _ = 1e-3 * sum(each["force"][2] * each["center_of_pressure"] for each in found) / load
    is_the_persons(sf.read_recording(path), ap=x, ml=y)


CORNERS = 1e3 * Plate().corners.T[..., None]
REFUSED = {
    "of another type": ({"TYPE": np.array([5])}, {}, "force plate 1 is of type 5; types 1 to 4 are read"),
    "more plates than described": ({"USED": np.array([2])}, {}, "the C3D file describes 2 force plates, or some of them in part"),
    "no plates": ({"USED": np.array([0])}, {}, "the C3D file describes 0 force plates"),
    "a number of plates that is none": ({"USED": np.array([np.nan])}, {}, "the C3D file describes nan force plates"),
    "no number of plates": ({"USED": np.array([], dtype=int)}, {}, "the C3D file describes no force plates"),
    "a type that is no number": ({"TYPE": np.array([np.nan])}, {}, "force plate 1 is of type nan; types 1 to 4 are read"),
    "no corners": ({"CORNERS": None}, {}, "the C3D file describes 1 force plates, or some of them in part"),
    "corners in one place": ({"CORNERS": 0 * CORNERS}, {}, "the corners of force plate 1 (CORNERS) span no plate"),
    "standing on edge": ({"CORNERS": np.stack([CORNERS[0], CORNERS[1], CORNERS[0]])}, {}, "its force plates are not level"),
    "channels that are not there": ({"CHANNEL": np.arange(3, 9)[:, None]}, {}, "the channels of force plate 1 are not all in the file"),
    "another unit of lengths": ({"CORNERS": 1e-3 * CORNERS, "ORIGIN": np.zeros((3, 1))}, {}, "span no plate"),
    "another origin": ({"ORIGIN": np.array([[900.0, 0.0, -40.0]]).T}, {}, "m from the middle of force plate 1, beside it; are the units"),
    "a surface": ({}, {"surface": 0.04}, "surface=0.04: a C3D file says it itself (ORIGIN)"),
    "places": ({}, {"plate": {"2": (0, 0.6)}}, "a C3D file says where its plates lie; name one to read alone"),
    "a column": ({}, {"ap": "Fx"}, "ap=Fx: of a C3D file give an axis of the laboratory, as ap=x"),
    "the axis that points up": ({}, {"ap": "z"}, "ap=z: z points up; give x or y"),
    "an axis twice": ({}, {"ap": "x", "ml": "x"}, "ap=x and ml=x are the same; give one"),
    "another unit": ({}, {"unit": "cm"}, "unit=cm is not what the file says (POINT:UNITS is mm)"),
    "a column of time": ({}, {"time": "1"}, "is a C3D file, which has a rate"),
    "another rate": ({}, {"rate": 100}, "the file says 1000 Hz, and rate=100 is given; leave one away"),
    "a plate that is not there": ({}, {"plate": "4"}, "plate = '4' is not in the file; its plates are 1"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_it_is_refused_in_a_sentence(tmp_path, name):
    changed, options, sentence = REFUSED[name]
    path = write_c3d(tmp_path / "a.c3d", [Plate()], [(FORCE, POINT)], **changed)
    with pytest.raises(sf.InputError) as told:
        sf.read_recording(path, **options)
    assert sentence in str(told.value)


def test_moments_in_a_wrong_unit_are_noticed_on_two_plates_too(tmp_path):
    """The weight that goes from foot to foot still moves the person's centre."""
    path = write_c3d(
        tmp_path / "a.c3d", [Plate(4, middle=each) for each in APART], FEET,
        CAL_MATRIX=np.stack([MATRIX * ([[1.0]] * 3 + [[1e-3]] * 3)] * 2, axis=-1),
    )  # fmt: skip
    # what moves is shear force times the depth of the transducers
    sentence = "alone the centre of pressure moves by 0.[0-9]* mm about its mean, and under a foot"
    said = " ".join(sf.read_recording(path).remarks)
    assert len(re.findall(sentence, said)) == 2
    right = write_c3d(tmp_path / "b.c3d", [Plate(4, middle=each) for each in APART], FEET)
    assert not re.search(sentence, " ".join(sf.read_recording(right).remarks))


def test_a_missing_package_is_a_sentence(tmp_path, monkeypatch):
    path = write_c3d(tmp_path / "a.c3d", [Plate()], [(FORCE, POINT)])
    monkeypatch.setitem(__import__("sys").modules, "c3d", None)
    with pytest.raises(sf.InputError, match=r'pip install "standfast\[c3d\]"'):
        sf.read_recording(path)


def test_a_file_that_is_cut_off_is_read_and_told(tmp_path):
    path = write_c3d(tmp_path / "a.c3d", [Plate()], [(FORCE, POINT)])
    raw = path.read_bytes()
    path.write_bytes(raw[: len(raw) * 3 // 4])
    found = sf.read_recording(path)
    np.testing.assert_allclose(found.ap, POINT[0][: found.ap.size], rtol=0, atol=FLOAT32)
    assert any("the file is cut off after" in remark for remark in found.remarks)


def test_frames_without_samples_are_not_gone_through(tmp_path, monkeypatch):
    """A broken file may say that it has four thousand million of them."""
    path = write_c3d(tmp_path / "a.c3d", [Plate()], [(FORCE, POINT)])
    monkeypatch.setattr(c3d.Reader, "_check_metadata", lambda _: None)
    monkeypatch.setattr(c3d.Reader, "analog_used", 0)
    monkeypatch.setattr(c3d.Reader, "read_frames", lambda *_, **__: pytest.fail("goes through"))
    with pytest.raises(sf.InputError, match=r"no force plate .* or no analog channels"):
        sf.read_recording(path)


def test_an_altered_file_gives_a_recording_or_a_sentence(tmp_path):
    """Bytes of the header and of the parameters, and the end."""
    path = write_c3d(tmp_path / "a.c3d", [Plate(4)], [(FORCE[:, :6000], POINT[:, :6000])])
    raw, random = path.read_bytes(), np.random.default_rng(2)
    for _ in range(60):
        altered = bytearray(raw)
        for place in random.integers(0, 4096, size=random.integers(1, 9)):
            altered[place] = random.integers(0, 256)
        if random.random() < 0.3:
            altered = altered[: random.integers(512, len(raw))]
        path.write_bytes(altered)
        try:
            found = sf.sway_measures(sf.read_recording(path))
        except sf.InputError as error:
            assert len(str(error)) < 1000
        else:
            assert np.isfinite(found).all()


def test_the_matrix_matters(tmp_path):
    path = write_c3d(
        tmp_path / "a.c3d", [Plate(4)], [(FORCE, POINT)], CAL_MATRIX=MATRIX.T[..., None]
    )
    with pytest.raises((AssertionError, sf.InputError)):
        is_the_persons(sf.read_recording(path))
