"""Puts the man page into the wheel, where ``make man`` has made one."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PAGE = "build/standfast.1"  # also among the artifacts of the sdist in pyproject.toml


class ManPage(BuildHookInterface):
    """Share the page, so that ``man standfast`` finds it in an environment that is active."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the page to a wheel's data."""
        page = Path(self.root) / PAGE
        if version == "standard" and page.is_file():
            build_data["shared_data"][str(page)] = "share/man/man1/standfast.1"
