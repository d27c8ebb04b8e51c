"""Run the command line as ``python -m standfast``."""

from standfast.cli.app import run

run()
