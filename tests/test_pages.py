"""What README and the pages of docs/ show runs, and prints what they say it prints."""

import copy
import csv
import math
import re
import shutil
import subprocess
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

import populations
import standfast as sf
from c3d_files import Plate, person, write_c3d
from fits import fits_once
from pages import commands_of, not_printed, run_page, words_of
from recordings import sway, table, write_two_plates
from standfast.quantities import QUANTITIES
from standfast.study import grid
from studies import GOOD, toml_of

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
SECTIONS = ("how-to", "reference", "explanation")
PAGES = [
    ROOT / "README.md",
    *sorted(DOCS.glob("*.md")),
    *sorted(page for folder in SECTIONS for page in DOCS.glob(f"{folder}/*.md")),
]
RUN_ELSEWHERE = {"in-python.md"}  # tests/test_docs.py, which compares its numbers too
LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)\s]*))?\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)


def page_id(page: Path) -> str:
    return str(page.relative_to(ROOT))


def an_atlas(name: str) -> None:
    study = copy.deepcopy(GOOD)
    model = "edwards2007" if name == "edwards.h5" else "winter"
    study["body"] = {"model": model, "height": [1.60, 1.75], "bmi": 24}
    study["stiffness"] |= {"knee": [1200, 2000], "ankle": [0, 500, 1000], "hip": [300, 500, 900]}
    study["output"]["quantities"] = ["stable", "critical_ankle_stiffness", "safety_factor"]
    sf.sweep(study, name)


def a_study_to_draw(num: int = 8) -> dict:
    """Two axes of eight values or more, two knees, and the Moon."""
    study = copy.deepcopy(GOOD)
    side = {"start": 300.0, "stop": 2000.0, "num": num}
    study["gravity"] = [1.62, 9.81]
    study["body"] = {"model": "winter", "height": 1.75, "mass": 75}
    study["stiffness"] = {"ankle": side, "knee": [1200, 2000], "hip": side}
    study["output"]["quantities"] = ["frequency", "safety_factor"]
    return study


def an_atlas_to_draw(name: str) -> None:
    sf.sweep(a_study_to_draw(), name)


def some_subjects(name: str) -> None:
    """Those that the page shows."""
    page = (DOCS / "figures.md").read_text("utf-8")
    (lines,) = re.findall(r"^id,height.*?(?=^```)", page, re.MULTILINE | re.DOTALL)
    Path(name).write_text(lines, encoding="utf-8")


def a_study_of_shards(name: str) -> None:
    Path(name).write_text(toml_of(a_study_to_draw(num=2000)), encoding="utf-8")


def a_swaying_person(name: str) -> None:
    content = {
        "body": {"height": 1.7, "mass": 70.0}, "output": {"quantities": ["cop_sway"]},
        "stiffness": {"ankle": 400.0, "knee": math.inf, "hip": math.inf},
        "damping": {"ankle": 30.0}, "noise": {"ankle": 0.4},
        "feedback": {
            "proportional": {"ankle": 600.0}, "derivative": {"ankle": 150.0}, "delay": 0.1,
        },
    }  # fmt: skip
    Path(name).write_text(toml_of(content), encoding="utf-8")


def some_people(name: str, count: int = 40) -> None:
    random = np.random.default_rng(3)
    with Path(name).open("w", encoding="utf-8") as file:
        lines = csv.writer(file)
        lines.writerow(["id", "sex", "age", "height", "mass"])
        for number in range(count):
            height = random.normal(1.68, 0.08)
            mass = random.normal(25.0, 3.0) * height**2
            age, sex = random.integers(20, 90), "mf"[number % 2]
            lines.writerow([number, sex, age, f"{height:.3f}", f"{mass:.1f}"])


def a_recording(name: str) -> None:
    time, ap, ml = sway()
    text = table(["t (s)", "COP_AP (mm)", "COP_ML (mm)"], [time, 1e3 * ap, 1e3 * ml])
    Path(name).parent.mkdir(exist_ok=True)
    Path(name).write_text(text, encoding="utf-8")


def on_two_plates(name: str) -> None:
    write_two_plates(Path(name))


def in_c3d(name: str) -> None:
    _, force, point = person()
    write_c3d(Path(name), [Plate()], [(force, point)])


def a_population(name: str) -> None:
    content = toml_of(populations.changed("population.size", 1000))
    Path(name).write_text(content, encoding="utf-8")


# What a page takes as given, in the folder in which we are; other pages make theirs.
GIVEN = {
    "study.md": {"winter.h5": an_atlas, "edwards.h5": an_atlas},
    "population.md": {"people.csv": some_people},
    "people.md": {"men.csv": some_people, "women.csv": some_people, "people.toml": a_population},
    "explore.md": {"atlas.h5": an_atlas},
    "figures.md": {
        "study.h5": an_atlas_to_draw, "winter.h5": an_atlas, "edwards.h5": an_atlas,
        "subjects.csv": some_subjects,
    },
    "many-machines.md": {"study.toml": a_study_of_shards},
    "reading-files.md": {"study.h5": an_atlas},
    "recordings.md": {
        "recording.csv": a_recording, "S1/one.csv": a_recording, "S1/two.csv": a_recording,
        "person.toml": a_swaying_person, "two-plates.csv": on_two_plates, "recording.c3d": in_c3d,
    },
    "sway.md": {"recording.csv": a_recording},
}  # fmt: skip


