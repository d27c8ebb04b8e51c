"""What is printed: nothing that stands in a file or a name acts on the terminal."""

import contextlib
import sys
from collections.abc import Iterator
from typing import Any, TextIO

# Control characters but newline and tab, and what ends lines or turns the direction of writing.
_HIDDEN = (
    *range(0x20), *range(0x7F, 0xA0), 0x61C, 0x200E, 0x200F, *range(0x2028, 0x202F),
    *range(0x2066, 0x206A),
)  # fmt: skip
# From DEL on as JSON writes them, so that JSON stays JSON; it writes the others so itself.
_SHOWN = {
    code: f"\\x{code:02x}" if code < 0x7F else f"\\u{code:04x}"
    for code in _HIDDEN
    if chr(code) not in "\n\t"
}


def counted(number: int, one: str, many: str = "") -> str:
    """Return a number of things in words, as ``1 person`` and ``2,000 persons``."""
    return f"{number:,} {one if number == 1 else many or one + 's'}"


def visible(text: str) -> str:
    """Return a text with its control characters written out, as Python's ``repr`` does."""
    return text.translate(_SHOWN)


@contextlib.contextmanager
def visible_output() -> Iterator[None]:
    """Write all that is printed meanwhile by :func:`visible`."""
    out, err = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = _Visible.of(out), _Visible.of(err)
    try:
        yield
    finally:
        # None: the reader of a pipe has seen enough, and nothing more is to be flushed
        sys.stdout, sys.stderr = sys.stdout and out, err


class _Visible:
    """A stream that writes by :func:`visible`."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    @classmethod
    def of(cls, stream: TextIO) -> Any:
        """Return the stream, or None where a process has none."""
        return stream and cls(stream)

    def write(self, text: str) -> int:
        """Write a text."""
        return self._stream.write(visible(text))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
