"""The formulas of the page: our functions of a person, printed as JavaScript.

Nothing is typed again: each function of the table of quantities is called once on symbols, without
and with couplings, and what it computed is printed by :mod:`.printing`.

The body's eleven numbers are computed before, at each place of a plane where an axis changes them.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from standfast.anthropometry.body import Body, ReferencePerson, body_of
from standfast.explore.javascript import HELPERS, Lines, needed
from standfast.explore.printing import (
    NUMBERS,
    PLANES,
    SLOTS,
    Rows,
    Way,
    entry_of,
    flat,
    function,
    functions_of,
    object_of,
    read,
    shared_function,
    shared_row,
    worth_rows,
)
from standfast.explore.recording import Record
from standfast.explore.symbols import Symbol, SymbolArray
from standfast.mechanics.feedback import delay_of
from standfast.parameters import COUPLINGS, OWN_BODY, SEGMENT_NUMBERS, STIFFNESSES
from standfast.quantities import QUANTITIES, Person, Quantity
from standfast.quantities.of_feedback import joint_of
from standfast.quantities.of_springs import modes_of
from standfast.stability.delay import one_joint


def formulas_module() -> str:
    """Return the page's module of formulas, ``formulas.js``."""
    record = Record()
    parts = [f"export const slots = {object_of({n: str(k) for n, k in SLOTS.items()})};"]
    parts += [f"export const slotCount = {len(SLOTS)};", HELPERS, _body(record)]
    parts.append(f"const couplings = new Set([{', '.join(str(SLOTS[n]) for n in COUPLINGS)}]);")
    place, size = len(parts), 0
    entries: dict[str, list[str]] = {}
    for coupled in (False, True):
        person = _person(record, coupled=coupled)
        kind = "coupled" if coupled else "uncoupled"
        shared, ways, found_numbers = _ways(record, person, kind)
        parts += shared
        size = max(size, found_numbers)
        inner = (*STIFFNESSES, *COUPLINGS) if coupled else STIFFNESSES
        for way in ways:
            parts += functions_of(way, kind, inner)
            entries.setdefault(way.name, []).append(entry_of(way, kind, inner))
    numbers = {"BODY_NUMBERS": len(OWN_BODY), "FOUND_NUMBERS": size}
    parts.insert(place, re.sub("|".join(numbers), lambda word: str(numbers[word[0]]), PLANES))
    parts.append(f"export const springs = {_quantities(entries)};")
    person = _person(record, coupled=False)
    ways = [*_of_one_joint(record, person)]
    for way in ways:
        parts += functions_of(way, "one_joint", ())
    alone = {way.name: [entry_of(way, "one_joint", ())] * 2 for way in ways}
    parts.append(f"export const oneJoint = {_quantities(alone)};")
    parts.append(_at_once(record))
    return "\n".join(parts)


def _person(record: Record, *, coupled: bool) -> Person:
    """Return a person of slots, as the functions of the table take one."""
    given: dict[str, Any] = {name: record.slot(name) for name in (*NUMBERS, *OWN_BODY)}
    if not coupled:
        given |= dict.fromkeys(COUPLINGS, 0.0)
    return Person.of(given)


def _body(record: Record) -> str:
    """Print the body's numbers: of body mass, or of BMI."""
    reference = {name: record.slot(f"reference_{name}") for name in (*OWN_BODY, "height", "mass")}
    body = Body._make(
        record.stack([reference[name] for name in names]) for names in SEGMENT_NUMBERS.values()
    )
    model = ReferencePerson(body, height=reference["height"], mass=reference["mass"])
    height = record.slot("height")
    by_mass, by_bmi = (
        flat(body_of({"body_model": model, "height": height, name: record.slot(name)}))
        for name in ("mass", "bmi")
    )
    weighed = record.slot("by_bmi") == 0.0
    chosen = [record.where(weighed, *both) for both in zip(by_mass, by_bmi, strict=True)]
    places = [SLOTS[s.name] for s in needed(chosen, {}) if s.op == "slot"]
    lines = Lines(read)
    for place, text in enumerate(lines.compute(chosen)):
        lines.write(f"body[{place}] = {text};")
    return (
        f"// The slots on which the body hangs.\nconst ofBody = new Set({places});\n\n"
        + function("bodyInto", "p, body", lines.lines)
    )


