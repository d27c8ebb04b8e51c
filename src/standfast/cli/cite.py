"""``standfast cite``: the paper and the software as BibTeX, out of ``CITATION.cff``."""

import argparse
import string
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import add_command
from standfast.version import __version__

if TYPE_CHECKING:
    from importlib.resources.abc import Traversable

TO_TEX = str.maketrans({letter: f"\\{letter}" for letter in "&%$#_{}"})


def add(commands: Any) -> None:
    """Declare the command."""
    add_command(
        commands,
        _cite,
        "what to cite, as BibTeX: the paper for the model, standfast for the computation",
        "cite >> references.bib",
    )


def _cite(_: argparse.Namespace) -> None:
    import yaml

    content = yaml.safe_load(citation_file().read_text("utf-8"))
    print("\n\n".join(_entry(*each) for each in _works(content)))


def citation_file() -> "Traversable | Path":
    """Return the one file: a wheel has it inside the package, a checkout at its root."""
    from importlib.resources import files

    inside = files("standfast") / "CITATION.cff"
    return inside if inside.is_file() else Path(__file__).parents[3] / "CITATION.cff"


def _works(content: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield what is cited, each with its key: the software, its own paper, the model's."""
    yield "standfast", {**content, "version": __version__}
    if "preferred-citation" in content:
        yield "standfast-paper", content["preferred-citation"]
    works = content["references"]
    keys = [_key(work) for work in works]
    letters = {
        key: iter(string.ascii_lowercase) for key, times in Counter(keys).items() if times > 1
    }
    for key, work in zip(keys, works, strict=True):
        yield (key + next(letters[key]) if key in letters else key), work


def _key(work: dict[str, Any]) -> str:
    """Return the first author's name with the year; works that share it get a, b, as in texts."""
    first = _surname(work["authors"][0])
    letters = "".join(filter(str.isalnum, first))  # a blank would end the key
    return f"{letters}{work.get('year', '')}".lower()


def _entry(key: str, work: dict[str, Any]) -> str:
    """Return one entry of BibTeX; what a work does not have is left out."""
    article = work["type"] == "article"
    pages = f"{work['start']}--{work['end']}" if "start" in work else None
    software = f"Software, version {work['version']}" if "version" in work else None
    date = str(work.get("date-released", work.get("year", "")))
    fields = {
        "author": " and ".join(map(_author, work["authors"])),
        "title": f"{{{_tex(work['title'])}}}",
        "journal": _tex(work.get("journal")),
        "volume": _tex(work.get("volume")),
        "number": _tex(work.get("issue")),
        "pages": pages,
        "year": date[:4],
        "howpublished": software,
        "url": work.get("url", work.get("repository-code")),
        "doi": work.get("doi"),
    }
    lines = [f"  {name} = {{{value}}}" for name, value in fields.items() if value]
    return "@{}{{{},\n{}\n}}".format("article" if article else "misc", key, ",\n".join(lines))


def _author(author: dict[str, str]) -> str:
    """Return a person as ``Family, Given``; a group is kept together by braces."""
    if "name" in author:
        return f"{{{_tex(author['name'])}}}"
    return ", ".join(map(_tex, filter(None, (_surname(author), author.get("given-names")))))


def _surname(author: dict[str, str]) -> str:
    """Return a group's name, or a person's family name with what stands before it, as van den."""
    if "name" in author:
        return author["name"]
    return f"{author.get('name-particle', '')} {author['family-names']}".strip()


def _tex(value: Any) -> str:
    return "" if value is None else str(value).translate(TO_TEX)
