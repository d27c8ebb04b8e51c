"""What a user chooses of a figure: the slice, what lies over another, and subjects of their own."""

import math
import subprocess
import sys

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

import standfast as sf
from reading import check_legible
from standfast.cli.app import main
from standfast.figures import marking
from standfast.figures.atlas_figures import plot
from standfast.figures.labels import name_curves
from standfast.figures.style import paper_figure

CURVED = {"start": 50.0, "stop": 2000.0, "num": 40}
STUDY = {
    "gravity": [1.62, 3.71, 9.81],
    "body": {"model": ["winter", "edwards2007"], "height": 1.66, "mass": 68.0},
    "stiffness": {
        "ankle": {"start": 50, "stop": 5000, "num": 13, "spacing": "log"},
        "knee": [1000.0, 2000.0, math.inf],
        "hip": {"start": 20, "stop": 2000, "num": 11, "spacing": "log"},
    },
    "output": {"quantities": ["stable", "frequency"]},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("choices")


@pytest.fixture(scope="module")
def atlas(folder):
    return sf.sweep(sf.Study.from_dict(STUDY), folder / "many.h5")


@pytest.fixture(scope="module")
def pair(folder):
    """The same study by two models, without the axis of gravity."""
    content = {**STUDY, "gravity": 9.81, "output": {"quantities": ["stable"]}}
    return [
        sf.sweep(
            sf.Study.from_dict({**content, "body": {**STUDY["body"], "model": model}}),
            folder / f"{model}.h5",
        )
        for model in ("winter", "edwards2007")
    ]


def names_of(ax):
    return [line.get_label() for line in ax.lines if not line.get_label().startswith("_")]


def marks_of(ax):
    return [line.get_xydata()[0] for line in ax.lines if line.get_marker() == "D"]


def test_a_slice_is_drawn_at_the_nearest_value_which_is_said(atlas, tmp_path, drawn):
    found = plot(atlas, tmp_path, quantities=["stable"], at={"gravity": 3.0, "model": "winter"})
    assert found[0].remark == "gravity = 3 is not on the grid; drawn at the nearest, 3.71 m/s²"
    (figure,) = drawn
    assert figure.get_suptitle() == "winter, $H$ = 1.66 m, $m$ = 68 kg, $g$ = 3.71 m/s²"
    assert names_of(figure.axes[0]) == ["$K_k$ = 1000", "2000", "rigid"]
    assert figure.axes[0].get_xscale() == figure.axes[0].get_yscale() == "log"
    # the curve of that gravity, not of another
    ankle, hip = figure.axes[0].lines[1].get_data()
    springs = sf.Stiffness(float(ankle[200]), 2000.0, float(hip[200]))
    body = sf.Body.from_height_mass(1.66, 68.0)
    assert sf.safety_factor(body, springs, 3.71) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--at", "gravitty=3"], "'gravitty' is no parameter; did you mean 'gravity'?"),
        (["--at", "gravity=30"], "gravity = 30 is beyond its axis, 1.62 to 9.81 m/s²"),
        (["--at", "mass=60"], "mass is no axis of this file, in which it is 68 kg throughout"),
        (["--at", "model=wintr"], "body_model = 'wintr' is not known; did you mean 'winter'?"),
        (["--at", "hip"], "'hip' is not NAME=VALUE"),
        (["--at", "hip=x"], "hip_stiffness = 'x' is not a number in N·m/rad"),
        (["--overlay", "mass"], "overlay: mass is no axis that is left"),
        (["--mark", "ankl=900"], "'ankl' is no parameter; did you mean 'ankle'?"),
        (["--mark", "ankle=900"], "a figure here has the axes ankle_stiffness and hip_stiffness"),
        (["--mark", "no.csv"], "no.csv cannot be read: No such file or directory"),
        (["-q", "stabel"], "has no 'stabel'; did you mean 'stable'?"),
    ],
)
def test_what_no_figure_can_show_is_one_sentence(atlas, tmp_path, capsys, arguments, sentence):
    assert main(["plot", str(atlas.path), "-o", str(tmp_path), *arguments]) == 2
    message = capsys.readouterr().err
    assert sentence in message
    assert message.count("\n") == 1
    assert not list(tmp_path.glob("*.png"))


def test_values_of_an_axis_lie_over_one_another(atlas, tmp_path, drawn):
    at = {"knee": 2000, "gravity": 9.81}
    plot(atlas, tmp_path, quantities=["stable"], at=at, overlay="body_model")
    ax = drawn[0].axes[0]
    assert names_of(ax) == ["winter", "edwards2007"]
    assert len({line.get_linestyle() for line in ax.lines}) == 2
    assert {"winter", "edwards2007", "stands", "falls"} <= {text.get_text() for text in ax.texts}
    check_legible(drawn)


