"""Workers that die inside a shard, once: functions that a worker imports and is told to call."""

import os
import signal
from pathlib import Path

import studies  # noqa: F401 - its shards are as small in a worker as in the tests
from standfast.atlas.sweeping import sweep_shards
from standfast.population.people import study as people_study
from standfast.population.simulation import simulate_shards
from standfast.run import folder
from standfast.run.shards import HEADER_BYTES
from standfast.study.study import Study

BLOCKS = 8  # of persons in a shard, so that a small population has several


def _killed_once(task, study, output, numbers, threads, version, at=1):
    """Do a task; the first process that comes to the end of a shard is killed there by SIGKILL."""
    people_study.BLOCKS_PER_SHARD = BLOCKS  # this is a worker, which does nothing else
    whole = folder.new_shard
    mark = Path(f"{output}.killed")

    class Deadly:
        def __init__(self, inner):
            self.inner = inner

        def __enter__(self):
            self.path = self.inner.__enter__()
            return self.path

        def __exit__(self, *error):
            if not mark.exists():
                mark.write_text(f"{self.path.stat().st_size > HEADER_BYTES}")
                os.kill(os.getpid(), signal.SIGKILL)
            return self.inner.__exit__(*error)

    def new_shard(path, work, number):
        made = whole(path, work, number)
        return Deadly(made) if number == at else made

    folder.new_shard = new_shard
    try:
        return task(study, output, numbers, threads, version)
    finally:
        folder.new_shard = whole


def sweep_killed_once(*task):
    return _killed_once(sweep_shards, *task)


def sweep_killed_at_the_end(*task):
    last = Study.from_canonical(task[0]).shard_count - 1
    return _killed_once(sweep_shards, *task, at=last)


def simulate_killed_once(*task):
    return _killed_once(simulate_shards, *task)