def _ways(record: Record, person: Person, kind: str) -> tuple[list[str], list[Way], int]:
    """Return the functions that quantities of springs share, the ways of all, and a size.

    That is how many numbers a shared function finds at most.
    """
    functions: list[str] = []
    found: dict[Any, tuple[Any, Any, str]] = {}
    fast: dict[Any, tuple[Any, Rows]] = {}
    ways: list[Way] = []
    parts: dict[Any, dict[int, Symbol]] = {}
    for row in _of_springs():
        find, quick = row.reference, row.fast
        if find is None:
            continue
        if find not in found:
            result = find(person)
            if isinstance(result, Symbol):
                found[find] = result, result, ""
            else:
                name = f"{type(result).__name__.lower()}_{kind}"
                functions.append(shared_function(name, result))
                found[find] = result, _again(record, result), f"{name}(p, body, found);"
        whole, result, call = found[find]
        way = Way(row.name, _number(record, row.pick(person, result)), call)
        if quick is not None and kind == "uncoupled":
            if quick not in fast:
                result, uncertain = quick(person)
                fast[quick] = _again(record, result), Rows(row.name, flat(result), uncertain)
                functions += [shared_row(fast[quick][1], slot) for slot in STIFFNESSES]
            result, rows = fast[quick]
            way = way._replace(rows=rows, pick=_number(record, row.pick(person, result)))
        elif call and kind == "uncoupled":
            parts.setdefault(find, {})[len(ways)] = _number(record, row.pick(person, whole))
        ways.append(way)
    for values in parts.values():
        functions += _rows_of_parts(record, ways, values)
    size = max(len(flat(each)) for each, *_ in [*found.values(), *fast.values()])
    return functions, ways, size


def _rows_of_parts(record: Record, ways: list[Way], values: Mapping[int, Symbol]) -> list[str]:
    """Return rows of quantities that need but a part of what they share, and give them to these.

    ``values`` has them by their places among the ways.
    """
    if not worth_rows([*values.values()]):
        return []
    rows = Rows(ways[min(values)].name, [*values.values()])
    for number, place in enumerate(values):
        pick = record.slot(f"found[{number}]")
        ways[place] = ways[place]._replace(rows=rows, pick=pick)
    return [shared_row(rows, slot) for slot in STIFFNESSES]


def _of_springs() -> Iterator[Quantity]:
    return (row for row in QUANTITIES.values() if row.reference is not None and not row.own)


def _of_one_joint(record: Record, person: Person) -> Iterator[Way]:
    """Return the ways of what feedback of the one free joint decides."""
    stands = one_joint.stands(joint_of(person), delay_of(person.given))
    yield Way("stable", _number(record, stands))
    for row in QUANTITIES.values():
        if row.of_one_joint is not None and not row.own:
            yield Way(row.name, _number(record, row.of_one_joint(person)))


def _number(record: Record, value: Any) -> Symbol:
    return record.where(value, 1.0, 0.0) if value.dtype == bool else record.asarray(value)


def _again(record: Record, found: Any) -> Any:
    """Return what a function found, of numbers that lie in an array."""
    places = iter(range(len(flat(found))))

    def given(part: Any) -> Any:
        if isinstance(part, Symbol):
            return record.slot(f"found[{next(places)}]")
        if isinstance(part, SymbolArray):
            return record.stack([given(each) for each in part])
        parts = [given(each) for each in part]
        return part._make(parts) if hasattr(part, "_make") else tuple(parts)

    return given(found)


def _quantities(entries: Mapping[str, Sequence[str]]) -> str:
    """Print the quantities by name, each of its uncoupled and its coupled functions."""
    of = {name: f"quantity({', '.join(both)})" for name, both in entries.items()}
    return object_of(of)


def _at_once(record: Record) -> str:
    """Print the body's numbers and the modes of one person, as the page asks for them."""
    found = modes_of(_person(record, coupled=False))
    again = _again(record, found)
    order = [s.name for s in flat((again.eigenvalues, again.shapes.T))]
    at_body = ["const body = new Float64Array(own.length);", "bodyInto(p, body);", "return body;"]
    at_modes = [
        "bodyInto(p, own);",
        "(isCoupled(p) ? modes_coupled : modes_uncoupled)(p, own, found);",
        f"return Float64Array.of({', '.join(order)});",
    ]
    functions = (("bodyAt", at_body), ("modesAt", at_modes))
    return "\n".join(
        f"export {function(name, 'p', [f'  {line}' for line in lines])}"
        for name, lines in functions
    )
