"""Every public name has an example in its docstring, which prints what it says."""

import doctest
import inspect
import re
from functools import cached_property
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

import standfast as sf
from example_files import make_files
from standfast.population.summary.file import Population
from standfast.quantities import QUANTITIES

DOCS = Path(__file__).parents[1] / "docs"
# Tables and a text, which have no docstring; the page of reference has examples of them.
TABLES = {"BODY_MODELS", "LAWS", "__version__"}
# What runs and files ask of studies and persons; no program of a user calls it.
MACHINERY = {
    "Person.of",
    "PopulationStudy.block_persons",
    "PopulationStudy.difference",
    "PopulationStudy.from_canonical",
    "Study.check_size",
    "Study.difference",
    "Study.from_canonical",
}
# Classes that hold what a call returns; the call's example shows them.
RETURNED = {
    "ExpectedSway",
    "Population",
    "PopulationStudy",
    "Study",
    "SwayFit",
    "SwayMeasures",
}


def methods_of(kind):
    """Return the names of the public methods of a class, without its values."""
    own = [name for name in vars(kind) if not name.startswith("_")]
    values = (property, cached_property)
    methods = [name for name in own if not isinstance(vars(kind)[name], values)]
    return [name for name in methods if inspect.isroutine(getattr(kind, name))]


def public():
    """Return every public name with what it stands for: functions, classes and their methods."""
    found = {name: getattr(sf, name) for name in sf.__all__ if name not in TABLES | {"plot"}}
    found |= {f"plot.{name}": getattr(sf.plot, name) for name in sf.plot.__all__}
    found["Population"] = Population
    for name, each in list(found.items()):
        if inspect.isclass(each):
            found |= {f"{name}.{method}": getattr(each, method) for method in methods_of(each)}
    return {name: each for name, each in found.items() if name not in MACHINERY}


PUBLIC = public()


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The files that examples read."""
    folder = tmp_path_factory.mktemp("examples")
    make_files(folder)
    return folder


@pytest.fixture
def own_quantities(monkeypatch):
    """Take away again what an example adds to the table."""
    before = dict(QUANTITIES)
    yield
    QUANTITIES.clear()
    QUANTITIES.update(before)


def examples_of(name):
    """Return the examples of a name, those of its methods apart."""
    text = inspect.getdoc(PUBLIC[name])
    return doctest.DocTestParser().get_doctest(text or "", {}, name, None, 0)


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_name_says_what_it_is_and_has_an_example(name):
    text = inspect.getdoc(PUBLIC[name])
    assert text, f"{name} has no docstring"
    if name not in RETURNED:
        assert "\nExamples\n--------\n" in text, f"{name} has no section of examples"
        assert examples_of(name).examples


@pytest.mark.parametrize("name", [name for name in PUBLIC if examples_of(name).examples])
def test_its_example_prints_what_it_says(name, files, own_quantities, monkeypatch):
    monkeypatch.chdir(files)
    said = []
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    runner.run(examples_of(name), out=said.append)
    plt.close("all")
    assert runner.summarize(verbose=False).failed == 0, "".join(said)


def test_the_page_of_reference_lists_every_public_name():
    page = (DOCS / "reference" / "python.md").read_text("utf-8")
    listed = set(re.findall(r"^   ([A-Za-z_.]+)$", page, re.MULTILINE))
    assert {name.removeprefix("plot.") for name in PUBLIC if not methods_only(name)} <= listed
    assert all(f"sf.{name}" in page for name in TABLES)


def methods_only(name):
    """Return whether a name is of a method, which the page of its class has."""
    return "." in name.removeprefix("plot.")


def test_an_example_that_prints_something_else_is_found():
    wrong = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, 0)
    assert doctest.DocTestRunner().run(wrong, out=lambda _: None).failed == 1


def test_what_needs_no_example_is_there():
    assert set(sf.__all__) >= TABLES
    for name in MACHINERY:
        kind, method = name.split(".")
        assert callable(getattr(getattr(sf, kind), method))
