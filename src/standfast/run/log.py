"""The log of a run beside its file: what may differ from run to run."""

import contextlib
import json
import os
import platform
import time
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from standfast.files import whole_file
from standfast.run.shards import Work
from standfast.version import __version__


def write_log(
    output: Path, study: Work, what: str, computed: int, seconds: float, more: Mapping[str, Any]
) -> None:
    """Write ``<name>.run.json``: the run, and the machine and versions that it ran on.

    The finished file is whole by then; its log is a courtesy that a full disk may refuse.
    """
    log = {
        "study": study.title,
        "study_sha256": study.fingerprint,
        "seconds": round(seconds, 3),
        f"{what}_computed_in_this_run": computed,
        f"{what}_per_second": round(computed / seconds),
        "shards": study.shard_count,
        **more,
        "bytes": output.stat().st_size,
        "finished": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
        "machine": platform.machine(),
        "system": platform.system(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        "versions": {
            "standfast": __version__,
            **{name: version(name) for name in ("jax", "numpy", "h5py", "isal")},
        },
    }
    path = output.with_name(f"{output.name.removesuffix('.h5')}.run.json")
    with contextlib.suppress(OSError), whole_file(path) as partial:
        partial.write_text(json.dumps(log, indent=2) + "\n", encoding="utf-8")
