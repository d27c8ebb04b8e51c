"""The one error for what a user gave, and the nearest right name for its message."""

import difflib
import functools
import inspect
from collections.abc import Callable, Iterable
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


class InputError(ValueError):
    """Something a user gave is wrong; the message is one sentence that says what would be right.

    Examples
    --------
    >>> import standfast as sf
    >>> try:
    ...     sf.Body.from_height_mass(175, 70)
    ... except sf.InputError as error:
    ...     print(error)
    height = 175 is outside the allowed range, 0.5 to 2.8 m; 175 looks like centimetres, write 1.75
    """


class UnknownNameError(InputError, KeyError):
    """A name that a mapping of standfast does not hold; a ``KeyError`` too, as mappings promise."""

    __str__ = ValueError.__str__  # that of KeyError would put the sentence into quotation marks


# Words that are not near in letters to what they mean.
SYNONYMS = {"weight": "mass", "size": "height", "length": "height", "g": "gravity"}


def nearest_name(given: object, names: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for a near miss, else an empty string."""
    names = list(names)
    if SYNONYMS.get(str(given)) in names:
        return f"; did you mean {SYNONYMS[str(given)]!r}?"
    turned = "_".join(reversed(str(given).split("_")))  # knee_ankle for ankle_knee
    if turned in names:
        return f"; did you mean {turned!r}?"
    close = difflib.get_close_matches(str(given), names, n=1, cutoff=0.5)
    return f"; did you mean {close[0]!r}?" if close else ""


def shortened(given: object) -> str:
    """Return how Python writes a value, cut so that the message that refuses it is one line."""
    text = repr(given)
    return text if len(text) <= 60 else f"{text[:57]}…"


def says_its_arguments(hint: str = "") -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Let a function say in a sentence, with a hint, which argument it lacks or does not have.

    Its signature stays as it is, for type checkers and ``help``, and a right call costs no check:
    the arguments are looked at once Python has refused them.
    """

    def of(function: Callable[P, T]) -> Callable[P, T]:
        @functools.wraps(function)
        def called(*given: P.args, **named: P.kwargs) -> T:
            try:
                return function(*given, **named)
            except TypeError:
                if wrong := _wrong_arguments(function, given, named):
                    raise InputError(f"{wrong}{hint and '; '}{hint}") from None
                raise

        return called

    return of


def _wrong_arguments(
    function: Callable[..., Any], given: tuple[Any, ...], named: dict[str, Any]
) -> str:
    """Say why a function cannot be called with arguments; empty if it can."""
    parameters = inspect.signature(function).parameters
    try:
        inspect.signature(function).bind(*given, **named)
    except TypeError:
        of_class = next(iter(parameters)) == "cls"
        names = list(parameters)[1 if of_class else 0 :]
        what = function.__qualname__.removesuffix(".__new__")
        takes = f"(it takes {', '.join(names)})"
        for name in named:
            if name not in names:
                return f"{what} has no {name!r}{nearest_name(name, names)} {takes}"
        placed = [row.name for row in parameters.values() if row.kind is not row.KEYWORD_ONLY]
        there = {*placed[: len(given)], *named}
        for name, row in parameters.items():
            if name not in there and row.default is row.empty:
                return f"{what} lacks {name} {takes}"
        return f"{what} has too many arguments, or one twice {takes}"
    return ""
