"""Workers of a command: processes of this machine, or those of a Dask cluster."""

import argparse
import contextlib
import multiprocessing
from collections.abc import Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from typing import Any

from standfast.cli.parsing import number_from_1
from standfast.errors import InputError


def add_executor_options(parser: argparse.ArgumentParser) -> None:
    """Declare who computes."""
    parser.add_argument(
        "--executor",
        choices=("processes", "dask"),
        help="who computes (default: threads)",
    )
    parser.add_argument(
        "--workers",
        type=number_from_1,
        metavar="N",
        help="processes, here or in a Dask cluster of this machine (default: one a core)",
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="of a running Dask cluster, for example tcp://host:8786",
    )


@contextlib.contextmanager
def executor_of(options: argparse.Namespace) -> Iterator[Any]:
    """Give the executor that was asked for, None for threads of this process.

    Raises
    ------
    InputError
        if options contradict each other, or Dask is not there.
    """
    kind = options.executor or ("dask" if options.scheduler else None)
    if kind is None and options.workers:
        kind = "processes"
    if options.scheduler and (kind != "dask" or options.workers):
        raise InputError("--scheduler names a Dask cluster that runs, with workers of its own")
    if kind is None:
        yield None
    elif kind == "processes":
        with Processes(options.workers) as pool:
            yield pool
    else:
        with _dask_client(options.scheduler, options.workers) as client:
            yield client


class Processes(Executor):
    """Spawned processes; a pool that broke because one of them died is replaced by a new one."""

    def __init__(self, workers: int | None) -> None:
        from standfast.run.machine import cores

        self._workers = workers or cores()
        self._pool = self._new()

    def _new(self) -> ProcessPoolExecutor:
        spawn = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(self._workers, mp_context=spawn, initializer=_quiet)

    def submit(self, function: Any, /, *arguments: Any, **named: Any) -> "Future[Any]":
        """Have a function called in one of the processes."""
        try:
            return self._pool.submit(function, *arguments, **named)
        except BrokenProcessPool:
            self._pool = self._new()
            return self._pool.submit(function, *arguments, **named)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes."""
        self._pool.shutdown(wait=wait, cancel_futures=cancel_futures)


def _quiet() -> None:
    """Leave Ctrl-C to the process that the user sees."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextlib.contextmanager
def _dask_client(scheduler: str | None, workers: int | None) -> Iterator[Any]:
    try:
        distributed: Any = import_module("distributed")
    except ImportError:
        raise InputError("--executor dask needs Dask: pip install 'standfast[dask]'") from None
    if scheduler is not None:
        try:
            client = distributed.Client(scheduler, timeout=20)
        except (OSError, ValueError, TimeoutError) as error:
            raise InputError(f"no Dask scheduler answers at {scheduler} ({error})") from None
        with client:
            yield client
        return
    with (
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client
