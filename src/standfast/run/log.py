"""The log of a run beside its file: what may differ from run to run."""

import json
import platform
import time
from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

from standfast.run.machine import cores, kind_of_processor
from standfast.run.shards import Work
from standfast.version import __version__


def log_text(study: Work, what: str, computed: int, seconds: float, more: Mapping[str, Any]) -> str:
    """Return ``<name>.run.json``: the run, and the machine and versions that it ran on."""
    log = {
        "study": study.title,
        "study_sha256": study.fingerprint,
        "seconds": round(seconds, 3),
        f"{what}_computed_in_this_run": computed,
        f"{what}_per_second": round(computed / seconds),
        "shards": study.shard_count,
        **more,
        "finished": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
        "machine": platform.machine(),
        "processor": kind_of_processor(),
        "system": platform.system(),
        "cores": cores(),
        "python": platform.python_version(),
        "versions": {
            "standfast": __version__,
            **{name: version(name) for name in ("jax", "numpy", "h5py", "isal")},
        },
    }
    return json.dumps(log, indent=2) + "\n"
