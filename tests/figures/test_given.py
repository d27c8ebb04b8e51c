"""What Python may give a figure, and that everything else is one sentence."""

import matplotlib as mpl
import numpy as np
import pytest

import standfast as sf

STUDY = {
    "gravity": 9.81,
    "body": {"height": 1.66, "mass": 68.0},
    "stiffness": {
        "ankle": {"start": 50, "stop": 2000, "num": 9},
        "knee": [1000.0, 2500.0],
        "hip": {"start": 20, "stop": 1500, "num": 8},
    },
    "output": {"quantities": ["stable", "frequency"]},
}


@pytest.fixture(scope="module")
def atlas(tmp_path_factory):
    return sf.sweep(sf.Study.from_dict(STUDY), tmp_path_factory.mktemp("given") / "one.h5")


@pytest.fixture
def axes():
    return mpl.figure.Figure().subplots(1, 3)


def test_a_file_and_a_list_of_atlases_are_as_good_as_atlases(atlas, axes):
    drawn = [
        sf.plot.limits(given, ax=ax)
        for given, ax in zip((atlas, str(atlas.path), [atlas]), axes, strict=True)
    ]
    for ax in drawn[1:]:
        for line, other in zip(drawn[0].lines, ax.lines, strict=True):
            np.testing.assert_array_equal(line.get_xydata(), other.get_xydata())
    ax = sf.plot.map(atlas.path, "frequency", ax=axes[0], colorbar=False)
    assert ax.get_xlabel() == "Ankle stiffness $K_a$ (N·m/rad)"


def test_curves_run_along_an_axis_by_the_name_of_a_study(atlas, axes):
    ax = sf.plot.curves(atlas, "frequency", along="hip", ax=axes[0])
    assert ax.get_xlabel() == "Hip stiffness $K_h$ (N·m/rad)"
    with pytest.raises(sf.InputError, match="along: 'hipp' is no parameter; did you mean 'hip'"):
        sf.plot.curves(atlas, "frequency", along="hipp", ax=axes[0])


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda plot, a, axes: plot.limits(a, ax=axes[0].figure), "give one axes of matplotlib"),
        (lambda plot, a, axes: plot.map(a, "frequency", ax=list(axes)), "give one axes of"),
        (lambda plot, a, axes: plot.map([a, a], "frequency"), "is no atlas; give what open_atlas"),
        (lambda plot, a, axes: plot.limits(3), "3 is no atlas"),
        (lambda plot, a, axes: plot.limits("no.h5"), "no.h5"),
        (lambda plot, a, axes: plot.limits(a, mark=(900, 400)), "give parameters by name"),
        (lambda plot, a, axes: plot.limits(a, mark=900), "give parameters by name"),
        (lambda plot, a, axes: plot.limits(a, at=[2000]), "give values by name"),
        (lambda plot, a, axes: plot.limits(a, at={2: 3}), "'2' is no parameter"),
        (lambda plot, a, axes: plot.survival(a), "one.h5 is no population; give what open_pop"),
        (lambda plot, a, axes: plot.drivers(a, "unstable"), "one.h5 is no population"),
    ],
)
def test_what_cannot_be_drawn_is_one_sentence(atlas, axes, call, sentence):
    with pytest.raises(sf.InputError, match=sentence) as refused:
        call(sf.plot, atlas, axes)
    assert "\n" not in str(refused.value)
