"""Numbers that write down what is computed with them, so that a formula can be printed elsewhere.

A formula of the package asks its arguments which library they belong to. Symbols belong to a
:class:`Record`: the same lines that compute with NumPy or JAX then leave a list of operations, each
once however often it is written (hash-consing). Whatever is known is computed at once in NumPy's
float64, and nothing is rearranged: the operations give the same bits as NumPy's on arrays.

Left out are only operations that change no bit of any number: times or over 1, and less 0.
"""

import struct
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

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
TRUTH, NUMBER = np.dtype(bool), np.dtype(np.float64)


class Symbol:
    """A float64, or a truth value, that is not known yet: an operation and its arguments.

    ``op`` is "slot" (a number that is given, called ``name``), "constant" (``value``), "where", or
    a key of the tables above. ``number`` counts the symbols of a record; arguments come before what
    is made of them. ``depends`` has a bit for each slot that it hangs on; ``source`` names the
    function in which it was first written.
    """

    __slots__ = ("args", "depends", "dtype", "name", "number", "op", "record", "source", "value")
    __array_ufunc__ = None  # a number of NumPy on the left leaves the operation to the symbol
    shape: tuple[int, ...] = ()
    ndim = 0

    def __init__(
        self, record: "Record", op: str, args: tuple["Symbol", ...], dtype: Any, depends: int
    ) -> None:
        self.record, self.op, self.args, self.dtype, self.depends = record, op, args, dtype, depends
        self.number = -1
        self.value: Any = None
        self.name = self.source = ""

    def __array_namespace__(self, **_: Any) -> "Record":
        return self.record

    def __bool__(self) -> bool:
        raise TypeError("a symbol has no value yet; choose with where")

    __hash__ = object.__hash__

    def __add__(self, other: Any) -> Any:
        return self.record.apply("+", self, other)

    def __radd__(self, other: Any) -> Any:
        return self.record.apply("+", other, self)

    def __sub__(self, other: Any) -> Any:
        return self.record.apply("-", self, other)

    def __rsub__(self, other: Any) -> Any:
        return self.record.apply("-", other, self)

    def __mul__(self, other: Any) -> Any:
        return self.record.apply("*", self, other)

    def __rmul__(self, other: Any) -> Any:
        return self.record.apply("*", other, self)

    def __truediv__(self, other: Any) -> Any:
        return self.record.apply("/", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return self.record.apply("/", other, self)

    def __pow__(self, power: int) -> Any:
        """Multiply as JAX does; NumPy's arrays square so, and take the library's power above."""
        if not isinstance(power, int) or power < 1:
            raise TypeError(f"a symbol is raised to positive whole numbers, not {power!r}")
        product, square = None, self
        while power:
            if power & 1:
                product = square if product is None else product * square
            power >>= 1
            square = square * square if power else square
        return product

    def __neg__(self) -> "Symbol":
        return self.record.apply("minus", self)

    def __abs__(self) -> "Symbol":
        return self.record.apply("abs", self)

    def __lt__(self, other: Any) -> Any:
        return self.record.apply("<", self, other)

    def __le__(self, other: Any) -> Any:
        return self.record.apply("<=", self, other)

    def __gt__(self, other: Any) -> Any:
        return self.record.apply(">", self, other)

    def __ge__(self, other: Any) -> Any:
        return self.record.apply(">=", self, other)

    def __eq__(self, other: object) -> Any:
        return self.record.apply("==", self, other)

    def __ne__(self, other: object) -> Any:
        return self.record.apply("!=", self, other)

    def __and__(self, other: Any) -> Any:
        return self.record.apply("and", self, other)

    def __rand__(self, other: Any) -> Any:
        return self.record.apply("and", other, self)

    def __or__(self, other: Any) -> Any:
        return self.record.apply("or", self, other)

    def __ror__(self, other: Any) -> Any:
        return self.record.apply("or", other, self)

    def __invert__(self) -> "Symbol":
        return self.record.apply("not", self)

    def __getitem__(self, key: tuple[()]) -> "Symbol":
        if key != ():
            raise IndexError(f"a symbol has no axes to take {key!r} of")
        return self

    def view(self, dtype: Any) -> "Bits":
        """Return its bits, of which a mask may be taken."""
        if dtype is not np.int64:
            raise TypeError(f"a symbol is seen as int64, not as {dtype}")
        return Bits(self, -1)


class Bits:
    """The 64 bits of a symbol, less those that a mask takes out."""

    __array_ufunc__ = None

    def __init__(self, of: Symbol, mask: int) -> None:
        self.of, self.mask = of, mask

    def __and__(self, mask: np.int64) -> "Bits":
        return Bits(self.of, self.mask & int(mask))

    def view(self, dtype: Any) -> Symbol:
        """Return them as a float64 again."""
        if dtype is not np.float64:
            raise TypeError(f"bits are seen as float64, not as {dtype}")
        return self.of.record.apply("masked", self.of, self.mask)


class SymbolArray:
    """A small array of symbols (and of numbers), as bodies and modes are made of."""

    __array_ufunc__ = None
    __hash__ = None  # type: ignore[assignment] # arrays have none either

    def __init__(self, record: "Record", entries: np.ndarray) -> None:
        self.record, self.entries = record, entries
        self.shape, self.ndim, self.dtype = entries.shape, entries.ndim, NUMBER

    def __array_namespace__(self, **_: Any) -> "Record":
        return self.record

    def __len__(self) -> int:
        return len(self.entries)

    def __iter__(self) -> Iterator[Any]:
        return (self[number] for number in range(len(self)))

    def __getitem__(self, key: Any) -> Any:
        found = self.entries[key]
        return SymbolArray(self.record, found) if isinstance(found, np.ndarray) else found

    def __mul__(self, factor: Symbol) -> "SymbolArray":
        product = np.empty(self.shape, object)
        for index in np.ndindex(self.shape):
            product[index] = self.entries[index] * factor
        return SymbolArray(self.record, product)

    __rmul__ = __mul__

    @property
    def T(self) -> "SymbolArray":  # noqa: N802 # as arrays call it
        """The array with its axes turned round."""
        return SymbolArray(self.record, self.entries.T)


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
        return self.apply("minimum", self.apply("maximum", x, low), high)

    def where(self, condition: Any, x: Any, y: Any) -> Symbol:
        """Return x where the condition holds, else y."""
        condition, x, y = (self.asarray(value) for value in (condition, x, y))
        if x.dtype != y.dtype:
            x, y = self._number(x), self._number(y)
        if condition.op == "constant":
            return x if condition.value else y  # type: ignore[no-any-return] # of asarray
        return x if x is y else self._made("where", (condition, x, y), x.dtype)  # type: ignore[no-any-return]

    def apply(self, op: str, *args: Any) -> Any:
        """Write an operation down, or do it where all is known."""
        if any(isinstance(arg, SymbolArray) for arg in args):
            return NotImplemented
        given = tuple(self.asarray(arg) for arg in args)
        if op in ON_TRUTHS:
            return self._of_truths(op, given)
        if op not in ("==", "!=") or any(arg.dtype == NUMBER for arg in given):
            given = tuple(map(self._number, given))
        if op == "masked":
            given = (given[0], self.constant(args[1]))
        dtype, table = (TRUTH, TO_TRUTH) if op in TO_TRUTH else (NUMBER, ON_NUMBERS)
        if all(arg.op == "constant" for arg in given):
            with np.errstate(all="ignore"):
                values = [int(v) if op == "masked" and i else v for i, v in enumerate(_values(given))]
                return self.constant(table[op](*values))
        if op in ("+", "-", "*", "/") and (same := _unchanged(op, *given)) is not None:
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
    frame = sys._getframe(1)
    while frame.f_back is not None:
        module = str(frame.f_globals.get("__name__", ""))
        if module != __name__ and not module.startswith("standfast.numerics"):
            break
        frame = frame.f_back
    name = frame.f_code.co_qualname.replace(".<locals>", "").split(".<")[0]
    return f"{frame.f_globals.get('__name__', '')}.{name}"