def test_limits_of_two_files_are_one_figure(pair, tmp_path, drawn):
    (drawing,) = plot(pair, tmp_path)
    assert [path.name for path in drawing.paths] == ["winter-edwards2007-limits.png"]
    panels = [ax for ax in drawn[0].axes if ax.get_title()]
    assert [ax.get_title() for ax in panels] == [
        "$K_k$ = 1000 N·m/rad", "$K_k$ = 2000 N·m/rad", "$K_k$ rigid",
    ]  # fmt: skip
    for ax in panels:
        assert names_of(ax) == ["winter", "edwards2007"]
    assert "winter" not in drawn[0].get_suptitle()  # only what both have
    check_legible(drawn)


def test_a_map_of_several_files_is_refused(atlas, tmp_path):
    with pytest.raises(sf.InputError, match="frequency of one alone"):
        plot([atlas, atlas], tmp_path, quantities=["frequency"])


def test_files_that_share_no_plane_are_refused(atlas, pair, tmp_path):
    with pytest.raises(sf.InputError, match=r"many.h5 and .*winter.h5 differ in gravity"):
        plot([atlas, pair[0]], tmp_path)
    # cut there, both lie in one figure
    assert plot([atlas, pair[0]], tmp_path, at={"gravity": 9.81, "model": "winter"})


def test_subjects_of_a_file_are_marked_in_their_panels(atlas, tmp_path, drawn):
    people = tmp_path / "subjects.csv"
    people.write_text(
        "id;ankle;hip;knee_stiffness;mass;group\n"
        "S1;900,5;400;2000;68;x\nS2;700;300;inf;80;y\nS3;6000;100;1000;68;y\nS4;900;;2000;68;y\n"
    )
    subjects, unused = marking.subjects_in(people)
    assert unused.endswith("not used: group")
    at = {"gravity": 9.81, "model": "winter"}
    (drawing,) = plot(atlas, tmp_path, quantities=["frequency"], at=at, mark=subjects)
    assert "S3 is outside: ankle_stiffness 6000, axis 50 to 5000" in drawing.remark
    assert "S2: mass 80 kg, drawn where it is 68" in drawing.remark
    assert "S4 does not name hip_stiffness: not marked" in drawing.remark
    assert "S1" not in drawing.remark
    panels = {ax.get_title(): ax for ax in drawn[0].axes if ax.get_title()}
    assert marks_of(panels["$K_k$ = 1000 N·m/rad"]) == []
    np.testing.assert_array_equal(marks_of(panels["$K_k$ = 2000 N·m/rad"]), [[900.5, 400.0]])
    np.testing.assert_array_equal(marks_of(panels["$K_k$ rigid"]), [[700.0, 300.0]])
    assert "outside: S3" in {t.get_text() for t in panels["$K_k$ = 1000 N·m/rad"].texts}
    check_legible(drawn)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("id,ankel,hip\na,1,2\n", "a column 'ankel', which is no parameter; did you mean 'ankle'?"),
        ("id,age\na,30\n", "has no subjects"),
        ("name,age\na,30\n", "has no subjects"),
        ("id,height_cm,ankle,hip\na,166,1,2\n", "a column 'height_cm'; name it height, in m"),
        ("id,height,ankle,hip\na,166,1,2\n", "height = 166 .*looks like centimetres, write 1.66"),
        ("", "has no subjects"),
        ("ankle,hip\n1,x\n", "row 1: hip_stiffness = 'x' is not a number"),
    ],
)
def test_a_file_of_subjects_that_cannot_be_used_is_one_sentence(tmp_path, text, sentence):
    (tmp_path / "s.csv").write_text(text)
    with pytest.raises(sf.InputError, match=sentence):
        marking.subjects_in(tmp_path / "s.csv")


