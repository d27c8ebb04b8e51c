"""A first look at an HDF5 file, in a process that may die of it.

Some files bring HDF5 itself down, or let it take gigabytes, before it says a word. So a command
opens the file that it is given in a child first, whose memory and time are limited, and which is
forked before there is any thread.
"""

import argparse
import contextlib
import os
import resource
import signal
from pathlib import Path

from standfast.cli.running import output_of
from standfast.errors import InputError

MOST_MEMORY, MOST_SECONDS = 2**31, 60  # beyond what the process has; of the processor


def look_first(options: argparse.Namespace) -> None:
    """Look at the files that a command reads, or finds finished; refuse what HDF5 fails on."""
    given = vars(options)
    found = output_of(options) if "study" in given else given.get("atlas") or given.get("source")
    for path in found if isinstance(found, list) else [found]:
        if path is not None and path.suffix != ".toml" and path.is_file():
            _look_at(path)


def _look_at(path: Path) -> None:
    from standfast.atlas.opening import open_atlas
    from standfast.population.summary.file import is_population, open_population

    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            _limit_this_process()
            (open_population if is_population(path) else open_atlas)(path)
        except InputError as error:
            os.write(writing, str(error).encode(errors="replace"))
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        sentence = pipe.read().decode()
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        name = signal.Signals(os.WTERMSIG(status)).name
        raise InputError(f"{path} is damaged in a way that brings HDF5 down ({name})")
    if sentence:
        raise InputError(sentence)


def _limit_this_process() -> None:
    with contextlib.suppress(OSError, ValueError):  # where there is no such limit, or no /proc
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS))
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
        most = pages * resource.getpagesize() + MOST_MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
