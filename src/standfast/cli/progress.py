"""How a long run shows that it lives: an estimate, then a bar, or plain lines off the terminal."""

import contextlib
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

from standfast.files import in_bytes
from standfast.run.estimate import Estimate

# A run that ends sooner needs neither an estimate nor a line.
WORTH_A_LINE = 5.0  # s
PLAIN_STEPS = 10

ShowProgress = Callable[[int, int], None]  # done, total
Display = tuple[Callable[[str], None], Callable[[int, int, float], None]]  # the same, and seconds


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
        with contextlib.suppress(OSError):
            os.write(2, b"\nstopping after what is under way; Ctrl-C again stops at once\n")
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
    what: str, at_first: str = "compiling"
) -> Iterator[tuple[Callable[[Estimate], None], ShowProgress]]:
    """Show an estimate and a bar on a terminal, plain lines elsewhere; ``what`` is counted.

    ``at_first`` stands where the rate will be.
    """
    on_terminal = sys.stderr is not None and sys.stderr.isatty()
    began = time.monotonic()
    with _bar(what, at_first) if on_terminal else _plain_lines(what) as (print_line, show):

        def show_estimate(estimate: Estimate) -> None:
            nonlocal began
            began = time.monotonic()  # what was before was compiling
            if estimate.seconds >= WORTH_A_LINE:
                print_line(
                    f"{estimate.points:,} {what} to compute, about "
                    f"{in_bytes(estimate.disk_bytes)} on disk until it is finished "
                    f"({in_bytes(estimate.free_bytes)} free), about {estimate.seconds:.0f} s"
                )

        def show_progress(done: int, total: int) -> None:
            show(done, total, max(time.monotonic() - began, 1e-9))

        yield show_estimate, show_progress


@contextlib.contextmanager
def _bar(what: str, at_first: str) -> Iterator[Display]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    texts = TextColumn("{task.percentage:3.0f} %"), TextColumn("{task.fields[rate]}")
    columns = (BarColumn(), *texts, TimeRemainingColumn())
    with Progress(*columns, console=Console(file=sys.__stderr__), transient=True) as bar:
        task = bar.add_task("", total=None, rate=at_first)

        def show(done: int, total: int, seconds: float) -> None:
            bar.update(task, completed=done, total=total, rate=f"{done / seconds:.3g} {what}/s")

        yield lambda text: bar.console.print(text, highlight=False), show


@contextlib.contextmanager
def _plain_lines(what: str) -> Iterator[Display]:
    last = 0

    def print_line(text: str) -> None:
        print(text, file=sys.stderr)

    def show(done: int, total: int, seconds: float) -> None:
        nonlocal last
        if done * PLAIN_STEPS // total > last and seconds > WORTH_A_LINE:
            last = done * PLAIN_STEPS // total
            rate = done / seconds
            left = (total - done) / rate
            print_line(f"{100 * done // total} %, {rate:.3g} {what}/s, {left:.0f} s left")

    yield print_line, show