def test_python_draws_into_axes_of_ones_own_and_changes_no_settings(atlas):
    before = dict(mpl.rcParams)
    figure = mpl.figure.Figure()
    left, right = figure.subplots(1, 2)
    at = {"gravity": 9.81, "body_model": "winter", "knee_stiffness": 2000}
    subject = {"id": "P", "ankle": 900, "hip": 400}
    assert sf.plot.limits(atlas, ax=left, at=at, mark=subject) is left
    assert sf.plot.map(atlas, "frequency", ax=right, at=at, mark=[subject]) is right
    assert dict(mpl.rcParams) == before
    for ax in (left, right):
        np.testing.assert_array_equal(marks_of(ax), [[900.0, 400.0]])
        assert ax.get_xlabel() == "Ankle stiffness $K_a$ (N·m/rad)"
        assert "$K_k$ = 2000" in ax.get_title()
    assert "limit of standing" in names_of(right)
    with pytest.raises(sf.InputError, match="mark: ankle_stiffness=900 does not name hip"):
        sf.plot.limits(atlas, ax=left, at=at, mark={"ankle": 900})
    with pytest.raises(sf.InputError, match="draw it with curves"):
        sf.plot.map(atlas, "frequency", at={"hip": 400})


def test_curves_are_named_and_cut(atlas):
    figure = mpl.figure.Figure()
    ax = sf.plot.curves(
        atlas,
        "frequency",
        ax=figure.subplots(),
        at={"hip": 2000, "model": "winter", "knee": math.inf},
    )
    assert names_of(ax) == ["$g$ = 1.62 m/s²", "3.71 m/s²", "9.81 m/s²"]
    assert ax.get_xscale() == "log"
    assert "falls" in {text.get_text() for text in ax.texts}


@pytest.mark.parametrize(
    ("section", "axes"),
    [
        ("stiffness", {"ankle": 900.0, "knee": [700.0, 3000.0, math.inf], "hip": CURVED}),
        ("body", {"height": {"start": 0.5, "stop": 2.0, "num": 31}, "bmi": [20.0, 24.0]}),
    ],
)
def test_no_curve_crosses_the_words_on_which_side_a_person_stands(section, axes, tmp_path):
    study = {
        "stiffness": {"ankle": 900.0, "knee": 3000.0, "hip": 1000.0},
        "body": {"height": 1.7, "bmi": 24.0},
        section: axes,
        "output": {"quantities": ["critical_ankle_stiffness"]},
    }
    ax = sf.plot.curves(sf.sweep(study, tmp_path / "a.h5"), "critical_ankle_stiffness")
    ax.figure.draw_without_rendering()
    (words,) = [text for text in ax.texts if "a person stands" in text.get_text()]
    box = words.get_window_extent()
    assert ax.get_window_extent().contains(box.x0, box.y0)
    for line in ax.lines:
        x, y = line.get_data()
        dense = np.linspace(x[0], x[-1], 4001)
        points = ax.transData.transform(np.column_stack([dense, np.interp(dense, x, y)]))
        inside = (points > [box.x0, box.y0]) & (points < [box.x1, box.y1])
        assert not inside.all(axis=1).any()
    plt.close(ax.figure)


def test_a_quantity_without_spread_is_a_line_and_no_figure(tmp_path, drawn):
    strong = {"ankle": {"start": 3000, "stop": 4000, "num": 9}, "knee": 9000.0,
              "hip": {"start": 3000, "stop": 4000, "num": 9}}  # fmt: skip
    content = {**STUDY, "gravity": 9.81, "stiffness": strong}
    content["body"] = {**STUDY["body"], "model": "winter"}
    content["output"] = {"quantities": ["growth_rate"]}
    found = plot(sf.sweep(sf.Study.from_dict(content), tmp_path / "a.h5"), tmp_path)
    assert found[-1] == ([], "growth_rate is 0 1/s throughout what would be drawn: no figure")
    assert len(drawn) == 1  # the limits


def test_without_axes_a_new_figure_is_one_of_pyplot(atlas):
    plt.switch_backend("agg")
    ax = sf.plot.limits(atlas, at={"gravity": 9.81})
    assert ax.figure.number in plt.get_fignums()
    plt.close(ax.figure)


def test_matplotlib_waits_until_a_figure_is_asked_for():
    script = (
        "import sys, standfast\n"
        "assert not {'matplotlib', 'h5py', 'jax'} & set(sys.modules)\n"
        "standfast.plot.limits\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


def test_loci_are_those_of_the_delay_and_no_other(atlas):
    with pytest.raises(sf.InputError, match="does not hold decay_rate and sway_frequency along"):
        sf.plot.locus(atlas)


def test_words_keep_off_marks():
    with paper_figure() as (figure, (ax,)):
        ax.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
        here = marking.draw_subjects(
            ax, [marking.Subject("P", {"height": 0.5, "bmi": 0.5})], ("height", "bmi")
        )
        line = np.linspace(0.0, 1.0, 200)
        name_curves(ax, [("name", (line, line))], avoid=here)
        check_legible([figure])
