"""Figures: which ones an atlas gets, and that nobody has to squint at them."""

import math

import matplotlib.colors
import numpy as np
import pytest

import standfast as sf
from reading import check_legible, keep_figures
from standfast.edwards2007 import drawings
from standfast.figures import maps, painting, style
from standfast.figures.atlas_figures import plot
from standfast.thresholds.planes import PLANE_AXES
from standfast.thresholds.regions import Region
from studies import changed

AXES = {
    "ankle": {"start": 0, "stop": 2000, "num": 41},
    "knee": [900.0, 2000.0, math.inf],
    "hip": {"start": 0, "stop": 1500, "num": 31},
}


def atlas_of(tmp_path, quantities, stiffness=None, body=None):
    content = changed("output.quantities", quantities)
    content = changed("stiffness", stiffness or AXES, content)
    content = changed("body", body or {"height": 1.75, "mass": 80.0}, content)
    return sf.sweep(sf.Study.from_dict(content), tmp_path / "a.h5")


OF_ATLAS = ["stable", "frequency", "hip_ankle_ratio", "critical_ankle_stiffness"]


@pytest.fixture(scope="module")
def atlas(tmp_path_factory):
    """One atlas on all axes, of which tests ask for what they draw."""
    return atlas_of(tmp_path_factory.mktemp("atlas"), OF_ATLAS)


@pytest.fixture(scope="module")
def paper(tmp_path_factory):
    """The figures of the paper."""
    with pytest.MonkeyPatch.context() as patch:
        figures = keep_figures(patch)
        drawings.draw_all(tmp_path_factory.mktemp("paper"))
    return figures


def test_an_atlas_gets_the_figures_its_axes_allow(atlas, tmp_path):
    written = plot(atlas, tmp_path, formats=("png", "svg", "pdf"))
    names = {path.name for drawing in written for path in drawing.paths}
    assert {f"a-limits.{suffix}" for suffix in ("png", "svg", "pdf")} <= names
    assert {"a-frequency.png", "a-hip_ankle_ratio.png", "a-critical_ankle_stiffness.png"} <= names
    assert "a-stable.png" not in names
    for name in names:
        assert (tmp_path / name).stat().st_size > 1000
    assert not list(tmp_path.glob(".*.partial"))


def test_small_multiples_over_body_size_are_thinned(tmp_path, drawn):
    body = {"height": [1.5, 1.6, 1.7, 1.8, 1.9], "bmi": [18.0, 20.0, 22.0, 25.0, 30.0, 35.0]}
    (limits,) = plot(atlas_of(tmp_path, ["stable"], body=body), tmp_path)
    assert limits.remark == "shows height at 3 of 5 values, bmi at 3 of 6 values"
    titles = [ax.get_title() for ax in drawn[0].axes if ax.get_title()]
    assert len(titles) == len(set(titles)) == 9
    assert titles[0] == "$H$ = 1.5 m\nBMI = 18 kg/m²"
    assert titles[-1] == "$H$ = 1.9 m\nBMI = 35 kg/m²"


@pytest.mark.parametrize(
    ("stiffness", "body"),
    [
        ({"ankle": [500.0, 900.0, 1500.0], "knee": 2000.0, "hip": 500.0}, None),
        (
            {"ankle": 900.0, "knee": [1000.0, math.inf], "hip": 500.0},
            {"height": [1.5, 1.9], "mass": 70.0},
        ),
        (
            {"ankle": 900.0, "knee": 2000.0, "hip": 500.0},
            {"height": 1.7, "bmi": [20.0, 30.0, 40.0]},
        ),
    ],
)  # fmt: skip
def test_without_the_plane_a_quantity_is_a_curve(tmp_path, drawn, stiffness, body):
    atlas = atlas_of(tmp_path, ["safety_factor"], stiffness, body)
    (drawing,) = plot(atlas, tmp_path)
    assert [path.name for path in drawing.paths] == ["a-safety_factor.png"]
    assert drawing.remark == ""


def test_nothing_to_draw_gets_a_sentence(tmp_path):
    alone = {"ankle": 900.0, "knee": 2000.0, "hip": 500.0}
    with pytest.raises(sf.InputError, match="has no axis to draw"):
        plot(atlas_of(tmp_path, ["safety_factor"], alone), tmp_path)


def test_an_unknown_quantity_gets_a_sentence_and_no_file(atlas, tmp_path):
    with pytest.raises(sf.InputError, match="has no 'frequenzy'"):
        plot(atlas, tmp_path, quantities=["frequenzy"])
    assert not list(tmp_path.glob("*.png"))


def test_text_is_legible_inside_the_figure_and_does_not_overlap(atlas, tmp_path, drawn, paper):
    plot(atlas, tmp_path, quantities=["stable", "frequency", "hip_ankle_ratio"])
    sizes = {"height": [1.5, 1.6, 1.7, 1.8, 1.9], "bmi": [18.0, 20.0, 22.0, 25.0, 30.0, 35.0]}
    plot(
        atlas_of(tmp_path, ["stable", "critical_hip_stiffness", "frequency"], None, sizes), tmp_path
    )
    assert (len(paper), len(drawn)) == (4, 3 + 3)
    check_legible([*paper, *drawn])


