"""Recorded formulas as text of JavaScript: straight lines of constants, quick in any engine.

A number that is used once stands where it is used, so that what a choice does not take is not
computed; all others get a name. Comments say which function of the package a line is from.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence

from standfast.explore.symbols import Symbol

# How tightly an operation binds, and its sign, of those that stand between two arguments.
BETWEEN = {
    "or": (2, "||"),
    "and": (3, "&&"),
    "==": (4, "==="),
    "!=": (4, "!=="),
    "<": (5, "<"),
    "<=": (5, "<="),
    ">": (5, ">"),
    ">=": (5, ">="),
    "+": (6, "+"),
    "-": (6, "-"),
    "*": (7, "*"),
    "/": (7, "/"),
}
CHOICE, PREFIX, ATOM = 1, 8, 9
CALLS = {
    "abs": "Math.abs",
    "sqrt": "Math.sqrt",
    "ceil": "Math.ceil",
    "cos": "Math.cos",
    "sin": "Math.sin",
    "arctan2": "Math.atan2",
    "minimum": "Math.min",
    "maximum": "Math.max",
    "isnan": "Number.isNaN",
    "isfinite": "Number.isFinite",
    "isinf": "isInfinite",
    "hypot": "hypotenuse",
    "copysign": "copySign",
    "masked": "masked",
}
LONGEST = 88  # of an expression without a name

# What JavaScript has not, or not as exactly: the root of a sum of two squares is Borges' corrected
# one (arXiv 1904.09481), which the C library has too. Low bits are taken off by subtraction: each
# counts what the last bit does, by sign and exponent. To write half of a number's bits and read all
# of them makes a processor wait until both halves are in memory, a quarter of a map of frequencies.
HELPERS = """\
const doubles = new Float64Array(1);
const words = new Int32Array(doubles.buffer);
const lastBits = Float64Array.from({ length: 4096 }, (_, top) => {
  const exponent = top % 2048;
  const size = exponent === 2047 ? 0 : 2 ** (Math.max(exponent, 1) - 1075);
  return top < 2048 ? size : -size;
});

function masked(x, low) {
  doubles[0] = x;
  return x + (0 - (words[0] & ~low)) * lastBits[words[1] >>> 20];
}

function isInfinite(x) {
  return x === Infinity || x === -Infinity;
}

function copySign(size, sign) {
  return sign < 0 || (sign === 0 && 1 / sign < 0) ? -Math.abs(size) : Math.abs(size);
}

function hypotenuse(a, b) {
  const x = Math.max(Math.abs(a), Math.abs(b));
  const y = Math.min(Math.abs(a), Math.abs(b));
  if (isInfinite(a) || isInfinite(b)) return Infinity;
  if (y <= x * 1.1102230246251565e-16) return x + y;
  if (x > 1e150) return hypotenuse(x * 1e-160, y * 1e-160) * 1e160;
  if (y < 1e-150) return hypotenuse(x * 1e160, y * 1e160) * 1e-160;
  const h = Math.sqrt(x * x + y * y);
  let correction;
  if (h <= 2 * y) {
    const rest = h - y;
    correction = x * (2 * rest - x) + (rest - 2 * (x - y)) * rest;
  } else {
    const rest = h - x;
    correction = 2 * rest * (x - 2 * y) + (4 * rest - y) * y + rest * rest;
  }
  return h - correction / (2 * h);
}
"""


def literal(value: float | bool) -> str:
    """Return a number or truth value as JavaScript writes it, to the bit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if math.isinf(value):
        return "Infinity" if value > 0.0 else "-Infinity"
    return "NaN" if math.isnan(value) else repr(value).removesuffix(".0")


def needed(roots: Iterable[Symbol], known: Mapping[Symbol, str]) -> list[Symbol]:
    """Return the symbols that some hang on, in order, without those that are known."""
    found: dict[int, Symbol] = {}
    waiting = [root for root in roots if root not in known]
    while waiting:
        symbol = waiting.pop()
        if symbol.number not in found:
            found[symbol.number] = symbol
            waiting += [arg for arg in symbol.args if arg not in known]
    return [found[number] for number in sorted(found)]


def apart(roots: Sequence[Symbol], depends: int) -> list[Symbol]:
    """Return what can be computed before some slots are known, and is used after."""
    before: dict[Symbol, None] = {}
    for symbol in needed(roots, {}):
        if symbol.depends & depends:
            fixed = (arg for arg in symbol.args if not arg.depends & depends)
            before.update(dict.fromkeys(arg for arg in fixed if arg.op != "constant"))
    before.update(dict.fromkeys(root for root in roots if not root.depends & depends))
    return list(before)


class Lines:
    """The lines of one function: constants, each before its first use."""

    def __init__(self, read: Callable[[str], str], indent: int = 2) -> None:
        self.read, self.indent = read, indent
        self.lines: list[str] = []
        self.known: dict[Symbol, str] = {}
        self._source = ""

    def compute(self, roots: Sequence[Symbol], *, named: bool = False) -> list[str]:
        """Write what some symbols need, and return their texts; with names if they are to last."""
        order = needed(roots, self.known)
        uses: dict[Symbol, int] = {}
        for user in (*(arg for symbol in order for arg in symbol.args), *roots):
            uses[user] = uses.get(user, 0) + 1
        lasting = set(roots) if named else set()
        texts: dict[Symbol, tuple[str, int]] = {}
        for symbol in order:
            text, binding = self._text(symbol, texts)
            plain = symbol.op == "constant"
            if not plain and (uses[symbol] > 1 or len(text) > LONGEST or symbol in lasting):
                name = symbol.name or f"n{symbol.number}"
                if text != name:
                    self._say(symbol.source)
                    self.write(f"const {name} = {text};")
                self.known[symbol] = name
                text, binding = name, ATOM
            texts[symbol] = text, binding
        return [self.known[root] if root in self.known else texts[root][0] for root in roots]

    def write(self, line: str) -> None:
        """Write a line."""
        self.lines.append(" " * self.indent + line)

    def _say(self, source: str) -> None:
        if source and source != self._source:
            self.write(f"// {source}")
        self._source = source or self._source

    def _text(self, symbol: Symbol, texts: Mapping[Symbol, tuple[str, int]]) -> tuple[str, int]:
        if symbol.op == "slot":
            return self.read(symbol.name), ATOM
        if symbol.op == "constant":
            text = literal(symbol.value.item())
            return text, PREFIX if text.startswith("-") else ATOM

        def within(arg: Symbol, least: int) -> str:
            text, binding = (self.known[arg], ATOM) if arg in self.known else texts[arg]
            return text if binding >= least else f"({text})"

        args = symbol.args
        if symbol.op in BETWEEN:
            binding, sign = BETWEEN[symbol.op]
            # what stands on the right of an operation is computed first, so it keeps its brackets
            return f"{within(args[0], binding)} {sign} {within(args[1], binding + 1)}", binding
        if symbol.op == "where":
            condition, x, y = within(args[0], 2), within(args[1], 2), within(args[2], CHOICE)
            return f"{condition} ? {x} : {y}", CHOICE
        if symbol.op in ("minus", "not"):
            return f"{'-' if symbol.op == 'minus' else '!'}{within(args[0], ATOM)}", PREFIX
        return f"{CALLS[symbol.op]}({', '.join(within(arg, CHOICE) for arg in args)})", ATOM
