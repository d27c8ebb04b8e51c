"""How a long sweep shows that it lives: a forecast, then a bar, or plain lines off the terminal."""

import contextlib
import signal
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from standfast.quantities import in_bytes

# A run that ends sooner needs neither a forecast nor a bar.
WORTH_A_FORECAST = 5.0  # s
PLAIN_STEPS = 10


@contextlib.contextmanager
def interruptible() -> Iterator[Callable[[], None]]:
    """Turn Ctrl-C into a KeyboardInterrupt at the next call of what is given, and nowhere else.

    Raised in the middle of JAX's imports or of its compiler, it can get lost or bring the process
    down. A second Ctrl-C acts at once.
    """
    asked = False

    def remember(signum: int, frame: Any) -> None:
        nonlocal asked
        del signum, frame
        asked = True
        signal.signal(signal.SIGINT, signal.default_int_handler)

    def stop_if_asked() -> None:
        if asked:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, remember)
    try:
        yield stop_if_asked
    finally:
        signal.signal(signal.SIGINT, before)


@contextlib.contextmanager
def progress_bar(
    what: str = "values",
) -> Iterator[tuple[Callable[[Any], None], Callable[[int, int], None]]]:
    """Give a forecast and a bar on a terminal, plain lines elsewhere."""
    console = Console(stderr=True)

    began = time.monotonic()

    def announce(forecast: Any) -> None:
        nonlocal began
        began = time.monotonic()  # what was before was compiling
        if forecast.seconds >= WORTH_A_FORECAST:
            console.print(
                f"{forecast.points:,} values to compute, about {in_bytes(forecast.disk_bytes)} on "
                f"disk until it is finished ({in_bytes(forecast.free_bytes)} free), "
                f"about {forecast.seconds:.0f} s",
                highlight=False,
            )

    if not console.is_terminal:
        last = 0

        def line(done: int, total: int) -> None:
            nonlocal last
            elapsed = time.monotonic() - began
            if done * PLAIN_STEPS // total > last and elapsed > WORTH_A_FORECAST:
                last = done * PLAIN_STEPS // total
                rate = done / elapsed
                left = (total - done) / rate
                print(
                    f"{100 * done // total} %, {rate:.3g} {what}/s, {left:.0f} s left",
                    file=sys.stderr,
                )

        yield announce, line
        return
    columns = (
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=None, rate="compiling")

        def advance(done: int, total: int) -> None:
            rate = done / max(time.monotonic() - began, 1e-9)
            bar.update(task, completed=done, total=total, rate=f"{rate:.3g} {what}/s")

        yield announce, advance
