"""The formulas of the page: our functions of a person, printed as JavaScript.

Nothing is typed again: each function of the table of quantities is called once on symbols, without
and with couplings, and what it computed is printed as three kinds of functions:

- ``point(p, body)``, one person's value;
- ``along_…(p, body, xs, out, start, step)``, a row of a plane along one stiffness: what hangs on
  it alone stands in the loop;
- what several quantities share (the modes), once, into an array.

The body's eleven numbers are computed before, at each place of a plane where an axis changes them.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from standfast.anthropometry.body import Body, ReferencePerson, body_of
from standfast.explore.javascript import HELPERS, Lines, apart, needed
from standfast.explore.symbols import Record, Symbol, SymbolArray
from standfast.mechanics.feedback import delay_of
from standfast.parameters import COUPLINGS, OWN_BODY, PARAMETERS, SEGMENT_NUMBERS, STIFFNESSES
from standfast.quantities import QUANTITIES, Person, Quantity
from standfast.quantities.of_feedback import joint_of
from standfast.quantities.of_springs import modes_of
from standfast.stability.delay import one_joint

# Rows along an axis are worth their text up to this many operations.
MOST_IN_ROWS = 900

_NUMBERS = [row.name for row in PARAMETERS.values() if not row.choices and row.name not in OWN_BODY]
REFERENCE = [f"reference_{name}" for name in (*OWN_BODY, "height", "mass")]
SLOTS = {name: place for place, name in enumerate([*_NUMBERS, "by_bmi", *REFERENCE])}

PLANES = """\
const own = new Float64Array(BODY_NUMBERS);
const found = new Float64Array(FOUND_NUMBERS);

function isCoupled(p) {
  for (const slot of couplings) if (p[slot] !== 0) return true;
  return false;
}

function fillRows(way, row, alongX, p, outer, values, inner, out) {
  for (let k = 0; k < values.length; k++) {
    p[outer] = values[k];
    bodyInto(p, own);
    const [start, step] = alongX ? [k * inner.length, 1] : [k, values.length];
    row(p, own, inner, out, start, step, way.point, way.pick);
  }
}

function fillPoints(point, p, xSlot, xs, ySlot, ys, out) {
  // the body's numbers are computed as seldom as can be
  const swap = ofBody.has(xSlot) && !ofBody.has(ySlot);
  const [outer, values, outerStep] = swap ? [xSlot, xs, 1] : [ySlot, ys, xs.length];
  const [inner, others, innerStep] = swap ? [ySlot, ys, xs.length] : [xSlot, xs, 1];
  for (let k = 0; k < values.length; k++) {
    p[outer] = values[k];
    bodyInto(p, own);
    for (let i = 0; i < others.length; i++) {
      p[inner] = others[i];
      if (ofBody.has(inner)) bodyInto(p, own);
      out[k * outerStep + i * innerStep] = point(p, own);
    }
  }
}

function quantity(uncoupled, coupled) {
  return {
    at(p) {
      bodyInto(p, own);
      return (isCoupled(p) ? coupled : uncoupled).point(p, own);
    },
    plane(p, xSlot, xs, ySlot, ys, out) {
      const coupling = couplings.has(xSlot) || couplings.has(ySlot) || isCoupled(p);
      const way = coupling ? coupled : uncoupled;
      const q = p.slice();
      const [slot, row] = way.rows.find(([slot]) => slot === xSlot || slot === ySlot) ?? [];
      if (slot === undefined) fillPoints(way.point, q, xSlot, xs, ySlot, ys, out);
      else if (slot === xSlot) fillRows(way, row, true, q, ySlot, ys, xs, out);
      else fillRows(way, row, false, q, xSlot, xs, ys, out);
    },
  };
}
"""


class Fast(NamedTuple):
    """A fast way that quantities share: what it finds, where it is uncertain, its rows' name."""

    name: str
    found: list[Symbol]
    uncertain: Symbol


class Way(NamedTuple):
    """How one quantity is found: its value, and what it takes of a fast way."""

    name: str
    value: Symbol
    shared: str = ""  # the call that value asks of first
    fast: Fast | None = None
    pick: Symbol | None = None


