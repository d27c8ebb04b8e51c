"""A module imports only from above itself."""

import ast
from pathlib import Path

import pytest

import standfast

PACKAGE = Path(standfast.__file__).parent

# What each module may import from the package; the table of CONTRIBUTING.md.
MAY_IMPORT = {
    "quantities": set(),
    "arithmetic": set(),
    "body": {"quantities", "arithmetic"},
    "dynamics": {"quantities", "arithmetic", "body"},
    "cubic": {"arithmetic"},
    "eigen": {"arithmetic"},
    "stability": {"quantities", "arithmetic", "body", "dynamics", "cubic", "eigen"},
    "modes": {"quantities", "arithmetic", "body", "dynamics", "cubic", "eigen", "stability"},
    "certainty": {"body", "stability"},
    "study": {"quantities", "body"},
    "engine": {"arithmetic", "body", "stability", "certainty", "modes", "study"},
    "store": {"quantities", "study"},
    "sweep": {"quantities", "study", "engine", "store"},
    "thresholds": {"quantities", "body", "stability", "study", "store"},
    "figures": {"quantities"},
    "plots": {"quantities", "study", "store", "thresholds", "figures"},
    "population": {
        "quantities",
        "arithmetic",
        "body",
        "dynamics",
        "stability",
        "modes",
        "study",
        "engine",
        "store",
        "figures",
    },
    "edwards2007": {"body", "dynamics", "stability", "modes", "figures"},
}
EVERYTHING = {"__init__", "__main__", "cli"}
# Only these may print; only these may use JAX by name.
MAY_PRINT = {"cli"}
MAY_TRACE = {"engine"}


def modules():
    return sorted(
        path.relative_to(PACKAGE).with_suffix("").parts[0]
        for path in PACKAGE.rglob("*.py")
        if path.relative_to(PACKAGE).parts[0] != "__pycache__"
    )


def sources(module: str):
    folder = PACKAGE / module
    paths = sorted(folder.rglob("*.py")) if folder.is_dir() else [PACKAGE / f"{module}.py"]
    return [ast.parse(path.read_text(encoding="utf-8")) for path in paths]


def imports(module: str):
    """All dotted names that a module imports, also inside functions."""
    for tree in sources(module):
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                yield from (alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, "imports are absolute"
                yield node.module
                yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_the_table_names_every_module():
    assert set(modules()) == set(MAY_IMPORT) | EVERYTHING


@pytest.mark.parametrize("module", MAY_IMPORT)
def test_imports_go_upward_only(module):
    inside = {
        name.split(".")[1]
        for name in imports(module)
        if name.startswith("standfast.") and name.split(".")[1] in set(MAY_IMPORT) | EVERYTHING
    }
    assert inside - {module} <= MAY_IMPORT[module]


@pytest.mark.parametrize("module", sorted(set(MAY_IMPORT) - MAY_TRACE))
def test_physics_is_not_tied_to_jax(module):
    assert not any(name.split(".")[0] == "jax" for name in imports(module))


@pytest.mark.parametrize("module", sorted(set(MAY_IMPORT) - MAY_PRINT))
def test_only_the_command_line_prints_or_exits(module):
    calls = {
        node.func.id
        for tree in sources(module)
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    assert not calls & {"print", "exit", "input"}
