"""Figures of delayed feedback: the values behind them, and which ones an atlas gets."""

import csv
import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib.contour import ContourSet
from scipy.spatial import cKDTree

import standfast as sf
from reading import check_legible
from standfast.figures import along
from standfast.figures.along import crossings_of
from standfast.figures.atlas_figures import plot
from standfast.thresholds import planes, regions, tables

STUDIES = Path(__file__).parents[2] / "studies"
NOMINAL = {"model": "edwards2007", "height": 1.753, "mass": 75.3}
GRAVITY = 9.8
DELAYS = [0.1, 0.2, 0.3]
ANKLE = 300.0  # N·m/rad
STEPS = np.array([2500.0 / 50, 900.0 / 45])  # of the two gains

# A point of a limit lies between two neighbours of the grid; with a margin beside the verdict it is
# found to the square of a step where the limit is smooth, but not at the edge where C + P = 0, at
# which the critical delay jumps to 0.
ONE_STEP, SMOOTH = 1.0, 0.12

# C + P is linear in P: what is left is rounding.
LINEAR = 1e-9


def study_of(stiffness, feedback, quantities, damping=None):
    content = {"gravity": GRAVITY, "body": NOMINAL, "stiffness": stiffness, "feedback": feedback}
    content |= {"damping": damping} if damping else {}
    return sf.Study.from_dict({**content, "output": {"quantities": quantities}})


def chart(quantities):
    """Gains of an ankle below rigid joints, at a few delays: the D-shaped stability chart."""
    gains = {
        "delay": DELAYS,
        "proportional": {"ankle": {"start": 0, "stop": 2500, "num": 51}},
        "derivative": {"ankle": {"start": 0, "stop": 900, "num": 46}},
    }
    return study_of({"ankle": ANKLE, "knee": math.inf, "hip": math.inf}, gains, quantities)


SPRINGY = {"ankle": 468.0, "knee": 2000.0, "hip": {"start": 0, "stop": 3000, "num": 13}}
DAMPED = {"ankle": 30.0, "knee": 20.0, "hip": 20.0}
P, D = 512.0, 102.0


@pytest.fixture(scope="module")
def windows(tmp_path_factory):
    """Delay × hip of a person who falls, stands and falls again as the delay grows."""
    delays = {"start": 0, "stop": 0.4, "num": 81}
    feedback = {"delay": delays, "proportional": {"ankle": P}, "derivative": {"ankle": D}}
    wanted = ["stable", "decay_rate", "sway_frequency", "unstable_roots"]
    study = study_of(SPRINGY, feedback, wanted, DAMPED)
    return sf.sweep(study, tmp_path_factory.mktemp("windows") / "w.h5")


@pytest.fixture(scope="module")
def charts(tmp_path_factory):
    """The chart from verdicts alone, with the critical delay, and with the decay rate."""
    folder = tmp_path_factory.mktemp("charts")
    beside = {"verdicts": [], "critical": ["critical_delay"], "decay": ["decay_rate"]}
    return {
        name: sf.sweep(chart(["stable", *more]), folder / f"{name}.h5")
        for name, more in beside.items()
    }


def closed_form(delay, upto):
    """Return gains (P, D) at which a root lies on the axis, of one joint, by its frequency.

    z = e^{−iωτ} on the unit circle: P + iωD = (Jω² − C) e^{iωτ}; and the edge P = −C, where ω = 0.
    """
    body = sf.Body.edwards2007()
    rigid = sf.Stiffness(ANKLE, math.inf, math.inf)
    inertia = float(sf.inertia_matrix(body)[0, 0])
    c = float(sf.stiffness_matrix(body, rigid, GRAVITY)[0, 0])
    omega = np.linspace(1e-6, upto, 20_001)
    stiff = inertia * omega**2 - c
    curve = np.column_stack([stiff * np.cos(omega * delay), stiff * np.sin(omega * delay) / omega])
    edge = np.column_stack([np.full(901, -c), np.linspace(0.0, 900.0, 901)])
    return curve, edge


def steps_away(points, truth):
    """Return how many steps of the grid each point lies from the nearest point of a curve."""
    away, _ = cKDTree(truth / STEPS).query(points / STEPS)
    return away


