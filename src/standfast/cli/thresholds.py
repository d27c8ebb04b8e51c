"""``standfast thresholds``: limits of standing of a study or of an atlas."""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import add_command, add_folder_option, made_folder
from standfast.study.study import Study

if TYPE_CHECKING:
    from standfast.thresholds.contours import Contour
    from standfast.thresholds.regions import Region

MOST_LINES = 20


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _thresholds,
        "limits of standing: exact curves over ankle and hip of a study, contours of an atlas",
        "thresholds atlas.h5 -o results",
    )
    parser.add_argument("source", type=Path, metavar="FILE.h5|STUDY.toml")
    add_folder_option(parser)


def _thresholds(options: argparse.Namespace) -> None:
    from standfast.thresholds import contours, regions, tables

    source: Path = options.source
    folder = made_folder(options.output)
    lines: list[str] = []
    found: Iterator[Contour | Region]
    if source.suffix == ".toml":
        study = Study.from_toml(source)
        found = contours.exact_contours(study)
    else:
        from standfast.atlas.opening import open_atlas

        atlas = open_atlas(source)
        study = atlas.study
        if study.has_gains:
            lines.append(
                f"contours of {regions.source_of(atlas)} over "
                f"{' and '.join(regions.plane_of(study))}, plane by plane:"
            )
            found = _counted(regions.regions(atlas), lines)
        else:
            lines.append(f"contours of {contours.source_of(atlas)[0]}, plane by plane:")
            found = _described(contours.extracted_contours(atlas), lines)
    # the files first: whoever reads what is printed may have seen enough after one line
    written = tables.write_tables(study, found, folder / f"{source.stem}-thresholds")
    for line in lines:
        print(line)
    print(f"Written to {folder}: {', '.join(path.name for path in written)}")


def _described(found: Iterator["Contour"], lines: list[str]) -> Iterator["Contour"]:
    """Hand contours on; add to ``lines`` how far the first ones lie from the closed form."""
    greatest, count = 0.0, 0
    for count, contour in enumerate(found, start=1):
        far = "no limit of standing on it"
        if contour.lines:
            greatest = max(greatest, contour.greatest)
            far = (
                f"distance from closed form at most {contour.greatest:.3g}, mean "
                f"{contour.mean:.3g} N·m/rad (step of the grid {contour.resolution:.3g})"
            )
        if count <= MOST_LINES:
            where = ", ".join(f"{key} {value}" for key, value in contour.plane.values.items())
            lines.append(f"  {where or 'the plane'}: {far}")
        yield contour
    if count > MOST_LINES:
        lines.append(f"  … {count} planes in all, distance at most {greatest:.3g} N·m/rad")


def _counted(found: Iterator["Region"], lines: list[str]) -> Iterator["Region"]:
    """Hand regions on; add to ``lines`` how much of the first ones stands, and within how many."""
    count = 0
    for count, region in enumerate(found, start=1):
        if count <= MOST_LINES:
            where = ", ".join(f"{key} {value}" for key, value in region.values.items())
            share = f"{region.stands.sum():,} of {region.stands.size:,} points stand"
            lines.append(f"  {where or 'the plane'}: {share}, {_limits(region)}")
        yield region
    if count > MOST_LINES:
        lines.append(f"  … {count} planes in all")


def _limits(region: "Region") -> str:
    count = len(region.lines)
    return "no limit among them" if not count else f"{count} line{'s' if count > 1 else ''}"