def formulas_module() -> str:
    """Return the page's module of formulas, ``formulas.js``."""
    record = Record()
    parts = [f"export const slots = {_object({n: str(k) for n, k in SLOTS.items()})};"]
    parts += [f"export const slotCount = {len(SLOTS)};", HELPERS, _body(record)]
    parts.append(f"const couplings = new Set([{', '.join(str(SLOTS[n]) for n in COUPLINGS)}]);")
    parts.append(PLANES.replace("BODY_NUMBERS", str(len(OWN_BODY))).replace("FOUND_NUMBERS", "12"))
    entries: dict[str, list[str]] = {}
    for coupled in (False, True):
        person = _person(record, coupled=coupled)
        kind = "coupled" if coupled else "uncoupled"
        shared, ways = _ways(record, person, kind)
        parts += shared
        inner = (*STIFFNESSES, *COUPLINGS) if coupled else STIFFNESSES
        for way in ways:
            parts += _printed(way, kind, inner)
            entries.setdefault(way.name, []).append(_entry(way, kind, inner))
    parts.append(f"export const springs = {_quantities(entries)};")
    person = _person(record, coupled=False)
    ways = [*_of_one_joint(record, person)]
    for way in ways:
        parts += _printed(way, "one_joint", ())
    alone = {way.name: [_entry(way, "one_joint", ())] * 2 for way in ways}
    parts.append(f"export const oneJoint = {_quantities(alone)};")
    parts.append(_at_once(record))
    return "\n".join(parts)


def _read(slot: str) -> str:
    """Return where a slot's number stands."""
    if slot in SLOTS:
        return f"p[{SLOTS[slot]}]"
    return f"body[{OWN_BODY.index(slot)}]" if slot in OWN_BODY else slot


def _person(record: Record, *, coupled: bool) -> Person:
    """Return a person of slots, as the functions of the table take one."""
    given: dict[str, Any] = {name: record.slot(name) for name in (*_NUMBERS, *OWN_BODY)}
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
        _flat(body_of({"body_model": model, "height": height, name: record.slot(name)}))
        for name in ("mass", "bmi")
    )
    weighed = record.slot("by_bmi") == 0.0
    chosen = [record.where(weighed, *both) for both in zip(by_mass, by_bmi, strict=True)]
    places = [SLOTS[s.name] for s in needed(chosen, {}) if s.op == "slot"]
    lines = Lines(_read)
    for place, text in enumerate(lines.compute(chosen)):
        lines.write(f"body[{place}] = {text};")
    return (
        f"// The slots on which the body hangs.\nconst ofBody = new Set({places});\n\n"
        + _function("bodyInto", "p, body", lines.lines)
    )


def _ways(record: Record, person: Person, kind: str) -> tuple[list[str], list[Way]]:
    """Return the ways of all quantities of springs, and the functions that they share."""
    functions: list[str] = []
    found: dict[Any, tuple[Any, str]] = {}
    fast: dict[Any, tuple[Any, Fast]] = {}
    ways = []
    for row in _of_springs():
        find, quick = row.reference, row.fast
        if find is None:
            continue
        if find not in found:
            result = find(person)
            if isinstance(result, Symbol):
                found[find] = result, ""
            else:
                name = f"{type(result).__name__.lower()}_{kind}"
                functions.append(_shared(name, result))
                found[find] = _again(record, result), f"{name}(p, body, found);"
        result, call = found[find]
        way = Way(row.name, _number(record, row.pick(person, result)), call)
        if quick is not None and kind == "uncoupled":
            if quick not in fast:
                result, uncertain = quick(person)
                fast[quick] = _again(record, result), Fast(row.name, _flat(result), uncertain)
                functions += [_fast_row(fast[quick][1], slot) for slot in STIFFNESSES]
            result, way_of_rows = fast[quick]
            way = way._replace(
                fast=way_of_rows, pick=_number(record, row.pick(person, result))
            )
        ways.append(way)
    return functions, ways


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


def _flat(found: Any) -> list[Symbol]:
    """Return the symbols of what a function found, in order."""
    if isinstance(found, Symbol):
        return [found]
    return [symbol for part in found for symbol in _flat(part)]


def _again(record: Record, found: Any) -> Any:
    """Return what a function found, of numbers that lie in an array."""
    places = iter(range(len(_flat(found))))

    def given(part: Any) -> Any:
        if isinstance(part, Symbol):
            return record.slot(f"found[{next(places)}]")
        if isinstance(part, SymbolArray):
            return record.stack([given(each) for each in part])
        parts = [given(each) for each in part]
        return part._make(parts) if hasattr(part, "_make") else tuple(parts)

    return given(found)


def _shared(name: str, result: Any) -> str:
    lines = Lines(_read)
    for place, text in enumerate(lines.compute(_flat(result))):
        lines.write(f"found[{place}] = {text};")
    return _function(name, "p, body, found", lines.lines)


