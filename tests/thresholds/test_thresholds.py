"""Limits of standing: closed form, contours of an atlas, and the distance between them."""

import csv
import io
import math
import subprocess
import sys
from types import SimpleNamespace

import h5py
import numpy as np
import pytest

import standfast as sf
from standfast.atlas.reader import Variable
from standfast.thresholds import contours, planes, tables
from studies import GOOD, changed

AXES = {
    "knee": [800.0, 2000.0, math.inf],
    "ankle": {"start": 0, "stop": 2000, "num": 101},
    "hip": {"start": 0, "stop": 1500, "num": 61},
}
GRID = changed("stiffness", AXES, changed("body", {"height": [1.6, 1.8], "bmi": 23.0}))


def study_of(*quantities):
    return sf.Study.from_dict(changed("output.quantities", list(quantities), GRID))


def on_the_limit(place, ankle, hip):
    """Smallest eigenvalue of C relative to its largest, by LAPACK; 0 on the limit."""
    joints = sf.Stiffness(ankle, place.knee, hip, *place.couplings)
    c = sf.stiffness_matrix(place.body, joints, place.gravity)
    if math.isinf(place.knee):
        c = c[np.ix_([0, 2], [0, 2])]
    values = np.linalg.eigvalsh(c)
    return values[0] / values[-1]


COUPLED = changed("stiffness.ankle_hip", [-30.0, 100.0], changed("stiffness.knee_hip", 50.0, GRID))


@pytest.mark.parametrize(("content", "count"), [(GRID, 6), (COUPLED, 12)])
def test_closed_form_points_lie_on_the_limit(content, count):
    found = list(contours.exact_contours(sf.Study.from_dict(content)))
    assert len(found) == count
    for contour in found:
        assert contour.ankle.size > 50
        assert (np.diff(contour.ankle) >= 0.0).all()
        assert (np.diff(contour.hip) <= 0.0).all()
        for ankle, hip in zip(contour.ankle[::7], contour.hip[::7], strict=True):
            assert on_the_limit(contour.plane, ankle, hip) == pytest.approx(0.0, abs=1e-12)


def test_places_follow_the_axes():
    every = list(planes.planes_of(study_of("stable")))
    assert [(p.values["height"], p.knee) for p in every[:4]] == [
        (1.6, 800.0), (1.6, 2000.0), (1.6, math.inf), (1.8, 800.0),
    ]  # fmt: skip
    direct = sf.Body.from_height_mass(1.8, 23.0 * 1.8**2)
    np.testing.assert_allclose(every[3].body.segment_mass, direct.segment_mass, rtol=1e-15)


@pytest.mark.parametrize(
    ("quantity", "steps"),
    [
        # a verdict knows the limit to half a step; a smooth margin to the square of a step
        ("stable", 0.51),
        ("stiffness_reserve", 0.05),
        ("eigenvalue_1", 0.05),
        ("frequency", 0.05),
    ],
)
def test_contours_of_an_atlas_lie_on_the_closed_form(tmp_path, quantity, steps):
    atlas = sf.sweep(study_of(quantity, "safety_factor"), tmp_path / "a.h5")
    found = list(contours.extracted_contours(atlas))
    assert contours.source_of(atlas)[0] == quantity
    assert len(found) == 6
    for contour in found:
        assert len(contour.lines) == 1
        assert contour.resolution == pytest.approx(25.0)  # the hip's, the larger of the two
        assert 0.0 < contour.greatest <= steps * 25.0
        assert contour.mean < contour.greatest


def test_the_best_source_is_taken():
    """Of the names alone; what each of them shows is above."""
    atlas = SimpleNamespace(quantities=("stable", "frequency", "stiffness_reserve"))
    assert contours.source_of(atlas) == ("stiffness_reserve", 0.0)
    atlas = SimpleNamespace(quantities=("safety_factor", "stable"))
    assert contours.source_of(atlas) == ("stable", 0.5)


def test_axes_in_another_order_give_the_same_contours(tmp_path):
    turned = changed("stiffness", dict(reversed(AXES.items())), GRID)
    one = sf.sweep(study_of("stable"), tmp_path / "one.h5")
    other = sf.sweep(sf.Study.from_dict(turned), tmp_path / "other.h5")
    lines = {tuple(c.plane.values.items()): c.lines[0] for c in contours.extracted_contours(one)}
    for contour in contours.extracted_contours(other):
        same = lines[tuple((k, contour.plane.values[k]) for k in ("height", "knee_stiffness"))]
        assert {tuple(point) for point in contour.lines[0]} == {tuple(point) for point in same}


def test_tables_hold_every_curve(tmp_path):
    study = study_of("stable")
    atlas = sf.sweep(study, tmp_path / "a.h5")
    found = list(contours.extracted_contours(atlas))
    table, store = tables.write_tables(study, found, tmp_path / "t")
    rows = list(csv.DictReader(io.StringIO(table.read_text(encoding="utf-8"))))
    counts = [sum(row["source"] == source for row in rows) for source in ("closed form", "atlas")]
    assert counts[0] == sum(contour.ankle.size for contour in found)
    assert counts[1] == sum(len(contour.lines[0]) for contour in found)
    assert list(rows[0]) == [
        "height [m]", "knee_stiffness [N·m/rad]", "ankle_stiffness [N·m/rad]",
        "hip_stiffness [N·m/rad]", "source",
    ]  # fmt: skip
    with h5py.File(store, "r") as file:
        assert len(file["thresholds"]) == 6
        group = file["thresholds/000004"]
        assert group.attrs["height"] == 1.8
        assert group.attrs["knee_stiffness"] == 2000.0
        assert group.attrs["body_model"] == "winter"
        np.testing.assert_array_equal(group["closed_form"][:, 0], found[4].ankle)
        np.testing.assert_array_equal(group["contour"][...], found[4].lines[0])
        assert group.attrs["greatest_distance"] == found[4].greatest
    assert not list(tmp_path.glob("*.partial"))


