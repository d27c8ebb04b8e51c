"""The house: a room imports only from rooms above it, and nothing goes in circles."""

import ast
from pathlib import Path

import pytest

import standfast
from structure import (
    calls,
    circles,
    foreign_privates,
    imported,
    late_imports,
    long_functions,
    trees_of,
    upward_only,
)

PACKAGE = Path(standfast.__file__).parent
ROOT = PACKAGE.parents[1]
# From the top down; CONTRIBUTING.md says what each holds.
ROOMS = [
    "version",
    "errors",
    "files",
    "numerics",
    "parameters",
    "anthropometry",
    "mechanics",
    "stability",
    "quantities",
    "study",
    "engine",
    "run",
    "atlas",
    "population.people",
    "population.cohort",
    "population.summary",
    "population",
    "thresholds",
    "figures",
    "edwards2007",
    "cli",
]
# They only hand on what is inside, when it is asked for.
DOORS = {"standfast", "standfast.__main__", "standfast.population"}
MOST_LINES, LONGEST_FUNCTION = 300, 60
MAY_TRACE = {"engine"}
MAY_USE_HDF5 = {"atlas", "population", "thresholds"}
# Of what is no dependency but an extra, and of what only a terminal shows.
MAY_IMPORT_LATE = {"standfast.atlas.reader", "standfast.atlas.memory"}


@pytest.fixture(scope="module")
def trees():
    return trees_of(PACKAGE)


def room_of(module):
    return module.split(".")[1] if "." in module else ""


def test_the_table_names_every_room(trees):
    named = {name.split(".")[0] for name in ROOMS}
    assert {room_of(module) for module in trees} - {"", "__main__"} == named


def test_imports_go_upward_only(trees):
    assert upward_only(trees, ROOMS, DOORS) == []


def test_nothing_goes_in_circles(trees):
    assert circles(trees, DOORS) == []


def test_the_road_does_not_lie_in_functions(trees):
    late = {module for module in late_imports(trees) if room_of(module) != "cli"}
    assert late <= MAY_IMPORT_LATE


def test_modules_and_functions_are_small(trees):
    assert long_functions(trees, LONGEST_FUNCTION) == []
    lines = {
        path: len(path.read_text(encoding="utf-8").splitlines()) for path in PACKAGE.rglob("*.py")
    }
    assert {str(path): count for path, count in lines.items() if count > MOST_LINES} == {}


@pytest.mark.parametrize("folder", ["src/standfast", "tests", "benchmarks"])
def test_no_private_name_is_used_elsewhere(folder):
    assert foreign_privates(trees_of(ROOT / folder)) == []


def test_only_the_engine_traces_and_only_files_use_hdf5(trees):
    for library, rooms in (("jax", MAY_TRACE), ("h5py", MAY_USE_HDF5)):
        users = {
            room_of(module)
            for module, tree in trees.items()
            if any(name.split(".")[0] == library for name, _ in imported(tree))
        }
        assert users == rooms


def test_only_the_command_line_prints_or_exits(trees):
    for module, tree in trees.items():
        if room_of(module) != "cli":
            assert not calls(tree) & {"print", "exit", "input"}


# Each rule on a house that breaks it.
BROKEN = {
    "upward": {"errors": "from standfast import cli\n", "cli": ""},
    "hidden": {"errors": "def f():\n    from standfast.cli import main\n", "cli": "main = 1\n"},
    "lazy": {"errors": "import_module('standfast.cli')\n", "cli": ""},
    "circle": {"files": "import standfast.errors\n", "errors": "import standfast.files\n"},
}


def house(tmp_path, files):
    package = tmp_path / "standfast"
    package.mkdir()
    (package / "__init__.py").write_text("")
    for name, source in files.items():
        (package / f"{name}.py").write_text(source)
    return trees_of(package)


@pytest.mark.parametrize("how", ["upward", "hidden", "lazy", "circle"])
def test_an_arrow_downward_would_be_noticed(tmp_path, how):
    broken = house(tmp_path, BROKEN[how])
    assert upward_only(broken, ROOMS, DOORS)
    assert bool(circles(broken, DOORS)) == (how == "circle")


def test_other_faults_would_be_noticed(tmp_path):
    source = "def f():\n" + "    x = 1\n" * LONGEST_FUNCTION + "    import json\n    print(x)\n"
    private = "from standfast.errors import _hidden\nfrom standfast import errors\nerrors._other\n"
    broken = house(tmp_path, {"errors": source, "files": private})
    assert long_functions(broken, LONGEST_FUNCTION) == ["standfast.errors.f"]
    assert late_imports(broken) == ["standfast.errors"]
    assert len(foreign_privates(broken)) == 2
    assert calls(broken["standfast.errors"]) & {"print"}
    assert isinstance(broken["standfast"], ast.Module)