def _printed(way: Way, kind: str, inner: Sequence[str]) -> Iterator[str]:
    """Print a quantity's point, and its rows along those stiffnesses that are worth it."""
    lines = Lines(_read)
    if way.shared:
        lines.write(way.shared)
    (text,) = lines.compute([way.value])
    lines.write(f"return {text};")
    yield _function(f"{way.name}_{kind}", "p, body", lines.lines)
    if way.pick is not None:
        lines = Lines(_read)
        (text,) = lines.compute([way.pick])
        lines.write(f"return {text};")
        yield _function(f"{way.name}_of_fast", "p", lines.lines)
    else:
        yield from (_row(way, kind, slot) for slot in _rows(way.value, inner, way.shared))


def _rows(value: Symbol, inner: Sequence[str], shared: str = "") -> list[str]:
    """Return the slots along which rows are printed, the cheapest first."""
    order = needed([value], {})
    if shared or len(order) > MOST_IN_ROWS:
        return []
    bits = {slot: value.record.slot(slot).depends for slot in inner}
    return sorted(inner, key=lambda slot: sum(1 for s in order if s.depends & bits[slot]))


def _loop(roots: Sequence[Symbol], slot: str) -> tuple[Lines, list[str]]:
    """Begin a row of a plane along a slot: what does not hang on it stands before the loop."""
    varying = roots[0].record.slot(slot)
    lines = Lines(_read)
    lines.compute(apart(roots, varying.depends), named=True)
    lines.write("for (let i = 0; i < xs.length; i++) {")
    lines.indent += 2
    lines.write(f"const {slot} = xs[i];")
    lines.known[varying] = slot
    return lines, lines.compute(roots)


def _row(way: Way, kind: str, slot: str) -> str:
    """Print a row of a plane along a slot."""
    lines, (text,) = _loop([way.value], slot)
    lines.write(f"out[start + i * step] = {text};")
    name = f"{way.name}_{kind}_along_{slot}"
    return _function(name, "p, body, xs, out, start, step", [*lines.lines, "  }"])


def _fast_row(fast: Fast, slot: str) -> str:
    """Print a row of a fast way: a quantity picks its number, or is asked as at one point."""
    lines, (uncertain, *texts) = _loop([fast.uncertain, *fast.found], slot)
    lines.write(f"if ({uncertain}) {{")
    lines.write(f"  p[{SLOTS[slot]}] = {slot};")
    lines.write("  out[start + i * step] = point(p, body);")
    lines.write("  continue;")
    lines.write("}")
    for place, text in enumerate(texts):
        lines.write(f"found[{place}] = {text};")
    lines.write("out[start + i * step] = pick(p);")
    arguments = "p, body, xs, out, start, step, point, pick"
    return _function(f"fast_{fast.name}_along_{slot}", arguments, [*lines.lines, "  }"])


def _entry(way: Way, kind: str, inner: Sequence[str]) -> str:
    name = f"{way.name}_{kind}"
    if way.fast is None:
        along = {slot: f"{name}_along_{slot}" for slot in _rows(way.value, inner, way.shared)}
        pick = ""
    else:
        along = {slot: f"fast_{way.fast.name}_along_{slot}" for slot in _rows(way.fast.uncertain, inner)}
        pick = f", pick: {way.name}_of_fast"
    rows = ", ".join(f"[{SLOTS[slot]}, {name}]" for slot, name in along.items())
    return f"{{ point: {name}, rows: [{rows}]{pick} }}"


def _quantities(entries: Mapping[str, Sequence[str]]) -> str:
    """Print the quantities by name, each of its uncoupled and its coupled functions."""
    of = {name: f"quantity({', '.join(both)})" for name, both in entries.items()}
    return _object(of)


def _at_once(record: Record) -> str:
    """Print the body's numbers and the modes of one person, as the page asks for them."""
    found = modes_of(_person(record, coupled=False))
    again = _again(record, found)
    order = [s.name for s in _flat((again.eigenvalues, again.shapes.T))]
    at_body = ["const body = new Float64Array(own.length);", "bodyInto(p, body);", "return body;"]
    at_modes = [
        "bodyInto(p, own);",
        "(isCoupled(p) ? modes_coupled : modes_uncoupled)(p, own, found);",
        f"return Float64Array.of({', '.join(order)});",
    ]
    functions = (("bodyAt", at_body), ("modesAt", at_modes))
    return "\n".join(
        f"export {_function(name, 'p', [f'  {line}' for line in lines])}"
        for name, lines in functions
    )


def _function(name: str, arguments: str, lines: Sequence[str]) -> str:
    return "\n".join([f"function {name}({arguments}) {{", *lines, "}\n"])


def _object(entries: Mapping[str, str]) -> str:
    return "{\n" + "".join(f"  {name}: {text},\n" for name, text in entries.items()) + "}"