def test_axes_are_labelled_with_units(paper):
    assert paper
    for figure in paper:
        for ax in figure.axes:
            assert "(" in ax.get_xlabel()
            if ax.get_subplotspec().is_first_col():
                assert "(" in ax.get_ylabel()


def grey(color):
    red, green, blue = matplotlib.colors.to_rgb(color)
    return 0.299 * red + 0.587 * green + 0.114 * blue


def test_curves_differ_without_colour(paper):
    contours = paper[1].axes[0].lines[:6]
    styles = [line.get_linestyle() + str(line._dash_pattern) for line in contours]
    assert len(set(styles)) == len(styles)


def rising(colours):
    return bool((np.diff([grey(colour) for colour in colours]) > 0.0).all())


def told_apart(falls, strategies):
    """Who falls is lighter than who stands; the strategies differ by their hatching."""
    light = grey(falls.get_facecolor()[0][:3])
    dark = [grey(colour[:3]) for colour in strategies.get_facecolor()]
    return light - max(dark) > 0.2 and len(set(strategies.hatches)) == len(dark)


def test_regions_and_maps_read_in_grey():
    """Colours as they are drawn: regions apart by shade or hatching, maps from dark to light."""
    ankle, hip = np.linspace(0.0, 2.0, 5), np.linspace(0.0, 1.0, 4)
    ratio = np.tile(np.linspace(0.2, 2.0, 5), (4, 1))
    field = np.tile(np.arange(4.0) - 1.5, (5, 1))  # (ankle, hip)
    region = Region(PLANE_AXES, ankle, hip, field, {}, {}, (ankle, hip, field))
    with style.paper_figure(panels=(1, 2)) as (_, (left, right)):
        painting.strategy_regions(left, ankle, hip, ratio, region)
        strategies, falls = left.collections
        assert told_apart(falls, strategies)
        strategies.hatches = ["", ""]  # it can fail
        assert not told_apart(falls, strategies)
        mesh = right.pcolorfast(ratio, cmap=maps.COLOURS)
        mesh.set_clim(0.2, 2.0)
        shades = np.linspace(0.2, 2.0, 50)
        assert rising(mesh.to_rgba(shades)[:, :3])
        mesh.set_cmap("jet")  # it can fail
        assert not rising(mesh.to_rgba(shades)[:, :3])


def test_where_everyone_stands_no_one_is_drawn_as_falling(tmp_path, drawn):
    strong = {
        "ankle": {"start": 1500, "stop": 3000, "num": 11},
        "knee": 2000.0,
        "hip": {"start": 800, "stop": 2000, "num": 13},
    }
    atlas = atlas_of(tmp_path, ["stable", "hip_ankle_ratio", "frequency"], strong)
    assert np.asarray(atlas["stable"]).all()
    plot(atlas, tmp_path)
    words = {text.get_text() for figure in drawn for ax in figure.axes for text in ax.texts}
    assert "stands" in words
    assert "falls" not in words
    assert drawn[2].axes[1].get_ylabel() == "Frequency $f$ (Hz)"  # nothing of hatching


def test_values_that_differ_late_keep_their_own_curves_and_titles(tmp_path, drawn):
    close = {**AXES, "knee": [2000.0, 20001.0, 20002.0, 20003.0]}
    body = {"height": [1.75, 1.75001], "mass": 80.0}
    plot(atlas_of(tmp_path, ["stable"], close, body), tmp_path)
    panels = [ax for ax in drawn[0].axes if ax.get_title()]
    assert [ax.get_title() for ax in panels] == ["$H$ = 1.75 m", "$H$ = 1.75001 m"]
    for ax in panels:
        words = {line.get_label() for line in ax.lines}
        assert words == {"$K_k$ = 2000", "20001", "20002", "20003"}


def test_a_rigid_ankle_alone_is_drawn_as_curves(tmp_path, drawn):
    alone = {"ankle": [math.inf], "knee": 2000.0, "hip": [100.0, 200.0, 400.0]}
    (drawing,) = plot(atlas_of(tmp_path, ["safety_factor"], alone), tmp_path)
    assert drawing.paths[0].name == "a-safety_factor.png"


def test_a_threshold_that_runs_away_does_not_take_all_colours():
    axis, values = np.arange(5.0), np.full((5, 5), 800.0)
    values[0], values[1, :2] = np.inf, 1e6
    panel = maps.Panel(axis, axis, values, None)
    assert maps.colours_of("critical_ankle_stiffness", [panel]).high == 4 * 800.0
    assert maps.colours_of("frequency", [maps.Panel(axis, axis, -values, None)]).low < -1e5