@pytest.mark.parametrize(("name", "away"), [("verdicts", ONE_STEP), ("critical", ONE_STEP),
                                            ("decay", ONE_STEP)])  # fmt: skip
def test_the_d_shaped_chart_lies_on_the_closed_form(charts, name, away):
    found = list(regions.regions(charts[name]))
    assert [region.values["feedback_delay"] for region in found] == DELAYS
    for region in found:
        assert region.axes == ("ankle_proportional_gain", "ankle_derivative_gain")
        curve, edge = closed_form(region.values["feedback_delay"], 12.0)
        points = np.concatenate(region.lines)
        assert len(points) > 10
        off_curve, off_edge = steps_away(points, curve), steps_away(points, edge)
        assert np.minimum(off_curve, off_edge).max() <= away
        smooth = (off_edge > 2.0) & (points[:, 0] < 2500.0)
        assert smooth.sum() > 5
        if name != "verdicts":
            assert off_curve[smooth].max() <= SMOOTH
        # it can fail: the curve of a delay a tenth longer is another
        late, _ = closed_form(1.1 * region.values["feedback_delay"], 12.0)
        assert np.minimum(steps_away(points, late), off_edge).max() > away


@pytest.mark.parametrize("name", ["verdicts", "critical", "decay"])
def test_where_a_root_passes_through_0_the_limit_is_in_closed_form(charts, name):
    """Between verdicts half way, the line would lie up to half a step of 50 N·m/rad away."""
    for region in regions.regions(charts[name]):
        _, edge = closed_form(region.values["feedback_delay"], 12.0)
        points = np.concatenate(region.lines)
        low, high = points[:, 1].min(), points[:, 1].max()
        straight = points[points[:, 0] < edge[0, 0] + 0.5 * STEPS[0]]
        inner = straight[(straight[:, 1] > low + STEPS[1]) & (straight[:, 1] < high - STEPS[1])]
        assert len(inner) > 10
        np.testing.assert_allclose(inner[:, 0], edge[0, 0], rtol=LINEAR)
        # no verdict of the grid is on the other side
        across, up = (
            np.isin(fine, side)
            for fine, side in zip(region.finer[:2], (region.x, region.y), strict=True)
        )
        np.testing.assert_array_equal(region.finer[2][across][:, up] > 0.0, region.stands)


def test_a_closed_region_is_closed_and_a_longer_delay_lies_within_it(charts):
    found = list(regions.regions(charts["decay"]))
    for region in found[1:]:  # the shortest delay leaves the frame
        (line,) = region.lines
        np.testing.assert_array_equal(line[0], line[-1])
    for wide, narrow in itertools.pairwise(found):
        assert (wide.stands | ~narrow.stands).all()
        assert wide.stands.sum() > narrow.stands.sum() > 0


def changes_of(hip):
    """Delays at which the person begins or ceases to stand, from the crossings of one person."""
    person = sf.Body.edwards2007(), sf.Stiffness(468.0, 2000.0, hip), GRAVITY
    nerves = {"damping": tuple(DAMPED.values()), "feedback": sf.Feedback((P, 0, 0), (D, 0, 0))}
    unstable, delays = sf.unstable_roots(*person, **nerves), []
    for delay, _, way in sf.delay_crossings(*person, **nerves, longest=0.4):
        after = unstable + 2 * way
        if (unstable == 0) != (after == 0):
            delays.append(delay)
        unstable = after
    return delays


def test_windows_are_found_where_one_person_crosses(windows):
    (region,) = regions.regions(windows)
    assert region.axes == ("feedback_delay", "hip_stiffness")
    several = 0
    for column, hip in enumerate(region.y):
        changes = changes_of(float(hip))
        several += len(changes) > 1
        stands = region.field[:, column] > 0.0
        at = np.flatnonzero(stands[1:] != stands[:-1])
        assert len(at) == len(changes)
        share = region.field[at, column] / (region.field[at, column] - region.field[at + 1, column])
        np.testing.assert_allclose(region.x[at] + share * 0.005, changes, atol=3e-4)
    assert several > 5  # windows there are


