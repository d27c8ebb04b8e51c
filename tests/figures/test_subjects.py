"""Subjects on figures: what is said of them, and labels that cover neither marks nor labels."""

import matplotlib as mpl
import numpy as np
import pytest

import standfast as sf
from reading import check_legible, texts
from standfast.figures import marking
from standfast.figures.atlas_figures import plot
from standfast.figures.style import paper_figure

STUDY = {
    "gravity": 9.81,
    "body": {"height": 1.66, "mass": 68.0},
    "stiffness": {
        "ankle": {"start": 50, "stop": 2000, "num": 9},
        "knee": [1000.0, 1500.0, 2500.0],
        "hip": {"start": 20, "stop": 1500, "num": 8},
    },
    "output": {"quantities": ["stable"]},
}


@pytest.fixture(scope="module")
def atlas(tmp_path_factory):
    return sf.sweep(sf.Study.from_dict(STUDY), tmp_path_factory.mktemp("subjects") / "one.h5")


def test_a_value_between_the_curves_is_said(atlas, tmp_path):
    given = {"ankle": 900, "hip": 400, "knee": 1900}
    (drawing,) = plot(atlas, tmp_path, mark=[marking.subject("mark", {**given, "id": "S"})])
    assert drawing.remark == "S: knee_stiffness 1900 N·m/rad, curves at 1000, 1500, 2500"
    (drawing,) = plot(atlas, tmp_path, mark=[marking.subject("mark", {**given, "knee": 1500})])
    assert drawing.remark == ""


def test_a_value_that_the_study_does_not_hold_is_said():
    one = marking.subject("mark", {"ankle": 900, "hip": 400, "height": 1.66, "id": "S"})
    held = ("ankle_stiffness", "hip_stiffness", "gravity")
    said = marking.contradictions(one, {}, {}, held)
    assert said == "S: height 1.66 m, which the study does not hold"
    # mass follows from height and BMI, one of which every study by size has
    one = marking.subject("mark", {"ankle": 900, "height": 1.66, "mass": 68})
    assert marking.contradictions(one, {}, {}, ("ankle_stiffness", "height", "bmi")) == ""


def test_a_subject_outside_is_a_warning_in_python(atlas):
    ax = mpl.figure.Figure().subplots()
    with pytest.warns(UserWarning, match="S is outside: ankle_stiffness 9000, axis 50 to 2000"):
        sf.plot.limits(atlas, ax=ax, mark={"ankle": 9000, "hip": 400, "id": "S"})


def test_labels_come_from_columns_of_names(tmp_path):
    path = tmp_path / "s.csv"
    for column in ("id", "name", "Subject"):
        path.write_text(f"{column},ankle,hip\nAnna,900,400\n")
        (one,), unused = marking.subjects_in(path)
        assert (one.label, unused) == ("Anna", "")


def test_labels_of_near_subjects_cover_neither_each_other_nor_marks():
    places = [(0.5, 0.5), (0.54, 0.5), (0.5, 0.53), (0.98, 0.99), (0.02, 0.01), (0.99, 0.02)]
    several = [
        marking.Subject(f"subject {n}", {"height": x, "bmi": y}) for n, (x, y) in enumerate(places)
    ]
    with paper_figure() as (figure, (ax,)):
        ax.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
        marking.draw_subjects(ax, several, ("height", "bmi"))
        check_legible([figure])
        panel = ax.get_window_extent()
        boxes = [box for text, box in texts(figure) if text in ax.texts]
        assert len(boxes) == len(places)
        for box in boxes:
            assert panel.x0 <= box.x0 < box.x1 <= panel.x1
            assert panel.y0 <= box.y0 < box.y1 <= panel.y1
            marks = ax.transData.transform(np.array(places))
            assert not box.count_contains(marks)
