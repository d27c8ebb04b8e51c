"""Several files of people: joined by id, and what ids are there twice."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from standfast.errors import InputError
from standfast.population.people.csv_table import Table

MOST_TOLD = 5  # of repeated ids


class More(NamedTuple):
    """What a file that only adds columns has under an id: recognised entries, and its own."""

    row: Mapping[str, str]
    own: Mapping[str, str]
    refused: str  # what of it can be read in two ways


def plain_id(entry: str) -> str:
    """Return an id as text; 93703.0 and 93703 are one person."""
    return entry.removesuffix(".0")


def added_by_id(tables: Sequence[Table], holders: Sequence[Table]) -> list[dict[str, More]]:
    """Return the rows, by id, of the files that only add columns."""
    others = [table for table in tables if table not in holders]
    if not holders or not others:
        return []
    ids = set()
    for table in tables:
        if "id" not in table.columns:
            raise InputError(
                f"{', '.join(t.name for t in tables)} cannot be joined: {table.name} has no column "
                "of ids (id, subject, SEQN)"
            )
        if table in holders:
            ids |= {plain_id(row["id"]) for _, row in table.rows}
    added = []
    for table in others:
        rows: dict[str, More] = {}
        owns = table.own or [()] * len(table.rows)
        for (line, row), own in zip(table.rows, owns, strict=True):
            if (key := plain_id(row["id"])) in rows:
                raise InputError(f"{table.name}, line {line}: the id {row['id']!r} is there twice")
            named = dict(zip(table.own_names, own, strict=True))
            why = table.refused.get(line)
            rows[key] = More(row, named, f"{table.name}, line {line}: {why}" if why else "")
        if not ids & set(rows):
            raise InputError(f"{table.name} has no id that {holders[0].name} has")
        added.append(rows)
    return added


def joined(
    row: Mapping[str, str], own: Mapping[str, str], added: Sequence[Mapping[str, More]]
) -> More:
    """Return a row with what files of more columns have under its id; its own entries prevail."""
    fields, columns, refused = dict(row), dict(own), ""
    key = plain_id(row.get("id", ""))
    for rows in added:
        if key and (more := rows.get(key)) is not None:
            told = {name: entry for name, entry in fields.items() if entry}
            fields = {**fields, **more.row, **told}
            columns = {**more.own, **columns}
            refused = refused or more.refused
    return More(fields, columns, refused)


def own_names(holders: Sequence[Table], tables: Sequence[Table]) -> list[str]:
    """Return the names of all columns that are not recognised, those of persons' files first."""
    ordered = [*holders, *(table for table in tables if table not in holders)]
    return list(dict.fromkeys(name for table in ordered for name in table.own_names))


def repeated_ids(table: Table) -> list[str]:
    """Say which ids are there more than once, and on which lines."""
    if "id" not in table.columns:
        return []
    lines: dict[str, list[int]] = {}
    for line, row in table.rows:
        if key := plain_id(row["id"]):
            lines.setdefault(key, []).append(line)
    repeated = {key: places for key, places in lines.items() if len(places) > 1}
    if not repeated:
        return []
    count = f"{len(repeated):,} ids are" if len(repeated) > 1 else "one id is"
    words = f"{count} there more than once, each row taken as a person: {on_lines(repeated)}"
    return [f"{table.name}: {words}"]


def ids_of_several_files(holders: Sequence[Table]) -> list[str]:
    """Say which ids stand in more than one file of persons."""
    files: dict[str, list[str]] = {}
    for table in holders:
        if "id" in table.columns:
            for key in dict.fromkeys(plain_id(row["id"]) for _, row in table.rows):
                files.setdefault(key, []).append(table.name)
    several = {key: names for key, names in files.items() if key and len(names) > 1}
    if not several:
        return []
    told = [f"{key!r} in {', '.join(names)}" for key, names in list(several.items())[:MOST_TOLD]]
    more = f", and {len(several) - MOST_TOLD:,} more" if len(several) > MOST_TOLD else ""
    count = f"{len(several):,} ids are" if len(several) > 1 else "one id is"
    return [f"{count} in several files, each row taken as a person: {'; '.join(told)}{more}"]


def on_lines(places: Mapping[str, Sequence[int]]) -> str:
    """Return the first of some entries, each with the first of the lines that it stands on."""
    told = [
        f"{entry!r} on line{'s' * (len(lines) > 1)} {', '.join(map(str, lines[:MOST_TOLD]))}"
        + (", …" if len(lines) > MOST_TOLD else "")
        for entry, lines in list(places.items())[:MOST_TOLD]
    ]
    more = f", and {len(places) - MOST_TOLD:,} more" if len(places) > MOST_TOLD else ""
    return f"{'; '.join(told)}{more}"
