"""Slices and names: a rigid joint that is not on the grid, files that do not hide one another."""

import math

import numpy as np
import pytest

import standfast as sf
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
