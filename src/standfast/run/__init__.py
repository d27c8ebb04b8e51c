"""One loop for all work that is done in shards: folder, lock, shards, estimate, log."""

from standfast.run.estimate import Estimate
from standfast.run.folder import RunFolder, parts_of, tidy_up_after, unfinished
from standfast.run.lock import BusyError
from standfast.run.loop import Announce, Progress, RunOptions, checked_options, run_job

__all__ = [
    "Announce",
    "BusyError",
    "Estimate",
    "Progress",
    "RunFolder",
    "RunOptions",
    "checked_options",
    "parts_of",
    "run_job",
    "tidy_up_after",
    "unfinished",
]
