"""The functions of the page's formulas as text: points, rows of planes, and what fills planes.

- ``point(p, body)`` is one person's value;
- ``along_…(p, body, xs, out, start, step)`` a row of a plane along one stiffness: what hangs on it
  stands in the loop, all else before. What quantities share, as a fast way, is there once for all
  of them: ``pick`` takes a quantity's number, and where it is uncertain ``point`` is asked.
- what several quantities share (the modes) is computed into ``found``.

Beside points, rows make a plane of the verdict ten times as fast, one of the safety factor up to
twice; and ten times one of frequencies, which rows of a fast way find, or of ratios of rotations,
which need a third of what modes take.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from standfast.explore.javascript import Lines, apart, needed
from standfast.explore.symbols import Symbol
from standfast.parameters import OWN_BODY, PARAMETERS

# Rows along an axis are worth their text up to this many operations.
MOST_IN_ROWS = 900

NUMBERS = [row.name for row in PARAMETERS.values() if not row.choices and row.name not in OWN_BODY]
REFERENCE = [f"reference_{name}" for name in (*OWN_BODY, "height", "mass")]
SLOTS = {name: place for place, name in enumerate([*NUMBERS, "by_bmi", *REFERENCE])}

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

// A row of one point finds it sooner than what is asked of one person.
function quickPoint({ point, rows, pick }) {
  if (!pick) return point;
  const [slot, row] = rows[0];
  const [at, out] = [new Float64Array(1), new Float64Array(1)];
  return (p, body) => {
    at[0] = p[slot];
    row(p, body, at, out, 0, 1, point, pick);
    return out[0];
  };
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
      if (slot === undefined) fillPoints(quickPoint(way), q, xSlot, xs, ySlot, ys, out);
      else if (slot === xSlot) fillRows(way, row, true, q, ySlot, ys, xs, out);
      else fillRows(way, row, false, q, xSlot, xs, ys, out);
    },
  };
}
"""


class Rows(NamedTuple):
    """Rows that quantities share: their name, what they find, and where a fast way is uncertain."""

    name: str
    found: list[Symbol]
    uncertain: Symbol | None = None


class Way(NamedTuple):
    """How one quantity is found: its value, and what it takes of the rows that it shares."""

    name: str
    value: Symbol
    shared: str = ""  # the call that value asks of first
    rows: Rows | None = None
    pick: Symbol | None = None


def read(slot: str) -> str:
    """Return where a slot's number stands."""
    if slot in SLOTS:
        return f"p[{SLOTS[slot]}]"
    return f"body[{OWN_BODY.index(slot)}]" if slot in OWN_BODY else slot


def flat(found: Any) -> list[Symbol]:
    """Return the symbols of what a function found, in order."""
    if isinstance(found, Symbol):
        return [found]
    return [symbol for part in found for symbol in flat(part)]


def shared_function(name: str, result: Any) -> str:
    """Print a function that computes what several quantities share into an array."""
    lines = Lines(read)
    for place, text in enumerate(lines.compute(flat(result))):
        lines.write(f"found[{place}] = {text};")
    return function(name, "p, body, found", lines.lines)


def functions_of(way: Way, kind: str, inner: Sequence[str]) -> Iterator[str]:
    """Print a quantity's point, and its rows along those stiffnesses that are worth it."""
    lines = Lines(read)
    if way.shared:
        lines.write(way.shared)
    (text,) = lines.compute([way.value])
    lines.write(f"return {text};")
    yield function(f"{way.name}_{kind}", "p, body", lines.lines)
    if way.pick is not None:
        lines = Lines(read)
        (text,) = lines.compute([way.pick])
        lines.write(f"return {text};")
        yield function(f"{way.name}_of_rows", "p", lines.lines)
    else:
        yield from (_row(way, kind, slot) for slot in _along([way.value], inner, way.shared))


def worth_rows(values: Sequence[Symbol]) -> bool:
    """Return whether values take few enough operations for rows of their own."""
    return len(needed(values, {})) <= MOST_IN_ROWS


def _along(values: Sequence[Symbol], inner: Sequence[str], shared: str = "") -> list[str]:
    """Return the slots along which rows are printed, the cheapest first."""
    if shared or not worth_rows(values):
        return []
    order = needed(values, {})
    bits = {slot: values[0].record.slot(slot).depends for slot in inner}
    return sorted(inner, key=lambda slot: sum(1 for s in order if s.depends & bits[slot]))


def _loop(roots: Sequence[Symbol], slot: str) -> tuple[Lines, list[str]]:
    """Begin a row of a plane along a slot: what does not hang on it stands before the loop."""
    varying = roots[0].record.slot(slot)
    lines = Lines(read)
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
    return function(name, "p, body, xs, out, start, step", [*lines.lines, "  }"])


def shared_row(rows: Rows, slot: str) -> str:
    """Print a row that quantities share: each picks its number, or is asked as at one point."""
    doubt = [] if rows.uncertain is None else [rows.uncertain]
    lines, texts = _loop([*rows.found, *doubt], slot)
    if doubt:
        lines.write(f"if ({texts.pop()}) {{")
        lines.write(f"  p[{SLOTS[slot]}] = {slot};")
        lines.write("  out[start + i * step] = point(p, body);")
        lines.write("  continue;")
        lines.write("}")
    for place, text in enumerate(texts):
        lines.write(f"found[{place}] = {text};")
    lines.write("out[start + i * step] = pick(p);")
    arguments = "p, body, xs, out, start, step, point, pick"
    return function(f"rows_of_{rows.name}_along_{slot}", arguments, [*lines.lines, "  }"])


def entry_of(way: Way, kind: str, inner: Sequence[str]) -> str:
    """Print which functions a quantity has: its point, and rows by their slots."""
    name = f"{way.name}_{kind}"
    if way.rows is None:
        along = {slot: f"{name}_along_{slot}" for slot in _along([way.value], inner, way.shared)}
        pick = ""
    else:
        _, found, uncertain = way.rows
        slots = _along([*found, *([] if uncertain is None else [uncertain])], inner)
        along = {slot: f"rows_of_{way.rows.name}_along_{slot}" for slot in slots}
        pick = f", pick: {way.name}_of_rows"
    rows = ", ".join(f"[{SLOTS[slot]}, {name}]" for slot, name in along.items())
    return f"{{ point: {name}, rows: [{rows}]{pick} }}"


def function(name: str, arguments: str, lines: Sequence[str]) -> str:
    """Print a function of some lines."""
    return "\n".join([f"function {name}({arguments}) {{", *lines, "}\n"])


def object_of(entries: Mapping[str, str]) -> str:
    """Print an object of texts by name."""
    return "{\n" + "".join(f"  {name}: {text},\n" for name, text in entries.items()) + "}"
