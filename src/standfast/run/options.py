"""How a run is done, which changes nothing in its file."""

from collections.abc import Callable
from typing import Any, Protocol, TypedDict

from standfast.errors import InputError, shortened
from standfast.run.estimate import Estimate

# Called after every unit with the values (or persons) done and all of the run.
Progress = Callable[[int, int], None]
# Called with the estimate before the first.
Announce = Callable[[Estimate], None]


class Executor(Protocol):
    """What takes work: any ``concurrent.futures.Executor``, or a ``dask.distributed.Client``."""

    def submit(self, function: Any, /, *arguments: Any) -> Any:
        """Have a function called elsewhere; return what tells when it is done."""


class RunOptions(TypedDict, total=False):
    """How a run is done, which changes nothing in its file."""

    threads: int | None
    progress: Progress | None
    estimate: Announce | None
    executor: Executor | None


def check_threads(threads: Any) -> None:
    """Refuse what is no number of threads; None leaves it to the machine."""
    if threads is not None and not (_is_whole(threads) and threads >= 1):
        raise InputError(
            f"threads = {shortened(threads)} is not a number of threads; give 1 or more"
        )


def _is_whole(number: object) -> bool:
    return isinstance(number, int) and not isinstance(number, bool)


def checked_options(
    part: tuple[int, int] | None,
    threads: int | None,
    progress: Progress | None,
    estimate: Announce | None,
    executor: Executor | None,
) -> RunOptions:
    """Return the options of a run; refuse what is no number of threads, share or executor."""
    check_threads(threads)
    for key, call in (("progress", progress), ("estimate", estimate)):
        if call is not None and not callable(call):
            raise InputError(f"{key} = {shortened(call)} is not a function; give one, or None")
    if part is not None:
        two = isinstance(part, tuple | list) and len(part) == 2
        if not two or not all(map(_is_whole, part)):
            raise InputError(f"part = {shortened(part)} is not a share; give (i, N)")
        if not 1 <= part[0] <= part[1]:
            raise InputError(f"part = {part[0]}/{part[1]} is not a share; give i/N with 1 ≤ i ≤ N")
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise InputError(
            f"executor = {shortened(executor)} takes no work; give a concurrent.futures.Executor "
            "or a dask.distributed.Client"
        )
    return {
        "threads": threads, "progress": progress, "estimate": estimate, "executor": executor,
    }  # fmt: skip
