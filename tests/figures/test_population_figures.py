"""Figures of a population: what is dark, what is marked, and that no constant is drawn."""

import itertools

import numpy as np
import pytest
from matplotlib.figure import Figure

import standfast as sf
from populations import GOOD, RIGID, changed, law, of
from reading import check_legible
from standfast.cli.app import main
from standfast.figures.population import draw
from standfast.figures.population_charts import FEWEST, MOST_CLASSES, TOGETHER


@pytest.fixture(scope="module")
def women(tmp_path_factory):
    return sf.simulate(of(GOOD, size=20_000), tmp_path_factory.mktemp("w") / "w.h5")


def test_risk_is_dark_and_cells_of_few_are_hatched(women, drawn):
    figure = sf.plot.risk_map(women, ax=new_axes()).figure
    few, mesh = figure.axes[0].collections
    assert few.get_hatch()
    light, dark = (np.dot(mesh.cmap(share)[:3], (0.299, 0.587, 0.114)) for share in (0.0, 1.0))
    assert dark + 0.4 < light
    persons = women.array("persons")
    rows, columns = (side // TOGETHER for side in persons.shape)
    cells = persons.reshape(rows, TOGETHER, columns, TOGETHER).sum(axis=(1, 3))
    coloured = np.isfinite(mesh.get_array().filled(np.nan)).reshape(cells.shape)
    np.testing.assert_array_equal(coloured, cells >= FEWEST)
    hatched = ~np.ma.getmaskarray(few.get_array()).reshape(cells.shape)
    np.testing.assert_array_equal(hatched, (cells > 0) & (cells < FEWEST))
    words = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert words == [f"1 to {FEWEST - 1} persons", "no persons"]


def new_axes():
    return Figure(layout="constrained").subplots()


def test_drivers_are_dots_with_their_intervals(women):
    ax = sf.plot.drivers(women, "safety_factor", ax=new_axes())
    assert not ax.patches  # no bars
    first, total = ax.containers
    indices = women.summary["drivers"]["safety_factor"]
    np.testing.assert_allclose(first.lines[0].get_xdata(), [i["first"] for i in indices.values()])
    (bars,) = total.lines[2]
    ends = [segment[:, 0] for segment in bars.get_segments()]
    np.testing.assert_allclose(ends, [i["total_interval"] for i in indices.values()])
    with pytest.raises(sf.InputError, match="no drivers of 'saftey_factor'; did you mean"):
        sf.plot.drivers(women, "saftey_factor", ax=ax)


def test_figures_of_a_population_are_legible(women, tmp_path, drawn):
    found = draw(women, tmp_path / "w")
    assert [path.name for each in found for path in each.paths] == [
        "w-risk-map.png", "w-risk-by-multiple.png", "w-safety-factor.png",
        "w-drivers-unstable.png", "w-drivers-safety_factor.png",
    ]  # fmt: skip
    check_legible(drawn)


def test_of_a_constant_there_is_a_line_and_no_figure(tmp_path, capsys):
    content = changed("stiffness.ankle", law("fixed", "mgh", value=0.9))
    content["stiffness"] |= {"knee": RIGID, "hip": RIGID}
    found = sf.simulate(of(content, size=4_000), tmp_path / "weak.h5")
    said = [each.remark for each in draw(found, tmp_path / "weak") if not each.paths]
    assert said[:2] == [
        "everybody falls: no figure risk-map",
        "the safety factor is 0.891 to 0.902 in everybody: no figure safety-factor",
    ]
    assert not list(tmp_path.glob("*-safety-factor.png"))


def test_a_figure_of_a_population_is_asked_for_by_name(women, tmp_path, capsys):
    command = ["plot", str(women.path), "-o", str(tmp_path)]
    assert main([*command, "-q", "nonsense"]) == 2
    assert "has no figure 'nonsense' (figures: risk-map, " in capsys.readouterr().err
    assert main([*command, "-q", "risk_mup"]) == 2
    assert "did you mean 'risk-map'?" in capsys.readouterr().err
    assert main([*command, "--at", "hip=3"]) == 2
    assert "--at is for atlases" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
    assert main([*command, "-q", "risk_map"]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["w-risk-map.png"]


@pytest.mark.parametrize(
    ("bands", "ages"), [([50], 2), ([30, 40, 60], 4), (list(range(25, 80, 5)), 12)]
)
def test_of_many_classes_the_largest_are_drawn_and_the_legend_stays_inside(
    tmp_path, monkeypatch, drawn, bands, ages
):
    monkeypatch.chdir(tmp_path)
    edges = [20, *bands, 85]
    rows = [
        f"{1.74 - 0.1 * (sex == 'f')},{60 + age % 20},{sex},{age}"
        for number, age in enumerate((a + b) // 2 for a, b in itertools.pairwise(edges))
        for sex in ("m", "f")
        for _ in range(1 + number)  # the older, the more
        if (sex, number) != ("m", 11)
    ]
    (tmp_path / "people.csv").write_text("\n".join(["height,mass,sex,age", *rows]))
    spring = {"distribution": "normal", "relative_to": "mgh", "mean": 0.67, "sd": 0.08}
    gain = {"distribution": "fixed", "relative_to": "mgh"}
    content = {
        "population": {"people": "people.csv", "age_bands": bands, "size": 4000},
        "stiffness": {"ankle": spring, "knee": RIGID, "hip": RIGID},
        "feedback": {
            "delay": 0.1,
            "proportional": {"ankle": {**gain, "value": 0.8}},
            "derivative": {"ankle": {**gain, "value": 0.3}},
        },
    }
    found = sf.simulate(content, tmp_path / "p.h5")
    (drawing,) = draw(found, tmp_path / "p", wanted=["standing-by-delay"])
    check_legible(drawn)
    (figure,) = drawn
    legend = figure.axes[0].get_legend()
    words = [text.get_text() for text in legend.get_texts()]
    count = 2 * ages - (ages == 12)
    assert len(words) == min(count, MOST_CLASSES) + 1
    styles = {(line.get_color(), str(line._dash_pattern)) for line in figure.axes[0].lines}
    assert len(styles) == len(words)
    if count > MOST_CLASSES:
        assert legend.get_title().get_text() == f"the 8 largest of {count} classes"
        assert drawing.remark.endswith(f"shows the 8 largest of {count} classes by sex and age")
        assert "female 75+" in words
        assert "male under 25" not in words
    else:
        assert drawing.remark == ""
    axes_box = figure.axes[0].get_window_extent()
    assert legend.get_window_extent().y0 >= axes_box.y1 - 1.0
