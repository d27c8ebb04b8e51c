"""The examples of the documentation run, and say what they are said to say."""

import re
import tomllib
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import standfast as sf
from recordings import sway, table, write_two_plates
from standfast.population.people.study import PopulationStudy
from standfast.quantities import QUANTITIES
from standfast.recordings.measures import MEASURES

DOCS = Path(__file__).parents[1] / "docs"


@pytest.fixture
def names(monkeypatch):
    """What the page has defined at its end."""
    monkeypatch.setitem(QUANTITIES, "hip_moment", None)  # is taken away again after the test
    del QUANTITIES["hip_moment"]
    blocks = re.findall(
        r"```python\n(.*?)```", (DOCS / "in-python.md").read_text("utf-8"), re.DOTALL
    )
    space: dict = {}
    for block in blocks:
        if "scipy" in block and find_spec("scipy") is None:
            continue
        exec(block, space)  # noqa: S102 - the code of our own page
    return space


def check_brace(names):
    """Somebody has 1.1 and nobody less; less of one joint for as much of the other will not do."""
    assert names["brace"].success
    ankle, hip = 1000.0 * names["brace"].x

    def least(ankle, hip):
        stiffness = sf.Stiffness(ankle, 1500.0, hip)
        return min(sf.safety_factor(body, stiffness) for body in names["bodies"])

    assert least(ankle, hip) == pytest.approx(1.1, rel=1e-5)  # SLSQP stops at 1e-6 of kN·m/rad
    for step in (-20.0, 20.0):
        assert least(ankle + step, hip - step) < 1.1


def test_the_page_on_python_runs(names):
    assert names["can"].sum() > 900
    ankle, height, mass = names["ankle"], names["height"], names["mass"]
    for k, h, m in zip(ankle[:20], height, mass, strict=False):
        body = sf.Body.from_height_mass(float(h), float(m), "de-leva-female")
        stiffness = sf.Stiffness(float(k), 2000.0, 800.0)
        assert sf.safety_factor(body, stiffness, gravity=9.81) == pytest.approx(1.1, rel=1e-9)
    assert names["stand"].tolist() == [True, False]
    step, K = 1e-6, names["K"]
    for body, slope in zip(names["bodies"], names["slopes"].segment_com[:, 2], strict=True):
        ends = [
            sf.critical_stiffness(
                body._replace(segment_com=body.segment_com + np.array([0, 0, d])), K
            ).ankle
            for d in (-step, step)
        ]
        assert slope == pytest.approx((ends[1] - ends[0]) / (2 * step), rel=1e-6)
    body = sf.Body.from_height_mass(2.0, 120.0)
    if find_spec("scipy") is not None:
        check_brace(names)
    upper = 9.80665 * body.segment_mass[2] * body.segment_com[2]
    found = float(names["ds"].hip_moment.sel(bmi=30, height=2.0))
    np.testing.assert_allclose(found, np.radians(upper), rtol=1e-12)


def test_the_published_law_of_the_guides_is_a_study_and_says_its_numbers():
    page = (DOCS / "how-to" / "published-law.md").read_text("utf-8")
    (block,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    sways = (DOCS / "how-to" / "population-sway.md").read_text("utf-8")
    (of_sway,) = re.findall(r"^\[noise\].*?(?=^quantities)", sways, re.DOTALL | re.MULTILINE)
    head = '[population]\nbuiltin = "nhanes-2017-2018"\nsize = 1000\n'
    study = PopulationStudy.from_dict(tomllib.loads(head + block))
    noisy = PopulationStudy.from_dict(tomllib.loads(head + block + of_sway))
    assert noisy.sway == ("com_sway", "cop_sway", "cop_velocity", "cop_frequency")
    law = sf.LAWS["pasma-2017"]
    nerves = dict(study.nerves)
    assert nerves["feedback_delay"].numbers == (law.delay,)
    for given, printed in (
        (study.distributions[0], law.stiffness.ankle),
        (nerves["ankle_damping"], law.damping[0, 0]),
        (nerves["ankle_proportional_gain"], law.feedback.proportional[0, 0]),
        (nerves["ankle_derivative_gain"], law.feedback.derivative[0, 0]),
    ):
        assert given.relative_to == "mgh"
        assert given.numbers[0] == pytest.approx(printed / law.load, abs=5e-5)


def test_the_page_on_recordings_runs(tmp_path, monkeypatch):
    page = (DOCS / "recordings.md").read_text("utf-8")
    _, block = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    _, ap, ml = sway()
    text = table(["COP_AP", "COP_ML"], [1e3 * ap, 1e3 * ml])
    (tmp_path / "recording.csv").write_text(text, encoding="utf-8")
    write_two_plates(tmp_path / "two-plates.csv")
    monkeypatch.chdir(tmp_path)
    space: dict = {}
    exec(block, space)  # noqa: S102 - the code of our own page
    assert space["measures"].sd_ap == pytest.approx(ap.std(ddof=1), rel=1e-2)  # after the low-pass
    for holds in MEASURES.values():
        assert holds.meaning.split(",")[0] in page