def test_a_study_without_the_plane_gets_a_sentence():
    with pytest.raises(sf.InputError, match="hip_stiffness is no axis of this study"):
        list(contours.exact_contours(sf.Study.from_dict(GOOD)))


def test_an_atlas_that_shows_no_limit_gets_a_sentence(tmp_path):
    # the determinant changes its sign also where a second mode begins to fall
    atlas = sf.sweep(study_of("safety_factor", "stability_determinant"), tmp_path / "a.h5")
    with pytest.raises(sf.InputError, match="holds no verdicts and no margin"):
        list(contours.extracted_contours(atlas))


def test_a_person_who_stands_everywhere_has_no_limit(tmp_path):
    axes = {"ankle": [5000.0, 6000.0], "knee": math.inf, "hip": [5000.0, 6000.0, 7000.0]}
    atlas = sf.sweep(sf.Study.from_dict(changed("stiffness", axes)), tmp_path / "a.h5")
    (contour,) = contours.extracted_contours(atlas)
    assert contour.ankle.size == 0
    assert contour.lines == []
    assert math.isnan(contour.greatest)


def test_tables_of_one_atlas_do_not_touch_another(tmp_path):
    """A dot in a name is no suffix: run.2.h5 must not write run.h5."""
    neighbour = tmp_path / "run.h5"
    neighbour.write_text("my other atlas")
    study = study_of("stable")
    written = tables.write_tables(study, contours.exact_contours(study), tmp_path / "run.2-t")
    assert [path.name for path in written] == ["run.2-t.csv", "run.2-t.h5"]
    assert neighbour.read_text() == "my other atlas"


@pytest.mark.parametrize("ankle", [[math.inf], [900.0], [900.0, math.inf]])
def test_an_axis_with_fewer_than_two_finite_values_gets_a_sentence(ankle):
    axes = {"ankle": ankle, "knee": 2000.0, "hip": [100.0, 200.0]}
    with pytest.raises(sf.InputError, match="ankle_stiffness has fewer than two finite values"):
        list(contours.exact_contours(sf.Study.from_dict(changed("stiffness", axes))))


def plane_study(side, *quantities):
    axes = {name: {"start": 0, "stop": 2000, "num": side} for name in ("ankle", "hip")}
    study = changed("output.quantities", list(quantities))
    return sf.Study.from_dict(changed("stiffness", {**axes, "knee": 2000.0}, study))


@pytest.mark.parametrize("band", [1, 100, 500])
@pytest.mark.parametrize("noise", [0.0, 0.05, 1.0])
def test_bands_of_rows_give_the_lines_of_the_whole_plane(tmp_path, monkeypatch, band, noise):
    """Open lines to the last bit and in their order; closed ones may begin at another point."""
    atlas = sf.sweep(plane_study(40, "stiffness_reserve"), tmp_path / "a.h5")
    random = np.random.default_rng(4)
    ankles, hips = np.meshgrid(*[np.linspace(0.0, 1.0, 40)] * 2, indexing="ij")
    values = ankles * hips - 0.3 + noise * random.standard_normal(ankles.shape)
    monkeypatch.setattr(Variable, "planes", lambda self, along: iter([({}, values)]))
    (whole,) = contours.extracted_contours(atlas)
    monkeypatch.setattr(contours, "BAND_POINTS", band)
    (banded,) = contours.extracted_contours(atlas)

    def open_and_closed(lines):
        is_open = [not np.array_equal(line[0], line[-1]) for line in lines]
        return (
            [line.tolist() for line, yes in zip(lines, is_open, strict=True) if yes],
            {frozenset(map(tuple, li)) for li, yes in zip(lines, is_open, strict=True) if not yes},
        )

    assert open_and_closed(banded.lines) == open_and_closed(whole.lines)
    assert len(banded.lines) == len(whole.lines)
    # it can fail: the plane has many lines, and pieces that were not joined would be more
    assert len(whole.lines) > (50 if noise == 1.0 else 0)


def test_a_large_plane_is_contoured_in_little_memory(tmp_path):
    """Sixteen million verdicts; contoured at once they took 450 MB more."""
    path = tmp_path / "a.h5"
    sf.sweep(plane_study(4000, "stable"), path)
    code = f"""
from pathlib import Path
from standfast.atlas.opening import open_atlas
from standfast.thresholds import contours

def most():  # kB
    lines = Path("/proc/self/status").read_text().splitlines()
    return int(next(line.split()[1] for line in lines if line.startswith("VmHWM")))

atlas, before = open_atlas({str(path)!r}), most()
(contour,) = contours.extracted_contours(atlas)
print(len(contour.lines), most() - before)
"""
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    lines, more = map(int, result.stdout.split())
    assert lines == 1
    assert more < 200_000
