"""``standfast laws``: published laws of feedback, and what becomes of them."""

import argparse
import json
import math
import textwrap
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import add_command
from standfast.parameters import DAMPING_UNIT, JOINTS, STIFFNESS_UNIT

if TYPE_CHECKING:
    from standfast.mechanics.law import Law

# How gains are called, in this order: symbol, name in a law, unit.
GAINS = (
    ("K", "stiffness", STIFFNESS_UNIT),
    ("B", "damping", DAMPING_UNIT),
    ("P", "proportional", STIFFNESS_UNIT),
    ("D", "derivative", DAMPING_UNIT),
)
COLUMNS = ("law", "joints", "K", "B", "P", "D", "delay", "stands", "lost", "confidence")


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _laws,
        "published laws of feedback: gains, delay, source, and who stands by them",
        "laws pasma-2017",
    )
    parser.add_argument("name", nargs="?", metavar="LAW", help="one law, whole (default: list all)")
    parser.add_argument("--json", action="store_true", help="as JSON")


def _laws(options: argparse.Namespace) -> None:
    from standfast.mechanics.laws import LAWS

    if options.name is None:
        if options.json:
            print(json.dumps([_facts(law) for law in LAWS.values()], ensure_ascii=False))
        else:
            _print_table(list(LAWS.values()))
        return
    law = _law_called(options.name)
    if options.json:
        print(json.dumps(_facts(law), ensure_ascii=False))
    else:
        _print_law(law)


def _law_called(name: str) -> "Law":
    from standfast.mechanics.laws import LAWS

    return LAWS[name]


def _print_table(laws: list["Law"]) -> None:
    rows = [COLUMNS, *map(_row, laws)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(COLUMNS))]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        print("  ".join(cells).rstrip())
    print(
        f"\nK, P in {STIFFNESS_UNIT}, B, D in {DAMPING_UNIT}, of both legs, joint by joint (*: and "
        "from joint to joint).\nstands: at its delay (ms); lost: the delay (ms) at which standing "
        "is lost; both computed here.\nOne law whole: standfast laws pasma-2017"
    )


def _row(law: "Law") -> tuple[str, ...]:
    critical, stands = _standing(law)
    differs = law.published is not None and law.published.stands is not stands
    gains = (_diagonal(law, name) for _, name, _ in GAINS)
    return (
        law.name,
        " ".join(law.joints),
        *gains,
        _ms(law.delay),
        ("yes" if stands else "no") + (" (published: not so)" if differs else ""),
        _lost_at(critical).removesuffix(" ms"),
        law.confidence,
    )


def _standing(law: "Law") -> tuple[float, bool]:
    """Return the critical delay, and whether the law stands at its own."""
    from standfast.stability.feedback import critical_delay, is_stable

    critical = critical_delay(**law.person)
    return critical, law.delay < critical or is_stable(**law.person)


def _matrix(law: "Law", name: str) -> list[list[float]]:
    """Return a gain, stiffness or damping over the free joints."""
    if name == "stiffness":
        free = [getattr(law.stiffness, joint) for joint in law.joints]
        return [[k if i == j else 0.0 for j in range(len(free))] for i, k in enumerate(free)]
    whole = law.damping if name == "damping" else getattr(law.feedback, name)
    indices = [JOINTS.index(joint) for joint in law.joints]
    return [[float(whole[i, j]) for j in indices] for i in indices]


def _diagonal(law: "Law", name: str) -> str:
    matrix = _matrix(law, name)
    own = [row[i] for i, row in enumerate(matrix)]
    crossed = any(value for i, row in enumerate(matrix) for j, value in enumerate(row) if i != j)
    return (" ".join(f"{value:.4g}" for value in own) if any(own) else "0") + " *" * crossed


