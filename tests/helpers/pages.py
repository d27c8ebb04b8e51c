"""Examples of the documentation's pages, found by Sybil and run as a reader would run them.

``python`` runs, all blocks of a page one after another; ``toml`` is a study or a part of one, and
is written where the words before it name a file; of ``sh`` and ``console`` every line that calls
standfast runs in this process, ``*`` and ``>`` as in a shell, and the lines that follow one in
``console`` are printed by it.
A cell of a notebook is python, a file that it writes, or lines of a shell, as its first line says;
one that shows its output alone is left out.
An HTML comment ``<!-- skip: next -->`` leaves out the block that follows, and is not seen.
"""

import copy
import re
import shlex
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path

from sybil import Document, Example, Region, Sybil
from sybil.evaluators.python import PythonEvaluator
from sybil.parsers.markdown import CodeBlockParser, SkipParser
from sybil.parsers.myst.lexers import DirectiveLexer

from populations import GOOD as A_POPULATION
from standfast.cli.app import main
from standfast.population.people.study import PopulationStudy
from standfast.study.study import Study
from studies import GOOD as A_STUDY

NAMED = re.compile(r"`(?:\w+/)?([\w-]+\.toml)`")
LEFT_OUT = "…"


def run_page(path: Path, capsys) -> None:
    """Run all examples of a page in the folder in which we are."""
    shell = Shell(capsys)
    parsers = [
        SkipParser(),
        CodeBlockParser("python", PythonEvaluator()),
        CodeBlockParser("toml", read_study),
        CodeBlockParser("sh", shell),
        CodeBlockParser("console", shell),
        Cells(shell),
    ]
    for example in Sybil(parsers).parse(path).examples():
        example.evaluate()


def read_study(example: Example) -> None:
    """Check a study; a part of one is put into a study that is complete."""
    content = tomllib.loads(example.parsed)
    whole = completed(content)
    try:
        (PopulationStudy if "population" in whole else Study).from_dict(whole)
    except ValueError as error:
        raise AssertionError(f"{place(example)}: {error}") from error
    if whole == content and (name := file_of(example.document, example.region.start)):
        Path(name).write_text(example.parsed, encoding="utf-8")


def completed(content: dict) -> dict:
    """Return a study's content; tables that it leaves out are those of another."""
    if "population" in content or {"body", "stiffness", "output"} <= content.keys():
        return content
    tables = (content.get(name, {}) for name in ("stiffness", "noise", "damping"))
    laws = [v for table in tables for v in table.values() if isinstance(v, dict)]
    of_people = any({"distribution", "law"} & v.keys() for v in laws)
    return {**copy.deepcopy(A_POPULATION if of_people else A_STUDY), **content}


def file_of(document: Document, start: int) -> str | None:
    """Return the last file that the paragraph before a block names."""
    paragraph = document.text[:start].rstrip().rpartition("\n\n")[2]
    names = NAMED.findall(paragraph)
    return names[-1] if names else None


class Cells:
    """Finds the cells of a page that is a notebook, and runs them."""

    def __init__(self, shell):
        self.shell = shell
        self.python = PythonEvaluator()

    def __call__(self, document: Document) -> Iterable[Region]:
        for region in DirectiveLexer("code-cell")(document):
            if "remove-input" not in region.lexemes["options"].get("tags", ""):
                region.parsed, region.evaluator = region.lexemes["source"], self.run
                yield region

    def run(self, example: Example) -> None:
        magic, _, text = example.parsed.partition("\n")
        if magic.startswith("%%writefile "):
            Path(magic.split()[1]).write_text(text, encoding="utf-8")
        elif magic == "%%sh":
            self.shell.run(text, place(example))
        else:
            self.python(example)


class Shell:
    """Runs the lines of a block that call standfast, and looks for what they print."""

    def __init__(self, capsys):
        self.capsys = capsys

    def __call__(self, example: Example) -> None:
        self.run(example.parsed, place(example))

    def run(self, text: str, where: str) -> None:
        for command, printed in commands_of(text):
            self.capsys.readouterr()
            words = words_of(command)[1:]
            target = words[words.index(">") + 1] if ">" in words else None
            code = main(words[: words.index(">")] if target else words)
            out, err = self.capsys.readouterr()
            if target is not None:
                Path(target).write_text(out, encoding="utf-8")
            if code != 0:
                raise AssertionError(f"{where}: {command}\n{err}")
            if (missing := not_printed(printed, out)) is not None:
                raise AssertionError(f"{where}: {command}\nnot printed: {missing}\n{out}")


def commands_of(text: str) -> Iterator[tuple[str, list[str]]]:
    """Yield each call of standfast in a block with the lines that follow it."""
    lines = text.replace("\\\n", " ").splitlines()
    starts = [i for i, line in enumerate(lines) if re.match(r"(\$ )?\w+ ", line)]
    prompts = [i for i in starts if lines[i].startswith("$ ")]
    calls = prompts or starts
    for start, end in zip(calls, [*calls[1:], len(lines)], strict=True):
        command = lines[start].removeprefix("$ ")
        if command.startswith("standfast "):
            yield command, lines[start + 1 : end] if prompts else []


def words_of(command: str) -> list[str]:
    """Return the words of a command as a shell does: files in place of a pattern of theirs."""
    found = []
    for word in shlex.split(command, comments=True):
        found += sorted(map(str, Path().glob(word))) if "*" in word else [word]
    return found


def not_printed(expected: list[str], out: str) -> str | None:
    """Return the first line that is not among those printed, in order; none if all are."""
    printed = iter([line.strip() for line in out.splitlines()])
    for line in expected:
        if line.strip() not in {"", LEFT_OUT} and line.strip() not in printed:
            return line
    return None


def place(example: Example) -> str:
    return f"{Path(example.path).name}, line {example.line}"