@pytest.fixture(scope="module")
def one_fit_each():
    """Pages show a fit as a command and in Python."""
    with fits_once():
        yield


@pytest.fixture
def desk(tmp_path, monkeypatch, one_fit_each):
    """A folder of a reader, with our studies, and a package as a reader has it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(grid, "SHARD_WORK", 512)  # the tests make it small
    shutil.copytree(ROOT / "studies", "studies")
    own = set(QUANTITIES)
    yield tmp_path
    plt.close("all")
    for name in set(QUANTITIES) - own:  # added by a page
        del QUANTITIES[name]


@pytest.mark.parametrize(
    "page", [page for page in PAGES if page.name not in RUN_ELSEWHERE], ids=page_id
)
def test_a_page_runs(page, desk, capsys):
    for name, make in GIVEN.get(page.name, {}).items():
        make(name)
    run_page(page, capsys)


def anchors(path: Path) -> set[str]:
    """The places of a page that a code host names after its headings."""
    headings = HEADING.findall(path.read_text("utf-8"))
    words = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in headings)
    return {word.replace(" ", "-") for word in words}


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_a_page_leads_to_what_is_there(page):
    text = page.read_text("utf-8")
    for target, anchor in LINK.findall(text):
        if "://" in target:
            continue
        path = (page.parent / target).resolve() if target else page
        assert path.exists(), target
        assert path.is_relative_to(ROOT), target
        assert not anchor or anchor in anchors(path), f"{target}#{anchor}"


def test_the_lines_of_r_read_what_is_in_the_file(desk):
    """The page's own lines; R counts axes the other way round, and from 1."""
    if shutil.which("Rscript") is None:
        pytest.skip("R is not at hand")
    loaded = ["Rscript", "-e", "library(rhdf5)"]
    if subprocess.run(loaded, capture_output=True, check=False).returncode:
        pytest.skip("rhdf5 is not at hand in R")
    study = copy.deepcopy(GOOD)
    study["body"] = {"model": "winter", "height": 1.66, "mass": 68}
    joints = {"ankle": [500, 900, 1500, 2000], "knee": [1200, math.inf], "hip": [300, 500, 900]}
    study["stiffness"] = joints
    sf.sweep(study, "study.h5")
    page = (DOCS / "how-to" / "matlab-and-r.md").read_text("utf-8")
    (lines,) = re.findall(r"^```r\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    asked = "cat('told', dim(verdict), sum(verdict), verdict[4, 1, 2], ankle, mean(verdict))"
    Path("page.R").write_text(f"{lines}\n{asked}\n", encoding="utf-8")
    done = subprocess.run(["Rscript", "page.R"], capture_output=True, text=True, check=True)
    told = [float(word) for word in done.stdout.partition("told")[2].split()]
    with sf.open_atlas("study.h5") as atlas:
        verdict, ankle = atlas["stable"][...], atlas.axes["ankle_stiffness"]
        assert 0 < verdict.sum() < verdict.size
        expected = [*verdict.shape, verdict.sum(), verdict[3, 0, 1], *ankle, verdict.mean()]
    assert told == pytest.approx(expected, rel=1e-6)  # R prints seven digits


WRONG = {
    "a command that is refused": ("sh", "standfast person --height 175", "height"),
    "a line that is not printed": ("console", "$ standfast laws\nno-such-law", "no-such-law"),
    "a key that is not known": ("toml", "[body]\nheigth = 1.7\nmass = 70", "heigth"),
    "a cell that fails": ("{code-cell}", ":tags: [x]\n1 / 0", "division"),
    "a command in a cell": ("{code-cell}", "%%sh\nstandfast sweep no.toml", "no.toml"),
    "python that fails": ("python", "1 / 0", "division"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_example_would_be_noticed(what, tmp_path, capsys):
    language, block, words = WRONG[what]
    text = f"```{language}\n{block}\n```\n"
    page = tmp_path / "page.md"
    page.write_text(f"# A page\n\n{text}", encoding="utf-8")
    with pytest.raises((AssertionError, ZeroDivisionError), match=words):
        run_page(page, capsys)
    page.write_text(f"# A page\n\n<!-- skip: next -->\n\n{text}", encoding="utf-8")
    run_page(page, capsys)


def test_lines_of_a_console_are_found_in_their_order():
    (command, lines), other = commands_of("$ standfast a \\\n  --b\nx\n\n…\n  z\n$ standfast c\n")
    assert command.split() == ["standfast", "a", "--b"]
    assert not_printed(lines, "x\ny\nz\n") is None
    assert not_printed(lines, "z\nx\n") == "  z"
    assert other == ("standfast c", [])


def test_patterns_and_redirections_are_those_of_a_shell(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in ("b.csv", "a.csv"):
        Path(name).touch()
    assert words_of("standfast sway *.csv --fit  # all") == [
        "standfast", "sway", "a.csv", "b.csv", "--fit",
    ]  # fmt: skip
    Path("page.md").write_text("```sh\nstandfast cite > found.bib\n```\n", encoding="utf-8")
    run_page(Path("page.md"), capsys)
    assert "@misc{standfast" in Path("found.bib").read_text("utf-8")
