"""The house: a room imports only from rooms above it, and nothing goes in circles."""

from pathlib import Path

import pytest

import standfast
from structure import (
    circles,
    foreign_privates,
    late_imports,
    long_functions,
    long_modules,
    not_upward,
    room,
    talkers,
    trees_of,
    users_of,
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
    "recordings",
    "fitting",
    "thresholds",
    "figures",
    "plot",
    "edwards2007",
    "explore",
    "cli",
]
# They hand on what is inside, and nobody inside comes through them.
DOORS = {"standfast", "standfast.__main__"}
MOST_LINES, LONGEST_FUNCTION = 300, 60
USES_HDF5 = {
    "standfast.atlas.layout",
    "standfast.atlas.checking",
    "standfast.atlas.reader",
    "standfast.atlas.writer",
    "standfast.population.simulation",
    "standfast.population.summary.keeping",
    "standfast.population.summary.writing",
    "standfast.thresholds.tables",
}
# What is no dependency but extras; pyplot, for whoever gives no axes; and a door, at which h5py,
# JAX and the figures wait to be asked for.
LATE = {
    ("standfast.atlas.memory", "xarray"),
    ("standfast.atlas.reader", "h5netcdf"),
    ("standfast.atlas.reader", "xarray"),
    ("standfast.population.people.decoding", "pandas"),
    ("standfast.figures.style", "matplotlib"),
    ("standfast.recordings.c3d_file", "c3d"),
    ("standfast", "?"),
    ("standfast", "standfast"),
}


@pytest.fixture(scope="module")
def trees():
    return trees_of(PACKAGE)


def rooms_of(modules):
    return {module.split(".")[1] for module in modules}


def test_every_module_has_a_room_and_every_room_a_module(trees):
    places = {room(module, ROOMS) for module in set(trees) - DOORS}
    assert places == set(range(len(ROOMS)))


def test_imports_go_upward_only(trees):
    assert not_upward(trees, ROOMS, DOORS) == []


def test_nothing_goes_in_circles(trees):
    assert circles(trees) == []


def test_the_road_does_not_lie_in_functions(trees):
    late = {(module, what) for module, what in late_imports(trees) if ".cli" not in module}
    assert late == LATE


def test_modules_and_functions_are_small(trees):
    assert long_functions(trees, LONGEST_FUNCTION) == []
    assert long_modules(PACKAGE, MOST_LINES) == []


@pytest.mark.parametrize("folder", ["src/standfast", "tests", "benchmarks"])
def test_no_private_name_is_used_elsewhere(trees, folder):
    own = trees_of(ROOT / folder)
    assert foreign_privates(own, own | trees) == []


def test_only_the_engine_traces_and_only_files_use_hdf5(trees):
    assert rooms_of(users_of("jax", trees)) == {"engine"}
    assert users_of("h5py", trees) == USES_HDF5


def test_only_the_command_line_prints_or_exits(trees):
    assert rooms_of(talkers(trees)) == {"cli"}


def house(tmp_path, **files):
    """A made-up package: sources by room, ``room__module`` for a module inside one."""
    package = tmp_path / "standfast"
    for name, source in {"": "", **files}.items():
        path = package.joinpath(*name.split("__"))
        path = path / "__init__.py" if not name else path.with_suffix(".py")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(source)
    return trees_of(package)


DOWN = "standfast.errors imports standfast.cli"
WAYS_DOWN = {
    "plain": ("from standfast import cli\n", DOWN),
    "in a function": ("def f():\n    from standfast.cli import main\n", DOWN),
    "in a method": ("class A:\n    def f(self):\n        import standfast.cli\n", DOWN),
    "for types": ("if TYPE_CHECKING:\n    from standfast.cli import main\n", DOWN),
    "by a text": ("import_module('standfast.cli')\n", DOWN),
    "by a lazy table": ("LAZY = {'main': 'standfast.cli'}\n", DOWN),
    "by the door": ("from standfast import sweep\n", "standfast.errors imports standfast"),
}


@pytest.mark.parametrize("way", WAYS_DOWN)
def test_an_arrow_downward_would_be_noticed(tmp_path, way):
    source, arrow = WAYS_DOWN[way]
    assert not_upward(house(tmp_path, errors=source, cli=""), ROOMS, DOORS) == [arrow]