def test_the_lines_of_windows_pass_between_verdicts(windows):
    (region,) = regions.regions(windows)
    verdicts = np.asarray(windows["stable"]).T == 1  # hip × delay in the study's order
    np.testing.assert_array_equal(region.stands, verdicts)


def test_crossings_of_a_locus_are_those_of_the_person(windows):
    delay = windows.study.axes["feedback_delay"]
    at = int(np.searchsorted(windows.study.axes["hip_stiffness"], 2500.0))
    decay, frequency = (np.asarray(windows[name])[at] for name in ("decay_rate", "sway_frequency"))
    found = crossings_of(delay, -decay + 2j * np.pi * frequency)
    np.testing.assert_allclose(found[:, 0], changes_of(2500.0), atol=3e-4)
    nerves = {"damping": tuple(DAMPED.values()), "feedback": sf.Feedback((P, 0, 0), (D, 0, 0))}
    person = sf.Body.edwards2007(), sf.Stiffness(468.0, 2000.0, 2500.0), GRAVITY
    omegas = {d: w for d, w, _ in sf.delay_crossings(*person, **nerves, longest=0.4)}
    nearest = [omegas[min(omegas, key=lambda d: abs(d - tau))] for tau in found[:, 0]]
    np.testing.assert_allclose(found[:, 2], nearest, rtol=0.02)


@pytest.mark.parametrize(
    ("long", "dims", "plane"),
    [
        ({"ankle_stiffness": 2, "hip_stiffness": 2}, "all", None),  # with gains no closed form
        ({"hip_stiffness": 20, "knee_stiffness": 30}, "all", ("knee_stiffness", "hip_stiffness")),
        ({"hip_stiffness": 20, "feedback_delay": 90}, "all", ("feedback_delay", "hip_stiffness")),
        (
            {"height": 9, "hip_stiffness": 20, "feedback_delay": 90}, "all",
            ("height", "hip_stiffness"),
        ),
        ({"height": 9, "feedback_delay": 90}, ("height",), None),
    ],
)  # fmt: skip
def test_the_plane_is_of_the_longest_axes_and_the_delay_last(long, dims, plane):
    starts = {"height": (1.5, 1.9), "feedback_delay": (0.0, 0.4)}
    stiffness, body, feedback = dict(SPRINGY, hip=500.0), dict(NOMINAL), {"delay": 0.1}
    for name, num in long.items():
        start, stop = starts.get(name, (100.0, 2000.0))
        axis = {"start": start, "stop": stop, "num": num}
        where = {"height": body, "feedback_delay": feedback}.get(name, stiffness)
        where[name.removesuffix("_stiffness").removeprefix("feedback_")] = axis
    study = sf.Study.from_dict({
        "body": body, "stiffness": stiffness, "output": {"quantities": ["stable"]},
        "feedback": {**feedback, "proportional": {"ankle": 500.0}},
    })  # fmt: skip
    own = study.axes_of("stable") if dims == "all" else dims
    assert planes.axes_of_plane(study, own) == plane


def test_an_atlas_with_feedback_gets_its_figures_and_they_are_legible(
    windows, charts, tmp_path, drawn
):
    names = [path.name for drawing in plot(windows, tmp_path) for path in drawing.paths]
    assert names == [
        f"w-{figure}.png"
        for figure in ("limits", "locus", "decay_rate", "sway_frequency", "unstable_roots")
    ]
    names = [path.name for drawing in plot(charts["critical"], tmp_path) for path in drawing.paths]
    assert names == ["critical-limits.png", "critical-critical_delay.png"]
    # one curve a delay, with all its lines and its name on it, and a word on each side
    check_legible(drawn)
    limits = drawn[5].axes[0]
    assert len(limits.lines) == len(DELAYS)
    words = {text.get_text() for text in limits.texts}
    assert words >= {r"$\tau$ = 0.1 s", "0.2 s", "0.3 s", "falls"}
    assert drawn[5].get_suptitle().replace("\n", " ") == (
        "edwards2007, $H$ = 1.753 m, $m$ = 75.3 kg, $K_a$ = 300, "
        "$K_k$ rigid, $K_h$ rigid, $g$ = 9.8 m/s²"
    )


