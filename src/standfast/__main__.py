"""Run the command line as ``python -m standfast``."""

from standfast.cli import run

run()