def _print_law(law: "Law") -> None:
    from standfast.mechanics.law import CONFIDENCES

    print(f"{law.name}: {law.title}\n")
    for words, text in (
        ("source", law.source),
        ("confidence", f"{law.confidence}: {CONFIDENCES[law.confidence]}"),
        ("body", _body_in_words(law)),
        ("gravity", f"{law.gravity:g} m/s²"),
        ("delay", f"{_ms(law.delay)} ms"),
        ("left out", law.note),
    ):
        if text:
            head = f"  {words:12}"
            print(textwrap.fill(text, 100, initial_indent=head, subsequent_indent=" " * len(head)))
    print(f"\n  {'':12}{'as printed':34}both legs, rows: moment at {', '.join(law.joints)}")
    for symbol, name, unit in GAINS:
        printed = getattr(law.printed, name)
        matrix = _matrix(law, name)
        if any(value for row in matrix for value in row):
            lines = ["  ".join(f"{value:9.2f}" for value in row) for row in matrix]
            rows = printed.value if _is_matrix(printed.value) else [printed.value]
            given = [" ".join(f"{value:g}" for value in _list(row)) for row in rows]
            given[-1] += f" {printed.unit}"
            for number, line in enumerate(lines):
                left = given[number] if number < len(given) else ""
                right = f" {unit}" if number == len(lines) - 1 else ""
                print(f"  {symbol if number == 0 else '':12}{left:34}{line}{right}")
    _print_outcome(law)


def _print_outcome(law: "Law") -> None:
    facts = _computed(law)
    published = law.published
    said = "no outcome is stated"
    if published is not None:
        roots = ", ".join(map(_root, published.roots))
        said = _verdict(published.stands) + (f"; roots {roots} 1/s" if roots else "")
        said += f" (of {published.of})" if published.of != "this law" else ""
    print(f"\n  {'published':12}{said}")
    root = facts["rightmost_root"]
    rightmost = "not proven" if root is None else f"{_root(complex(*root))} 1/s"
    print(f"  {'computed':12}{_verdict(facts['stands'])}; rightmost root {rightmost}")
    print(f"  {'lost at':12}{_lost_at(facts['critical_delay'])}")


def _facts(law: "Law") -> dict[str, Any]:
    """Return all of a law as JSON says it."""
    published = law.published
    return {
        "name": law.name,
        "title": law.title,
        "source": law.source,
        "confidence": law.confidence,
        "joints": list(law.joints),
        "gravity": law.gravity,
        "load": law.load,
        "body": {name: part.tolist() for name, part in law.body._asdict().items()},
        "printed": {
            name: {
                "value": getattr(law.printed, name).value,
                "unit": getattr(law.printed, name).unit,
            }
            for _, name, _ in GAINS
        },
        **{name: _matrix(law, name) for _, name, _ in GAINS},
        "delay": law.delay,
        "left_out": law.note,
        "published": published
        and {
            "stands": published.stands,
            "roots": [_parts(root) for root in published.roots],
            "of": published.of,
        },
        "computed": _computed(law),
    }


def _computed(law: "Law") -> dict[str, Any]:
    from standfast.stability.feedback import rightmost_root, unstable_roots

    critical, stands = _standing(law)
    root: list[float] | None = None
    try:
        root = _parts(rightmost_root(**law.person))
    except ArithmeticError:  # not proven
        root = None
    return {
        "stands": stands,
        "unstable_roots": unstable_roots(**law.person),
        "critical_delay": None if math.isinf(critical) else critical,
        "rightmost_root": root,
    }


def _body_in_words(law: "Law") -> str:
    from standfast.mechanics.links import OneLink, TwoLinks

    links = law.links
    if isinstance(links, OneLink):
        return (
            f"one link, {links.mass:g} kg, {links.inertia:g} kg·m² about the ankle; knee and hip "
            f"are rigid; m g h = {links.load:g} N·m/rad"
        )
    if isinstance(links, TwoLinks):
        return (
            f"leg and trunk, {links.mass[0]:g} and {links.mass[1]:g} kg; the knee is rigid; "
            f"m g h = {law.load:.2f} N·m/rad"
        )
    return f"three links, {sum(links.segment_mass):g} kg; m g h = {law.load:.2f} N·m/rad"


def _is_matrix(value: Any) -> bool:
    return isinstance(value, tuple) and isinstance(value[0], tuple)


def _list(value: Any) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)


def _parts(root: complex) -> list[float]:
    return [complex(root).real, complex(root).imag]


def _root(root: complex) -> str:
    real, imaginary = _parts(root)
    return f"{real:.3f}" + (f" ± {imaginary:.3f}i" if abs(imaginary) >= 0.0005 else "")


def _verdict(stands: bool) -> str:
    return "stands" if stands else "falls"


def _ms(seconds: float) -> str:
    return f"{1000.0 * seconds:.4g}"


def _lost_at(critical: float | None) -> str:
    if critical is None or math.isinf(critical):
        return "no delay"
    return f"{_ms(critical)} ms" if critical > 0.0 else "any delay"
