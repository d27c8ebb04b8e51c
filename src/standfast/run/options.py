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


def checked_options(
    part: tuple[int, int] | None,
    threads: int | None,
    progress: Progress | None,
    estimate: Announce | None,
    executor: Executor | None,
) -> RunOptions:
    """Return the options of a run; refuse what is no number of threads, share or executor."""
    if threads is not None and not (isinstance(threads, int) and threads >= 1):
        raise InputError(
            f"threads = {shortened(threads)} is not a number of threads; give 1 or more"
        )
    if part is not None:
        two = isinstance(part, tuple | list) and len(part) == 2
        if not two or not all(isinstance(number, int) for number in part):
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
