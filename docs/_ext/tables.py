"""Directives that print the package's own tables, so that no page repeats them by hand.

``{parameter-table} SECTION`` are the parameters of a section of a study, ``{quantity-table} KIND``
the quantities of springs, feedback or sway, ``{row-table} NAME`` smaller tables.
"""

import math
from collections.abc import Callable, Iterable

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import standfast as sf
from standfast.anthropometry.body import BODY_SOURCES
from standfast.parameters import PARAMETERS, Parameter
from standfast.population.people.builtin import POPULATIONS, READY_DELAYS, SOURCES
from standfast.population.people.distributions import DISTRIBUTIONS
from standfast.quantities.of_feedback import OF_FEEDBACK
from standfast.quantities.of_springs import OF_SPRINGS
from standfast.quantities.of_sway import OF_SWAY
from standfast.quantities.row import Quantity

KINDS = {"springs": OF_SPRINGS, "feedback": OF_FEEDBACK, "sway": OF_SWAY}


def number(value: float) -> str:
    """Write a number as people do."""
    return f"{value:g}".replace("e+", "e")


def range_of(row: Parameter) -> str:
    """Write what a parameter may be."""
    if row.choices:
        return ", ".join(f"`{word}`" for word in row.choices)
    rigid = ", or `inf`" if row.or_rigid else ""
    return f"{number(row.lowest)} to {number(row.highest)}{rigid}"


def default_of(row: Parameter) -> str:
    """Write what holds where a study says nothing."""
    return f"`{row.default}`" if isinstance(row.default, str) else number(row.default or 0.0)


def unit_of(unit: str) -> str:
    """Leave the unit of pure numbers out."""
    return "" if unit == "1" else unit


def parameters(section: str) -> Iterable[tuple[str, ...]]:
    """List the parameters of a section of a study."""
    yield "key", "name", "symbol, unit", "range, default", "meaning"
    for row in PARAMETERS.values():
        if row.section == section:
            symbol = f"${row.symbol}$" if row.symbol else ""
            measured = ", ".join(filter(None, (symbol, unit_of(row.unit))))
            allowed = (
                f"{range_of(row)}; {default_of(row)}" if row.default is not None else range_of(row)
            )
            yield f"`{row.key}`", f"`{row.name}`", measured, allowed, row.meaning


def quantities(kind: str) -> Iterable[tuple[str, ...]]:
    """List the quantities of a kind."""
    yield "name", "symbol", "unit", "meaning"
    for row in KINDS[kind]:
        symbol = f"${row.symbol}$" if row.symbol else ""
        yield f"`{row.name}`", symbol, unit_of(row.unit), meaning_of(row)


def meaning_of(row: Quantity) -> str:
    """Write what a quantity means, and what its whole numbers mean."""
    flags = ", ".join(f"{number}: {flag}" for number, flag in enumerate(row.flags))
    limit = "" if row.limit is None else f"; at the limit of standing {number(row.limit)}"
    return row.meaning + limit + (f" ({flags})" if flags else "")


def distributions() -> Iterable[tuple[str, ...]]:
    """List the distributions of a population's study."""
    yield "distribution", "numbers"
    for name, numbers in DISTRIBUTIONS.items():
        yield f"`{name}`", ", ".join(f"`{key}`" for key in numbers) or "of each person's record"


def builtin() -> Iterable[tuple[str, ...]]:
    """List the built-in populations."""
    yield "name", "groups", "source"
    for name, groups in POPULATIONS.items():
        ages = sorted({one.age for one in groups})
        yield f"`{name}`", f"{', '.join(ages)}; of each sex", SOURCES[name]


def delays() -> Iterable[tuple[str, ...]]:
    """List the ready delays."""
    yield "name", "delay (s)", "source", "assumed"
    for name, ready in READY_DELAYS.items():
        given = ready.distribution
        spread = f" ± {given['sd']:g}" if "sd" in given else ""
        yield (
            f"`{name}`", f"{given.get('value', given.get('mean')):g}{spread}", ready.source,
            ready.rests_on if ready.assumed else "no",
        )  # fmt: skip


def body_models() -> Iterable[tuple[str, ...]]:
    """List the body models."""
    yield "name", "source"
    for name, source in BODY_SOURCES.items():
        yield f"`{name}`", source


def laws() -> Iterable[tuple[str, ...]]:
    """List the published laws of feedback."""
    yield "name", "delay (ms)", "critical delay (ms)", "what was seen", "source"
    for law in sf.LAWS.values():
        lost = 1000.0 * sf.critical_delay(**law.person)
        yield (
            f"`{law.name}`", number(1000.0 * law.delay),
            "never lost" if math.isinf(lost) else f"{lost:.0f}", law.confidence, law.source,
        )  # fmt: skip


OTHERS: dict[str, Callable[[], Iterable[tuple[str, ...]]]] = {
    "distributions": distributions,
    "built-in populations": builtin,
    "delays": delays,
    "body models": body_models,
    "laws": laws,
}


class Table(SphinxDirective):
    """A table of the package, in Markdown of the page."""

    required_arguments = 1
    final_argument_whitespace = True

    def rows(self) -> Iterable[tuple[str, ...]]:
        """Return the head and the rows."""
        return OTHERS[self.arguments[0]]()

    def run(self) -> list[nodes.Node]:
        """Print the table."""
        head, *rows = self.rows()
        lines = [head, ("---",) * len(head), *rows]
        cells = [[cell.replace("|", r"\|") for cell in row] for row in lines]
        printed = self.parse_text_to_nodes("\n".join(f"| {' | '.join(row)} |" for row in cells))
        for table in printed:
            table["classes"].append("described")  # by its last column, as the style knows
        return printed


class ParameterTable(Table):
    """The parameters of a section."""

    def rows(self) -> Iterable[tuple[str, ...]]:
        """Return the head and the rows."""
        section = self.arguments[0]
        return parameters("" if section == "top" else section)


class QuantityTable(Table):
    """The quantities of a kind."""

    def rows(self) -> Iterable[tuple[str, ...]]:
        """Return the head and the rows."""
        return quantities(self.arguments[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    app.add_directive("row-table", Table)
    app.add_directive("parameter-table", ParameterTable)
    app.add_directive("quantity-table", QuantityTable)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
