"""Numbers that write down what is computed with them, so that a formula can be printed elsewhere.

A formula of the package asks its arguments which library they belong to. Symbols belong to a
:class:`Record`: the same lines that compute with NumPy or JAX then leave a list of operations, each
once however often it is written (hash-consing). Whatever is known is computed at once in NumPy's
float64, and nothing is rearranged: the operations give the same bits as NumPy's on arrays.

Left out are only operations that change no bit of any number: times or over 1, and less 0.
"""

import struct
import sys
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from standfast.explore.symbols import NUMBER, TRUTH, Symbol, SymbolArray
from standfast.numerics import arrays

# By the sign that names it: what a constant is folded with.
ON_NUMBERS: dict[str, Callable[..., Any]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "minus": np.negative,
    "abs": np.absolute,
    "sqrt": np.sqrt,
    "ceil": np.ceil,
    "cos": np.cos,
    "sin": np.sin,
    "arctan2": np.arctan2,
    "hypot": np.hypot,
    "copysign": np.copysign,
    "minimum": np.minimum,
    "maximum": np.maximum,
    "masked": lambda x, mask: (x.view(np.int64) & np.int64(mask)).view(np.float64),
}
TO_TRUTH: dict[str, Callable[..., Any]] = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
    "isinf": np.isinf,
    "isnan": np.isnan,
    "isfinite": np.isfinite,
}
ON_TRUTHS: dict[str, Callable[..., Any]] = {
    "and": np.logical_and,
    "or": np.logical_or,
    "not": np.logical_not,
}
COMMUTE = {"+", "*", "==", "!=", "and", "or"}

# Modules that no comment names: whoever calls them computes.
ARITHMETIC = (Symbol.__module__, str(arrays.__package__))


class _Recorded:
    """A function of the record, by its name in the tables."""

    def __init__(self, op: str) -> None:
        self.op = op

    def __get__(self, record: "Record", _: Any) -> Callable[..., Symbol]:
        return lambda *args: record.apply(self.op, *args)


