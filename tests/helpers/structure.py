"""What the sources say of themselves: imports wherever they stand, sizes, private names."""

import ast
from collections.abc import Iterator
from pathlib import Path

Trees = dict[str, ast.Module]


def trees_of(package: Path) -> Trees:
    """Every module of a package by its dotted name, an ``__init__`` by its package's."""
    trees = {}
    for path in sorted(package.rglob("*.py")):
        parts = path.relative_to(package.parent).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        trees[name] = ast.parse(path.read_text(encoding="utf-8"))
    return trees


def imported(tree: ast.AST) -> Iterator[tuple[str, ast.stmt]]:
    """All dotted names that are imported, also inside functions and for types alone."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            assert node.module is not None
            yield from ((f"{node.module}.{alias.name}", node) for alias in node.names)
        elif (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and node.value.startswith("standfast.")
            and node.value.replace(".", "").replace("_", "").isalnum()
        ):
            yield node.value, node  # the name of a module that is imported when it is asked for


def arrows(trees: Trees) -> dict[str, set[str]]:
    """Which modules of the package each module imports; longest known name of what is imported."""
    found: dict[str, set[str]] = {}
    for name, tree in trees.items():
        found[name] = set()
        for target, _ in imported(tree):
            while target not in trees and "." in target:
                target = target.rpartition(".")[0]  # noqa: PLW2901 - a name in a module
            if target in trees and target != name:
                found[name].add(target)
    return found


def room(module: str, rooms: list[str]) -> int:
    """The place of a module's room in the table; the longest match."""
    inside = module.partition(".")[2]
    fits = [r for r in rooms if inside == r or inside.startswith(f"{r}.")]
    return rooms.index(max(fits, key=len))


def upward_only(trees: Trees, rooms: list[str], doors: set[str]) -> list[str]:
    """Arrows that point downward in the table of rooms; doors may import anything."""
    return [
        f"{module} imports {target}"
        for module, targets in arrows(trees).items()
        for target in sorted(targets)
        if module not in doors and target not in doors and room(target, rooms) > room(module, rooms)
    ]


def circles(trees: Trees, doors: set[str]) -> list[str]:
    """Modules that reach themselves by their imports."""
    graph = arrows(trees)

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        waiting = [start]
        while waiting:
            for target in graph[waiting.pop()] - doors:
                if target not in seen:
                    seen.add(target)
                    waiting.append(target)
        return seen

    return [module for module in graph if module not in doors and module in reached(module)]


def late_imports(trees: Trees) -> list[str]:
    """Modules with imports inside functions."""
    return [
        name
        for name, tree in trees.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef)
        and any(isinstance(each, ast.Import | ast.ImportFrom) for each in ast.walk(node))
    ]


def long_functions(trees: Trees, most: int) -> list[str]:
    return [
        f"{name}.{node.name}"
        for name, tree in trees.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and (node.end_lineno or 0) - node.lineno + 1 > most
    ]


def foreign_privates(trees: Trees) -> list[str]:
    """Private names of one module of the package that another uses."""
    found = []
    for name, tree in trees.items():
        modules = set()
        for target, _ in imported(tree):
            if target.startswith("standfast"):
                last = target.rpartition(".")[2]
                modules.add(last)
                if last.startswith("_") and not last.startswith("__"):
                    found.append(f"{name}: {target}")
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom | ast.Import):
                for alias in node.names:
                    if alias.asname and getattr(node, "module", "standfast").startswith(
                        "standfast"
                    ):
                        modules.add(alias.asname)
            if (
                isinstance(node, ast.Attribute)
                and node.attr.startswith("_")
                and not node.attr.startswith("__")
                and node.attr not in NAMED_TUPLE
                and isinstance(node.value, ast.Name)
                and node.value.id in modules
            ):
                found.append(f"{name}: {node.value.id}.{node.attr}")
    return found


NAMED_TUPLE = {"_make", "_replace", "_asdict", "_fields"}


def calls(tree: ast.Module) -> set[str]:
    return {
        node.func.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
