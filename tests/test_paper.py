"""The paper has the form that its journal asks for, and its numbers are those of results/."""

import re
from datetime import datetime
from pathlib import Path

import pybtex.database
import pytest
import yaml

import standfast as sf

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "results"
_, FRONT, TEXT = (ROOT / "paper" / "paper.md").read_text("utf-8").split("---\n", 2)
SECTIONS = [
    "Summary",
    "Statement of need",
    "State of the field",
    "Software design",
    "Research impact statement",
    "AI usage disclosure",
    "Acknowledgements",
    "References",
]
FEWEST_WORDS, MOST_WORDS = 750, 1750
WORDS = {"thirteen": 13, "seventeen": 17, "four": 4}
# Benchmarks are measured anew, and machines are noisy: what the paper rounds may be off by that.
OF_A_BENCHMARK = 0.25


def test_the_front_matter_has_its_keys():
    front = yaml.safe_load(FRONT)
    assert {"title", "tags", "authors", "affiliations", "date", "bibliography"} <= front.keys()
    assert (ROOT / "paper" / front["bibliography"]).is_file()
    datetime.strptime(front["date"], "%d %B %Y").astimezone()
    known = {str(each["index"]) for each in front["affiliations"]}
    for author in front["authors"]:
        assert author["name"]
        assert set(re.split(", *", str(author["affiliation"]))) <= known
    assert "`" not in front["title"]


def test_it_has_the_sections_and_the_length_that_are_asked_for():
    assert re.findall(r"^# (.*)$", TEXT, re.MULTILINE) == SECTIONS
    assert FEWEST_WORDS <= len(TEXT.split()) <= MOST_WORDS


def test_what_is_cited_is_listed_and_what_is_listed_is_cited():
    listed = pybtex.database.parse_file(str(ROOT / "paper" / "paper.bib")).entries
    assert set(re.findall(r"@(\w+)", TEXT)) == set(listed)
    for key, entry in listed.items():
        assert entry.persons["author"], key
        assert {"doi", "url", "howpublished"} & entry.fields.keys(), key
        if entry.type == "article":
            assert {"journal", "volume", "year", "doi"} <= entry.fields.keys(), key


def test_its_figure_is_that_of_the_results():
    """The journal is given the paper's folder alone, so a copy lies there."""
    (name,) = re.findall(r"!\[[^]]*\]\(([^)]*)\)", TEXT)
    copy, made = ROOT / "paper" / name, RESULTS / "atlas" / name
    assert copy.read_bytes() == made.read_bytes(), f"copy {made.relative_to(ROOT)} to paper/"


def said(pattern):
    """The numbers of the one place of the paper that reads like this."""
    (found,) = re.findall(pattern, " ".join(TEXT.split()))
    numbers = found if isinstance(found, tuple) else (found,)
    return [float(WORDS.get(n, n.replace(" ", "") if isinstance(n, str) else n)) for n in numbers]


def test_the_published_numbers_are_counted_right():
    table = (RESULTS / "edwards2007" / "comparison.md").read_text("utf-8")
    rows = [line for line in table.splitlines() if line.startswith("| ")][1:]
    failed = sum("**not reproduced**" in row for row in rows)
    counts = said(r"parameters, (\w+) of (\w+) published statements come out and (\w+) do not")
    assert counts == [len(rows) - failed, len(rows), failed]
    assert len(sf.LAWS) == 16
    assert "Sixteen published laws" in TEXT


def test_the_populations_are_those_of_the_results():
    springs = (RESULTS / "us-adults" / "us-adults.txt").read_text("utf-8")
    nerves = (RESULTS / "us-adults-feedback" / "us-adults-feedback.txt").read_text("utf-8")
    unstable = re.compile(r"^unstable +([\d.]+) %", re.MULTILINE)
    assert said(r"([\d.]+) % of US adults would not stand") == [float(unstable.search(springs)[1])]
    assert said(r"spread assumed, ([\d.]+) % fall") == [float(unstable.search(nerves)[1])]
    (row,) = re.findall(r"^  all .*$", nerves.partition("99 %\n")[2], re.MULTILINE)
    half, ninety, _, most = map(float, re.findall(r"([\d.]+) \[", row))
    delays = said(r"delays of ([\d.]+), ([\d.]+) and ([\d.]+) s are borne by 99, 90 and 50 %")
    assert delays == [most, ninety, half]


def test_a_million_persons_were_checked():
    text = (RESULTS / "feedback" / "million.md").read_text("utf-8")
    assert "feedback_check.py 1000000" in text
    assert "0 of 1000000 persons are marked uncertain" in text
    assert "So neither is wrong" in text  # of the two that were counted as wrong at first


BENCHMARKS = (RESULTS / "benchmarks" / "README.md").read_text("utf-8")
# What the paper says, and the row and the column of the benchmarks that it is read from.
MEASURED = {
    r"about (\d+) times the rate of batched": ("three eigenvalues against batched eigvalsh", 2),
    r"judged about (\d+) random three-joint persons": ("loop of tdcpy, one delay", 1),
    r"spectral collocation about (\d+), with": ("loop of collocation, 10 nodes, one delay", 1),
    r"judges about (\d+ 000), with proof": ("three joints: verdict at one delay", 1),
    r"about (\d+ 000) points a second for the first two": ("xyzpy, a call a point", 1),
}


@pytest.mark.parametrize("words", MEASURED)
def test_speeds_are_those_of_the_benchmarks(words):
    name, column = MEASURED[words]
    (row,) = re.findall(rf"^\| {re.escape(name)} \|.*$", BENCHMARKS, re.MULTILINE)
    found = float(re.search(r"[\d.]+(e[+]\d+)?", row.split("|")[column + 1])[0])
    assert said(words) == [pytest.approx(found, rel=OF_A_BENCHMARK)]
