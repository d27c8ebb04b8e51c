"""What the scripts of the gallery write is taken away, so that each begins in an empty folder."""

from pathlib import Path
from typing import Any


def remove(settings: dict[str, Any], script: str) -> None:
    """Remove the files that scripts of a folder have written."""
    for pattern in ("*.h5", "*.run.json"):
        for path in Path(script).resolve().parent.glob(pattern):
            path.unlink()
