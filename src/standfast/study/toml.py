"""Reading a study file: what can be wrong with it before its first key is looked at."""

import io
import tomllib
from pathlib import Path
from typing import Any

from standfast.errors import InputError
from standfast.files import checked_path, nearest_file, opened_plainly


def read_toml(path: str | Path) -> dict[str, Any]:
    """Return the content of a study file."""
    path = checked_path("study", path)
    try:
        with io.TextIOWrapper(opened_plainly(path), encoding="utf-8-sig") as file:
            text = file.read()
    except FileNotFoundError:
        near = nearest_file(path, ".toml")
        raise InputError(f"{path}: there is no such study file{near}") from None
    except IsADirectoryError:
        raise InputError(f"{path} is a folder; give a study file") from None
    except UnicodeDecodeError:
        hint = "; it looks like an atlas, not a study" if path.suffix == ".h5" else ""
        raise InputError(f"{path} is not a text file in UTF-8{hint}") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # of TOML, or an integer of thousands of digits
        raise InputError(f"{path} is not valid TOML: {error}") from None