def test_tables_count_the_lines_of_a_plane(windows, tmp_path):
    found = list(regions.regions(windows))
    table, _ = tables.write_tables(windows.study, found, tmp_path / "t")
    with table.open(encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    assert list(rows[0]) == ["feedback_delay [s]", "hip_stiffness [N·m/rad]", "line", "source"]
    assert {row["source"] for row in rows} == {"atlas"}  # no closed form is claimed
    assert {row["line"] for row in rows} == {"1", "2"}
    points = np.array([[float(value) for value in list(row.values())[:2]] for row in rows])
    np.testing.assert_allclose(points, np.concatenate(found[0].lines), rtol=1e-8)


def test_what_has_no_limits_gets_a_sentence(tmp_path):
    alone = study_of(
        {"ankle": 468.0, "knee": math.inf, "hip": math.inf},
        {"delay": {"start": 0, "stop": 0.5, "num": 11}, "proportional": {"ankle": 500.0}},
        ["stable"],
    )
    with pytest.raises(sf.InputError, match="ask for the quantity critical_delay"):
        regions.source_of(sf.sweep(alone, tmp_path / "a.h5"))
    planes_only = study_of(
        {"ankle": {"start": 0, "stop": 900, "num": 10}, "knee": math.inf,
         "hip": {"start": 0, "stop": 900, "num": 10}},
        {"delay": 0.1, "proportional": {"ankle": 500.0}},
        ["stable"],
    )  # fmt: skip
    with pytest.raises(sf.InputError, match="with feedback the limit of standing has no closed"):
        planes.require_closed_form(planes_only)


@pytest.mark.parametrize(
    "name",
    ["feedback", "delay-margin", "passive-support", "windows", "root-locus", "coupling"],
)
def test_studies_can_be_read(name):
    assert sf.Study.from_toml(STUDIES / f"{name}.toml").title


def test_a_negative_delay_margin_is_not_said_to_be_a_fall(tmp_path):
    """Beyond the critical delay a person may stand again."""
    content = {
        "gravity": GRAVITY,
        "body": NOMINAL,
        "stiffness": {"ankle": ANKLE, "knee": math.inf, "hip": math.inf},
        "feedback": {
            "proportional": {"ankle": 900.0},
            "derivative": {"ankle": 250.0},
            "delay": {"start": 0.0, "stop": 0.5, "num": 11},
        },
        "output": {"quantities": ["delay_margin", "decay_rate"]},
    }
    atlas = sf.sweep(content, tmp_path / "margin.h5")
    said = {}
    for quantity in content["output"]["quantities"]:
        (said[quantity],) = (
            text.get_text()
            for text in along.curves_of(atlas, quantity).texts
            if text.get_text() in ("falls", "beyond the critical delay")
        )
    assert said == {"delay_margin": "beyond the critical delay", "decay_rate": "falls"}


@pytest.mark.parametrize("gain", [0.0, 600.0])
def test_springs_say_who_falls_only_without_gains(gain, tmp_path):
    content = {
        "gravity": GRAVITY,
        "body": NOMINAL,
        "stiffness": {
            "ankle": {"start": 100.0, "stop": 2000.0, "num": 9},
            "knee": math.inf,
            "hip": {"start": 500.0, "stop": 2000.0, "num": 9},
        },
        "feedback": {"proportional": {"ankle": gain}, "delay": 0.1},
        "output": {"quantities": ["safety_factor", "stable"]},
    }
    atlas = sf.sweep(content, tmp_path / "springs.h5")
    curves = sf.plot.curves(atlas, "safety_factor", at={"hip": 2000.0})
    assert ("falls" in {text.get_text() for text in curves.texts}) == (gain == 0.0)
    # a line at 1 is one of the numbers' lines, not the limit, which is drawn by itself
    lines = [c.levels.tolist() for c in sf.plot.map(atlas, "safety_factor").collections
             if isinstance(c, ContourSet) and not c.filled]  # fmt: skip
    assert any(1.0 in levels for levels in lines) == (gain != 0.0)
