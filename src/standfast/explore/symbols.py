"""Numbers that are not known yet, and small arrays of them: what a formula is given to record it.

They behave as float64 of NumPy and JAX do, and hand every operation to the record that they are of
(:mod:`.recording`).
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

TRUTH, NUMBER = np.dtype(bool), np.dtype(np.float64)


class Symbol:
    """A float64, or a truth value, that is not known yet: an operation and its arguments.

    ``op`` is "slot" (a number that is given, called ``name``), "constant" (``value``), "where", or
    a key of the record's tables. ``number`` counts the symbols of a record; arguments come before
    what is made of them. ``depends`` has a bit for each slot that it hangs on; ``source`` names the
    function in which it was first written.
    """

    __slots__ = ("args", "depends", "dtype", "name", "number", "op", "record", "source", "value")
    __array_ufunc__ = None  # a number of NumPy on the left leaves the operation to the symbol
    shape: tuple[int, ...] = ()
    ndim = 0

    def __init__(
        self, record: Any, op: str, args: tuple["Symbol", ...], dtype: Any, depends: int
    ) -> None:
        self.record, self.op, self.args, self.dtype, self.depends = record, op, args, dtype, depends
        self.number = -1
        self.value: Any = None
        self.name = self.source = ""

    def __array_namespace__(self, **_: Any) -> Any:
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

    def __neg__(self) -> Any:
        return self.record.apply("minus", self)

    def __abs__(self) -> Any:
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

    def __invert__(self) -> Any:
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

    def view(self, dtype: Any) -> Any:
        """Return them as a float64 again."""
        if dtype is not np.float64:
            raise TypeError(f"bits are seen as float64, not as {dtype}")
        return self.of.record.apply("masked", self.of, self.mask)


class SymbolArray:
    """A small array of symbols (and of numbers), as bodies and modes are made of."""

    __array_ufunc__ = None
    __hash__ = None  # type: ignore[assignment] # arrays have none either

    def __init__(self, record: Any, entries: np.ndarray) -> None:
        self.record, self.entries = record, entries
        self.shape, self.ndim, self.dtype = entries.shape, entries.ndim, NUMBER

    def __array_namespace__(self, **_: Any) -> Any:
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
