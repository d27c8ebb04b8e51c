"""The command ``standfast``: its words, its errors and its exit codes."""

import argparse
import contextlib
import io
import os
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from standfast.cli import (
    assess,
    cite,
    completion,
    explore,
    info,
    laws,
    person,
    plot,
    population,
    reproduce,
    sway,
    sweep,
    thresholds,
)
from standfast.cli.compile_cache import compiled_programs_kept
from standfast.cli.first_look import look_first
from standfast.cli.parsing import BY_COMMAS, StoppedError, is_of_a_list
from standfast.cli.printing import visible, visible_output
from standfast.errors import InputError, nearest_name
from standfast.version import __version__

DONE, FAILED, WRONG_INPUT = 0, 1, 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code: 0 done, 1 failed, 2 wrong input."""
    return _exit_code(build_parser().parse_args(arguments))


def run() -> None:
    """Entry point of the installed command: :func:`main` in a process of its own."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a console without Greek letters shows "?"
            stream.reconfigure(errors="replace")
    os.environ["MPLBACKEND"] = "agg"  # figures go to files, whatever the user's screen
    options = build_parser().parse_args()
    # workers of their own processes would read what others are writing
    alone = not any(vars(options).get(name) for name in ("executor", "workers", "scheduler"))
    kept = options.compiles and alone
    with compiled_programs_kept() if kept else contextlib.nullcontext():
        code = _exit_code(options, own_process=True)
    # Nothing is left to do but to take Python, JAX and matplotlib apart: a tenth of a second, in
    # which threads of an interrupted run could meet what is gone.
    with contextlib.suppress(OSError, ValueError):  # of a stream that is closed
        sys.stderr.flush()
    os._exit(code)


class _Parser(argparse.ArgumentParser):
    """A parser that names what is near to a slip, and prints no control characters of it."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse, and refuse the rest here, where the usage is that of the command."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(unknown)}{self._likely(unknown)}")
        return found, unknown

    def _likely(self, unknown: Sequence[str]) -> str:
        """Guess what was meant by arguments that are not known."""
        if all(map(is_of_a_list, unknown)):
            return f"; {BY_COMMAS}"
        options = (word.partition("=")[0] for word in unknown if word.startswith("--"))
        return next(
            filter(None, (nearest_name(o, self._option_string_actions) for o in options)), ""
        )

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Name the nearest command, which argparse does from Python 3.14 on."""
        if isinstance(action.choices, dict) and value not in action.choices:
            near = nearest_name(value, action.choices)
            names = ", ".join(action.choices)
            self.error(f"there is no command {value!r}{near} (commands: {names})")
        super()._check_value(action, value)

    def error(self, message: str) -> NoReturn:
        super().error(visible(message))


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands, of which completion and man page are made too."""
    parser = _Parser(
        prog="standfast",
        description="How stiff must ankle, knee and hip be for a person to stand?",
        epilog="example: standfast reproduce",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"standfast {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in (
        sweep,
        thresholds,
        plot,
        population,
        person,
        assess,
        explore,
        sway,
        laws,
        info,
        reproduce,
        cite,
    ):
        command.add(commands)
    completion.add(commands, parser)
    return parser


@visible_output()
def _exit_code(options: argparse.Namespace, *, own_process: bool = False) -> int:
    """Run the command that was asked for; say in one sentence what went wrong."""
    try:
        if own_process:  # without threads yet, so that it can be forked
            look_first(options)
        options.run(options)
        print(end="", flush=True)  # while a closed pipe can still be told from a failure
    except InputError as error:
        return _complain(str(error), WRONG_INPUT)
    except BrokenPipeError:  # the reader of a pipe has seen enough
        sys.stdout = None
        return DONE
    except StoppedError as stop:
        return _complain(str(stop), FAILED)
    except OSError as error:
        where = f" ({error.filename})" if error.filename else ""
        return _complain(f"{error.strerror or error}{where}", FAILED)
    except KeyboardInterrupt:
        return _complain("stopped", FAILED)
    return DONE


def _complain(sentence: str, code: int) -> int:
    line = sentence.replace("\n", "\\n")  # of the name of a file
    print(f"standfast: {line}", file=sys.stderr)
    return code