class Record:
    """What was computed with some symbols; the array library that they belong to."""

    inf, nan, float64, int64 = np.inf, np.nan, np.float64, np.int64
    finfo = staticmethod(np.finfo)
    sqrt, ceil, cos, sin = map(_Recorded, ("sqrt", "ceil", "cos", "sin"))
    arctan2, hypot, copysign = map(_Recorded, ("arctan2", "hypot", "copysign"))
    minimum, maximum = map(_Recorded, ("minimum", "maximum"))
    isinf, isnan, isfinite = map(_Recorded, ("isinf", "isnan", "isfinite"))
    logical_not = _Recorded("not")

    def __init__(self) -> None:
        self.symbols: list[Symbol] = []
        self._known: dict[tuple[Any, ...], Symbol] = {}
        self._slots: list[str] = []

    def slot(self, name: str) -> Symbol:
        """Return a number that will be given, by the text by which a formula calls it."""
        depends = 1 << len(self._slots)
        if ("slot", name) not in self._known:
            self._slots.append(name)
            made = Symbol(self, "slot", (), NUMBER, depends)
            made.name = name
            self._keep(("slot", name), made)
        return self._known["slot", name]

    def constant(self, value: Any) -> Symbol:
        """Return a number or a truth value that is known; −0 is another than 0."""
        truth = isinstance(value, bool | np.bool_)
        value = np.bool_(value) if truth else np.float64(value)
        key = ("constant", bool(value) if truth else struct.pack("<d", value))
        if key not in self._known:
            made = Symbol(self, "constant", (), TRUTH if truth else NUMBER, 0)
            made.value = value
            self._keep(key, made)
        return self._known[key]

    def asarray(self, value: Any) -> Any:
        """Return a number as a symbol; symbols come back as they are."""
        return value if isinstance(value, Symbol | SymbolArray) else self.constant(value)

    def stack(self, values: Sequence[Any], axis: int = 0) -> SymbolArray:
        """Join symbols, or arrays of them, along a new axis."""
        parts = [value.entries if isinstance(value, SymbolArray) else value for value in values]
        if isinstance(parts[0], np.ndarray):
            return SymbolArray(self, np.stack(parts, axis=axis))
        entries = np.empty(len(parts), object)
        entries[:] = [self.asarray(part) for part in parts]
        return SymbolArray(self, entries)

    def clip(self, x: Any, low: Any, high: Any) -> Symbol:
        """Return x, or the end of [low, high] beyond which it lies."""
        clipped: Symbol = self.apply("minimum", self.apply("maximum", x, low), high)
        return clipped

    def where(self, condition: Any, x: Any, y: Any) -> Symbol:
        """Return x where the condition holds, else y."""
        by, one, other = self._symbol(condition), self._symbol(x), self._symbol(y)
        if one.dtype != other.dtype:
            one, other = self._number(one), self._number(other)
        if by.op == "constant":
            return one if by.value else other
        return one if one is other else self._made("where", (by, one, other), one.dtype)

    def apply(self, op: str, *args: Any) -> Any:
        """Write an operation down, or do it where all is known."""
        if any(isinstance(arg, SymbolArray) for arg in args):
            return NotImplemented
        given = tuple(map(self._symbol, args))
        if op in ON_TRUTHS:
            return self._of_truths(op, given)
        if op not in ("==", "!=") or any(arg.dtype == NUMBER for arg in given):
            given = tuple(map(self._number, given))
        if op == "masked":
            given = (given[0], self.constant(args[1]))
        dtype, table = (TRUTH, TO_TRUTH) if op in TO_TRUTH else (NUMBER, ON_NUMBERS)
        if all(arg.op == "constant" for arg in given):
            with np.errstate(all="ignore"):
                values = [
                    int(v) if op == "masked" and i else v for i, v in enumerate(_values(given))
                ]
                return self.constant(table[op](*values))
        partly = any(arg.op == "constant" for arg in given)
        if partly and op in ("+", "-", "*", "/") and (same := _unchanged(op, *given)) is not None:
            return same
        return self._made(op, given, dtype)

    def _of_truths(self, op: str, given: tuple[Symbol, ...]) -> Symbol:
        if any(arg.dtype != TRUTH for arg in given):
            raise TypeError(f"{op} is of truth values")
        known = [arg for arg in given if arg.op == "constant"]
        if len(known) == len(given):
            return self.constant(ON_TRUTHS[op](*_values(given)))
        if known:  # one of two: it decides, or the other does
            (rest,) = (arg for arg in given if arg.op != "constant")
            return known[0] if bool(known[0].value) == (op == "or") else rest
        if op == "not" and given[0].op == "not":
            return given[0].args[0]
        return given[0] if len(set(given)) < len(given) else self._made(op, given, TRUTH)

    def _symbol(self, value: Any) -> Symbol:
        return value if isinstance(value, Symbol) else self.constant(value)

    def _number(self, value: Symbol) -> Symbol:
        return value if value.dtype == NUMBER else self.where(value, 1.0, 0.0)

    def _made(self, op: str, args: tuple[Symbol, ...], dtype: Any) -> Symbol:
        numbers = tuple(arg.number for arg in args)
        key = (op, *(sorted(numbers) if op in COMMUTE else numbers))
        if key not in self._known:
            depends = 0
            for arg in args:
                depends |= arg.depends
            made = Symbol(self, op, args, dtype, depends)
            made.source = _caller()
            self._keep(key, made)
        return self._known[key]

    def _keep(self, key: tuple[Any, ...], symbol: Symbol) -> None:
        symbol.number = len(self.symbols)
        self.symbols.append(symbol)
        self._known[key] = symbol


def _values(symbols: Sequence[Symbol]) -> list[Any]:
    return [symbol.value for symbol in symbols]


def _unchanged(op: str, x: Symbol, y: Symbol) -> Symbol | None:
    """Return what an operation with 1 or 0 leaves as it is, to the bit; None if there is none."""
    one, zero, minus_zero = x.record.constant(1.0), x.record.constant(0.0), x.record.constant(-0.0)
    if (op in "*/" and y is one) or (op == "-" and y is zero) or (op == "+" and y is minus_zero):
        return x
    return y if (op == "*" and x is one) or (op == "+" and x is minus_zero) else None


def _caller() -> str:
    """Return the name of the function that computes, above the arithmetic of ``numerics``."""
    frame = sys._getframe(1)  # noqa: SLF001 # whom the comments in the printed text name
    while frame.f_back is not None:
        module = str(frame.f_globals.get("__name__", ""))
        if module != __name__ and not module.startswith(ARITHMETIC):
            break
        frame = frame.f_back
    name = frame.f_code.co_qualname.replace(".<locals>", "").split(".<")[0]
    return f"{frame.f_globals.get('__name__', '')}.{name}"
