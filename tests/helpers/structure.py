"""What sources say of themselves: imports wherever they stand, sizes, private names.

Each rule is a function of the sources of a folder and returns what breaks it.
"""

import ast
import re
from collections.abc import Collection, Iterator
from pathlib import Path

Trees = dict[str, ast.Module]

MODULE_IN_TEXT = re.compile(r"standfast(\.[a-z]\w*)+")
PRIVATE_IN_TEXT = re.compile(r"standfast(\.\w+)*\._[a-z]\w*")
NAMED_TUPLE = {"_make", "_replace", "_asdict", "_fields"}


def trees_of(package: Path) -> Trees:
    """Every module of a package by its dotted name, an ``__init__`` by its package's."""
    trees = {}
    for path in sorted(package.rglob("*.py")):
        parts = path.relative_to(package.parent).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        trees[name] = ast.parse(path.read_text(encoding="utf-8"))
    return trees


def imported(tree: ast.AST) -> Iterator[str]:
    """All dotted names that are imported, also in functions, for types alone, or by a text."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif (text := text_of(node)) and MODULE_IN_TEXT.fullmatch(text):
            yield text


def text_of(node: ast.AST) -> str:
    """What stands there, if it is a text."""
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def arrows(trees: Trees) -> dict[str, set[str]]:
    """Which modules of the package each module imports; longest known name of what is imported."""
    found: dict[str, set[str]] = {}
    for name, tree in trees.items():
        found[name] = set()
        for what in imported(tree):
            target = what
            while target not in trees and "." in target:
                target = target.rpartition(".")[0]
            if target in trees and target != name:
                found[name].add(target)
    return found


def room(module: str, rooms: list[str]) -> int:
    """The place of a module's room in the table; the longest match, -1 if it has none."""
    inside = module.partition(".")[2]
    fits = [r for r in rooms if inside == r or inside.startswith(f"{r}.")]
    return rooms.index(max(fits, key=len)) if fits else -1


def not_upward(trees: Trees, rooms: list[str], doors: Collection[str]) -> list[str]:
    """Arrows that point down in the table of rooms, or back to a door, which may import all."""
    return [
        f"{module} imports {target}"
        for module, targets in arrows(trees).items()
        for target in sorted(targets)
        if module not in doors and (target in doors or room(target, rooms) > room(module, rooms))
    ]


def circles(trees: Trees) -> list[str]:
    """Modules that reach themselves by their imports."""
    graph = arrows(trees)

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        waiting = [start]
        while waiting:
            new = graph[waiting.pop()] - seen
            seen |= new
            waiting += new
        return seen

    return [module for module in graph if module in reached(module)]


def late_imports(trees: Trees) -> list[tuple[str, str]]:
    """Modules and what they import inside functions; "?" where it is not written there."""
    found = []
    for name, tree in trees.items():
        for function in functions(tree):
            found += [(name, what.split(".")[0]) for what in imported(function)]
            if called(function) & {"import_module", "importlib.import_module", "__import__"}:
                found.append((name, "?"))
    return found


def functions(tree: ast.AST) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
    return [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]


def long_functions(trees: Trees, most: int) -> list[str]:
    return [
        f"{name}.{each.name}"
        for name, tree in trees.items()
        for each in functions(tree)
        if (each.end_lineno or 0) - each.lineno + 1 > most
    ]


def long_modules(package: Path, most: int) -> list[str]:
    return [
        str(path.relative_to(package))
        for path in sorted(package.rglob("*.py"))
        if len(path.read_text(encoding="utf-8").splitlines()) > most
    ]


def users_of(library: str, trees: Trees) -> set[str]:
    return {
        name
        for name, tree in trees.items()
        if any(what.split(".")[0] == library for what in imported(tree))
    }


def talkers(trees: Trees) -> set[str]:
    """Modules that print, ask or exit, in any of the ways to do so."""
    talk = {"print", "input", "exit", "quit", "sys.exit", "os._exit", "SystemExit"}
    streams = {"sys.stdout", "sys.stderr", "sys.stdin"}
    return {
        name
        for name, tree in trees.items()
        if called(tree) & talk
        or {dotted(node) for node in ast.walk(tree) if isinstance(node, ast.Attribute)} & streams
        or any(isinstance(n, ast.Raise) and dotted(n.exc) == "SystemExit" for n in ast.walk(tree))
    }


def called(tree: ast.AST) -> set[str]:
    """Dotted names of all that is called."""
    return {dotted(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}


def dotted(node: ast.AST | None) -> str:
    """``a.b.c`` of such an expression, else nothing."""
    if isinstance(node, ast.Attribute):
        before = dotted(node.value)
        return f"{before}.{node.attr}" if before else ""
    return node.id if isinstance(node, ast.Name) else ""


def is_private(name: str) -> bool:
    return name.strip("_") != "" and name[0] == "_" != name[1] and name not in NAMED_TUPLE


def private_names(tree: ast.AST) -> set[str]:
    """Private names that a module makes: functions, classes, variables, attributes."""
    made = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            made.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            made.add(node.id)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            made.add(node.attr)
    return {name for name in made if is_private(name)}


def foreign_privates(trees: Trees, ours: Trees) -> list[str]:
    """Uses, in some sources, of private names that another module of ours makes.

    Imported, as an attribute of whatever, named to ``setattr`` and its kin, or in a dotted text.
    """
    made = {name: private_names(tree) for name, tree in ours.items()}
    everywhere = set().union(*made.values())
    found = []
    for name, tree in trees.items():
        used, of_others = set(), everywhere - made[name]
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom):
                used |= {alias.name for alias in node.names} & of_others
            elif isinstance(node, ast.Attribute):
                used |= {node.attr} & of_others
            elif isinstance(node, ast.Call) and dotted(node.func).endswith("attr"):
                used |= {text_of(each) for each in node.args[1:2]} & of_others
            elif PRIVATE_IN_TEXT.fullmatch(text_of(node)):
                used.add(text_of(node))
        found += [f"{name}: {each}" for each in sorted(used)]
    return found
