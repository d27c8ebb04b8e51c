"""Slices and names: a rigid joint that is not on the grid, files that do not hide one another."""

import math

import numpy as np
import pytest

import standfast as sf
from reading import check_legible, texts
from standfast.cli.app import main
from standfast.figures import marking
from standfast.figures.atlas_figures import plot

STUDY = {
    "gravity": [1.62, 9.81],
    "body": {"height": 1.66, "mass": 68.0},
    "stiffness": {
        "ankle": {"start": 50, "stop": 2000, "num": 9},
        "knee": [1000.0, 1500.0, 2500.0],
        "hip": {"start": 20, "stop": 1500, "num": 8},
    },
    "output": {"quantities": ["stable", "safety_factor"]},
}
RIGID = "knee_stiffness = rigid is not on its axis, 1000 to 2500 N·m/rad"


@pytest.fixture(scope="module")
def atlas(tmp_path_factory):
    return sf.sweep(sf.Study.from_dict(STUDY), tmp_path_factory.mktemp("slices") / "moon.h5")


def test_a_rigid_joint_is_refused_on_an_axis_of_finite_values(atlas, tmp_path, capsys):
    for text in ("knee=inf", "knee=rigid"):
        assert main(["plot", str(atlas.path), "-o", str(tmp_path), "--at", text]) == 2
        assert RIGID in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
    with pytest.raises(sf.InputError, match=RIGID):
        sf.plot.map(atlas, "safety_factor", at={"knee": math.inf})
    with pytest.raises(sf.InputError, match="hip_stiffness = rigid is not on its axis, 20 to 1500"):
        sf.plot.limits(atlas, at={"hip": math.inf})


def test_a_subject_with_a_rigid_knee_is_nearest_to_the_stiffest_which_is_said(
    atlas, tmp_path, drawn
):
    subject = marking.subject("mark", {"ankle": 900, "hip": 400, "knee": "inf", "id": "S"})
    (drawing,) = plot(
        atlas, tmp_path, quantities=["safety_factor"], at={"gravity": 9.81}, mark=[subject]
    )
    assert "S: knee_stiffness rigid, drawn where it is 2500" in drawing.remark
    marked = {
        ax.get_title(): line.get_xydata()[0]
        for ax in drawn[0].axes
        for line in ax.lines
        if line.get_marker() == "D"
    }
    assert list(marked) == ["$K_k$ = 2500 N·m/rad"]
    np.testing.assert_array_equal(*marked.values(), [900.0, 400.0])


def test_each_slice_has_a_file_of_its_own(atlas, tmp_path):
    slices = ({}, {"gravity": 1.62}, {"gravity": 1.62, "knee_stiffness": 1500})
    for at in slices:
        plot(atlas, tmp_path, quantities=["limits"], at=at)
    plot(atlas, tmp_path, quantities=["limits"], at={"knee": 1500}, overlay="gravity")
    assert {path.name for path in tmp_path.iterdir()} == {
        "moon-limits.png",
        "moon-limits-gravity-1.62.png",
        "moon-limits-gravity-1.62-knee-1500.png",
        "moon-limits-over-gravity-knee-1500.png",
    }


def test_figures_may_be_called_as_their_files(atlas, tmp_path, capsys):
    (drawing,) = plot(atlas, tmp_path, quantities=["limits", "stable"])
    assert [path.name for path in drawing.paths] == ["moon-limits.png"]
    with pytest.raises(sf.InputError, match="decay_rate and sway_frequency along feedback_delay"):
        plot(atlas, tmp_path, quantities=["locus"])
    assert main(["plot", str(atlas.path), "-o", str(tmp_path), "-q", "limit"]) == 2
    assert "has no 'limit'; did you mean 'limits'?" in capsys.readouterr().err


def test_text_in_a_pdf_is_in_no_type_3_font(atlas, tmp_path):
    (drawing,) = plot(atlas, tmp_path, quantities=["limits"], formats=("pdf",))
    content = drawing.paths[0].read_bytes()
    assert b"/Type0" in content
    assert b"/Type3" not in content


def test_a_verdict_along_one_axis_is_no_curve(atlas, tmp_path):
    at = {"gravity": 9.81, "knee": 1500, "hip": 20}
    drawn = plot(atlas, tmp_path, quantities=["stable"], at=at)
    assert [(d.paths, d.remark.partition(":")[0]) for d in drawn] == [
        ([], "stable is 0 or 1 along ankle_stiffness")
    ]
    assert not list(tmp_path.iterdir())


def test_names_of_limits_in_a_corner_cover_neither_the_axes_nor_each_other(tmp_path, drawn):
    stiffness = {**STUDY["stiffness"], "ankle": {"start": 0, "stop": 2000, "num": 9}}
    stiffness["hip"] = {"start": 0, "stop": 1500, "num": 8}
    study = sf.Study.from_dict({**STUDY, "gravity": 1.62, "stiffness": stiffness})
    moon = sf.sweep(study, tmp_path / "moon.h5")
    plot(moon, tmp_path, quantities=["limits"])
    ax = drawn[0].axes[0]
    assert "limits: $K_k$ = 1000, 1500, 2500" in {text.get_text() for text in ax.texts}
    panel = ax.get_window_extent()
    for text, box in texts(drawn[0]):
        assert text not in ax.texts or (panel.x0 <= box.x0 and panel.y0 <= box.y0)
    check_legible(drawn)
