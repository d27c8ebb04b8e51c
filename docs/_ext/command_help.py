"""The directive ``{command-help}``: each command with its help, as the parser prints it."""

import argparse

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from standfast.cli.app import build_parser

WIDTH = 78


def commands(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Return the parsers of the commands by name."""
    (found,) = (each for each in parser._actions if isinstance(each.choices, dict))  # noqa: SLF001 - argparse has no other way
    return dict(found.choices)


def help_of(parser: argparse.ArgumentParser) -> nodes.literal_block:
    """Return a parser's help as it is printed, at a width of its own."""
    formatter = parser.formatter_class
    parser.formatter_class = lambda prog: formatter(prog, width=WIDTH)
    text = parser.format_help()
    return nodes.literal_block(text, text, language="text")


class CommandHelp(SphinxDirective):
    """A section for each command."""

    def run(self) -> list[nodes.Node]:
        """Print the help of all."""
        parser = build_parser()
        found: list[nodes.Node] = [help_of(parser)]
        for name, command in commands(parser).items():
            section = nodes.section(ids=[f"standfast-{name}"], names=[name])
            section += nodes.title(name, f"standfast {name}")
            section += help_of(command)
            found.append(section)
        return found


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("command-help", CommandHelp)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