def test_an_arrow_downward_inside_population_would_be_noticed(tmp_path):
    broken = house(
        tmp_path,
        population__people__keys="from standfast.population.cohort import counting\n",
        population__cohort__counting="from standfast.population import simulation\n",
        population__simulation="from standfast.population.people.keys import x\n",
    )
    assert not_upward(broken, ROOMS, DOORS) == [
        "standfast.population.cohort.counting imports standfast.population.simulation",
        "standfast.population.people.keys imports standfast.population.cohort.counting",
    ]
    assert len(circles(broken)) == 3


def test_a_circle_inside_a_room_would_be_noticed(tmp_path):
    one, other = "from standfast.run.b import x\n", "def f():\n    import standfast.run.a\n"
    broken = house(tmp_path, run__a=one, run__b=other, run__c=one)
    assert circles(broken) == ["standfast.run.a", "standfast.run.b"]
    assert not_upward(broken, ROOMS, DOORS) == []


def test_a_module_without_a_room_would_be_noticed(tmp_path):
    assert room("standfast.utils", ROOMS) == -1
    assert set(house(tmp_path, utils="")) - DOORS == {"standfast.utils"}


def test_late_imports_would_be_noticed(tmp_path):
    broken = house(
        tmp_path,
        study="def f():\n    import json.decoder\n",
        run="class A:\n    async def f(self):\n        from rich import print\n",
        atlas="import importlib\ndef f(name):\n    importlib.import_module(name)\n",
        engine="if TYPE_CHECKING:\n    import jax\n",
    )
    assert late_imports(broken) == [
        ("standfast.atlas", "?"), ("standfast.run", "rich"), ("standfast.study", "json"),
    ]  # fmt: skip


def test_what_is_too_long_would_be_noticed(tmp_path):
    fits = "def f():\n" + "    x = 1\n" * (LONGEST_FUNCTION - 1)
    module = "\n" * MOST_LINES
    small = house(tmp_path, study=fits, run=module)
    assert long_functions(small, LONGEST_FUNCTION) == []
    assert long_modules(tmp_path / "standfast", MOST_LINES) == []
    large = house(tmp_path, study=fits + "    x = 1\n", run=module + "\n")
    assert long_functions(large, LONGEST_FUNCTION) == ["standfast.study.f"]
    assert long_modules(tmp_path / "standfast", MOST_LINES) == ["run.py"]


@pytest.mark.parametrize("use", [
    "from standfast.run.lock import _held\n",
    "from standfast.run import lock\nlock._held\n",
    "import standfast\nstandfast.run.lock._held\n",
    "import sys\nsys.modules['standfast.run.lock']._held\n",
    "def f(job):\n    return job._count\n",
    "def f(patch, lock):\n    patch.setattr(lock, '_held', 1)\n",
    "def f(patch):\n    patch.setattr('standfast.run.lock._else', 1)\n",
])  # fmt: skip
def test_a_private_name_used_elsewhere_would_be_noticed(tmp_path, use):
    lock = "def _held():\n    return _held\nclass Job:\n    def f(self):\n        self._count = 1\n"
    broken = house(tmp_path, run__lock=lock, atlas=use)
    (found,) = foreign_privates(broken, broken)
    assert found.startswith("standfast.atlas: ")
    allowed = house(
        tmp_path, run__lock=lock, atlas="def _own(x):\n    return x._make(_own, x._q)\n"
    )
    assert foreign_privates(allowed, allowed) == []


@pytest.mark.parametrize("source", [
    "print(1)\n", "import sys\ndef f():\n    sys.exit(1)\n", "raise SystemExit\n",
    "raise SystemExit(2)\n", "import sys\nsys.stderr.write('x')\n", "input()\n",
])  # fmt: skip
def test_a_talker_would_be_noticed(tmp_path, source):
    assert talkers(house(tmp_path, study=source, run="x = 'print'\n")) == {"standfast.study"}


def test_users_of_a_library_would_be_noticed(tmp_path):
    broken = house(tmp_path, study="def f():\n    from jax.numpy import sin\n", run="jaxlike = 1\n")
    assert users_of("jax", broken) == {"standfast.study"}
