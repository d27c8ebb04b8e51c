"""``standfast cite``: BibTeX that LaTeX understands, and that says what CITATION.cff says."""

from importlib.resources import files
from pathlib import Path

import pybtex.database
import pytest
import yaml

import standfast
from standfast.cli import cite
from standfast.cli.app import main

FILE = Path(__file__).parents[2] / "CITATION.cff"


def entries(capsys):
    assert main(["cite"]) == 0
    return pybtex.database.parse_string(capsys.readouterr().out, "bibtex").entries


def test_paper_and_software_are_those_of_the_file(capsys):
    found = entries(capsys)
    assert list(found) == ["standfast", "edwards2007"]
    software, paper = found.values()
    content = yaml.safe_load(FILE.read_text("utf-8"))
    assert standfast.__version__ in software.fields["howpublished"]
    assert software.fields["title"] == f"{{{content['title']}}}"
    (author,) = software.persons["author"]
    assert str(author) == f"{{{content['authors'][0]['name']}}}"
    (work,) = content["references"]
    assert paper.type == "article"
    assert paper.fields["journal"] == r"Gait \& Posture"
    assert paper.fields["pages"] == "432--439"
    assert paper.fields["doi"] == work["doi"]
    assert int(paper.fields["year"]) == work["year"]
    (author,) = paper.persons["author"]
    assert (author.last_names, author.first_names) == (["Edwards"], ["W."])


def test_a_paper_of_the_software_and_its_release_come_too(capsys, tmp_path, monkeypatch):
    """What owners will add: authors, a date, an address, a DOI, the journal's paper."""
    content = yaml.safe_load(FILE.read_text("utf-8"))
    content |= {
        "authors": [{"family-names": "Doe", "given-names": "A. & B."}, {"name": "The others"}],
        "date-released": "2027-02-03",
        "repository-code": "https://example.org/a_b",
        "doi": "10.5281/zenodo.1",
        "preferred-citation": {
            "type": "article", "title": "100 % of it", "year": 2027, "journal": "JOSS",
            "authors": content["authors"],
        },
    }  # fmt: skip
    path = tmp_path / "CITATION.cff"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    monkeypatch.setattr(cite, "citation_file", lambda: path)
    software, paper, _ = entries(capsys).values()
    assert software.fields["year"] == "2027"
    assert software.fields["url"] == "https://example.org/a_b"
    assert software.fields["doi"] == "10.5281/zenodo.1"
    assert str(software.persons["author"][0]) == r"Doe, A. \& B."
    assert paper.fields["title"] == r"{100 \% of it}"


def test_works_that_are_no_articles_and_authors_of_every_kind(capsys, tmp_path, monkeypatch):
    content = yaml.safe_load(FILE.read_text("utf-8"))
    work = {"type": "report", "title": "On standing", "year": 2013}
    people = [
        {"family-names": "van den Bogert", "given-names": "Ton"},
        {"name-particle": "van den", "family-names": "Bogert", "given-names": "Ton"},
    ]
    content |= {
        "preferred-citation": {**work, "authors": people},
        "references": [
            {**work, "authors": people[:1]},
            {**work, "year": 2014, "authors": people[1:]},
            {"type": "report", "title": "Undated", "authors": [{"family-names": "Doe"}]},
            {**work, "authors": [{"name": "The Balance Group, Ltd."}]},
        ],
    }
    path = tmp_path / "CITATION.cff"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    monkeypatch.setattr(cite, "citation_file", lambda: path)
    found = entries(capsys)
    keys = ["vandenbogert2013", "vandenbogert2014", "doe", "thebalancegroupltd2013"]
    assert list(found) == ["standfast", "standfast-paper", *keys]
    for key in ("standfast-paper", *keys):
        assert found[key].type == "misc"
        assert "howpublished" not in found[key].fields
    for author in (*found["standfast-paper"].persons["author"], *found[keys[1]].persons["author"]):
        assert (author.prelast_names, author.last_names) == (["van", "den"], ["Bogert"])
    (group,) = found[keys[-1]].persons["author"]
    assert str(group) == "{The Balance Group, Ltd.}"


def test_works_of_one_author_and_year_get_letters(capsys, tmp_path, monkeypatch):
    """BibTeX takes a key once; the second entry would be lost, or the file refused."""
    content = yaml.safe_load(FILE.read_text("utf-8"))
    doe = [{"family-names": "Doe"}]
    works = [("One", 2013), ("Two", 2014), ("Three", 2013), ("Four", 2013)]
    content["references"] += [
        {"type": "report", "title": title, "year": year, "authors": doe} for title, year in works
    ]
    path = tmp_path / "CITATION.cff"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    monkeypatch.setattr(cite, "citation_file", lambda: path)
    found = entries(capsys)
    titles = {key: entry.fields["title"] for key, entry in found.items() if "doe" in key}
    assert titles == {
        "doe2013a": "{One}", "doe2014": "{Two}", "doe2013b": "{Three}", "doe2013c": "{Four}",
    }  # fmt: skip
    assert "edwards2007" in found


def test_the_file_is_one():
    """A wheel has it inside; in a checkout there is none but that of the root."""
    if not FILE.exists():
        pytest.skip("not a checkout")
    assert not (files("standfast") / "CITATION.cff").is_file()
    assert "version" not in yaml.safe_load(FILE.read_text("utf-8"))  # it stands in version.py
