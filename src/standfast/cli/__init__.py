"""The command line: the only part that prints, exits or sets the environment."""

from standfast.cli.commands import main, run

__all__ = ["main", "run"]
