"""``standfast explore``: the page on which one sees a person stand, sway and fall."""

import argparse
import contextlib
import functools
import os
import secrets
import sys
import tempfile
import threading
import webbrowser
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from standfast.cli.parsing import add_command, pairs_of
from standfast.errors import InputError
from standfast.parameters import OWN_BODY, PARAMETERS, checked_number

if TYPE_CHECKING:
    from standfast.atlas.reader import Atlas
    from standfast.explore.live import Live
    from standfast.study.study import Study

PAIR = "NAME=VALUE, as height=1.75"
HIGHEST_PORT = 65_535
ENDINGS = (".html", ".htm")
BROWSER_SECONDS = 120.0  # after which a browser that has not asked for the page never will
NEEDS = "explore needs {}: pip install 'standfast[explore]'"


def add(commands: Any) -> None:
    """Declare the command."""
    parser = add_command(
        commands,
        _explore,
        "a page in the browser: move a person's numbers, and see them stand, sway and fall",
        "explore --person height=1.66,mass=68,ankle=900",
        compiles=True,
    )
    words = "an atlas, or a study, which is computed as it is looked at (default: a nominal adult)"
    parser.add_argument("source", nargs="?", type=Path, metavar="FILE.h5|STUDY.toml", help=words)
    words = "who is shown at first, as height=1.75,mass=75,ankle=900,knee=inf; repeatable"
    parser.add_argument("--person", action="append", default=[], metavar="NAME=VALUE", help=words)
    words = (
        "a subject on the map, as ankle=900,hip=400 with id=NAME if wanted, or a CSV file of "
        "subjects (columns of parameters and id); repeatable"
    )
    parser.add_argument("--mark", action="append", default=[], metavar="SUBJECT", help=words)
    words = "only this quantity; may be given more than once"
    parser.add_argument("-q", "--quantity", action="append", default=[], metavar="NAME", help=words)
    words = "write the page to a file, which needs neither network nor standfast"
    parser.add_argument("--export", type=Path, metavar="PAGE.html", help=words)
    words = "where the page is served on this machine (default: any port that is free)"
    parser.add_argument("--port", type=_port, default=0, metavar="N", help=words)
    parser.add_argument("--no-browser", action="store_true", help="do not open a browser")


def _port(text: str) -> int:
    if not (text.isascii() and text.isdecimal() and 1 <= int(text) <= HIGHEST_PORT):
        raise argparse.ArgumentTypeError(f"{text!r} is not a port; give 1 to {HIGHEST_PORT}")
    return int(text)


def _explore(options: argparse.Namespace) -> None:
    if options.export is not None and options.export.suffix.lower() not in ENDINGS:
        raise InputError(f"{options.export} is not the name of a page; end it in .html")
    if options.export is not None and not options.export.parent.is_dir():
        raise InputError(f"there is no folder {options.export.parent} for {options.export.name}")
    if options.export is not None and options.port:
        raise InputError("--port is of a page that is served, and --export writes one to a file")
    _require_extra()
    with _source(options.source) as source:
        if options.export is not None:
            _export(options, *source)
        else:
            _serve(options, *source)


def _require_extra() -> None:
    """Refuse in a sentence to go on without what is not installed with standfast alone."""
    try:
        import bokeh  # noqa: F401
        import tornado  # noqa: F401
    except ImportError as error:
        raise InputError(NEEDS.format(error.name)) from None


@contextlib.contextmanager
def _source(path: Path | None) -> "Iterator[tuple[Study, Atlas | None]]":
    """Give the study that is looked at, and its atlas if it is one, open meanwhile."""
    from standfast.explore.content import NOMINAL
    from standfast.study.study import Study

    if path is None or path.suffix == ".toml":
        yield Study.from_dict(NOMINAL) if path is None else Study.from_toml(path), None
    else:
        from standfast.atlas.opening import open_atlas

        with open_atlas(path) as atlas:
            yield atlas.study, atlas


def _person(options: argparse.Namespace) -> dict[str, float | str]:
    """Read and check who is shown at first, by the names that ``plot --at`` takes."""
    from standfast.explore.content import NOMINAL_START
    from standfast.figures.slicing import full_name, value_in

    found = dict(NOMINAL_START) if options.source is None else {}
    for text in options.person:
        for key, words in pairs_of("--person", text, PAIR):
            name = full_name("--person", key)
            value = value_in("--person", name, words)
            if not isinstance(value, str):
                checked_number(f"--person: {name}", value, row=PARAMETERS[name])
            found[name] = value
    return found


def _subjects(texts: list[str]) -> list[dict[str, Any]]:
    if not texts:
        return []
    from standfast.figures.marking import subject, subjects_in

    found = []
    for text in texts:
        if "=" in text and not Path(text).exists():
            pair = "NAME=VALUE, as gravity=1.62"
            found.append(subject("--mark", dict(pairs_of("--mark", text, pair))))
            continue
        several, remark = subjects_in(Path(text))
        found += several
        if remark:
            print(f"standfast: {remark}", file=sys.stderr)
    return [{"label": one.label, "values": dict(one.values)} for one in found]


def _serve(options: argparse.Namespace, study: "Study", atlas: "Atlas | None") -> None:
    from standfast.explore import content, opening, sliders
    from standfast.explore.planes import Planes
    from standfast.explore.served import ADDRESS, Served
    from standfast.explore.server import listening, serve

    stops = None if atlas is None else atlas.axes
    token = secrets.token_urlsafe(24)
    person = _person(options)
    start = sliders.start_of(study, person, stops=stops)
    quantities = content.chosen_quantities(study, options.quantity, live=atlas is None)
    plane = content.plane_of(study, quantities[0], live=atlas is None)
    subjects = _subjects(options.mark)
    own = {name: float(start[name]) for name in OWN_BODY if name in start}
    planes = None if atlas is None else Planes(atlas)

    @functools.cache
    def live() -> "Live":
        """Make the engine ready, which takes a second, when it is first asked for."""
        from standfast.explore.live import Live

        return Live(own)

    @functools.cache
    def page() -> str:
        """Make the page, which takes as long as a browser takes to start."""
        from standfast.explore.page import page_html

        at = start
        if planes is not None and person.keys().isdisjoint(plane):
            at = opening.standing_start(planes, planes.atlas.axes, start, plane)
        elif person.keys().isdisjoint(plane):
            at = opening.standing_start_of_study(study, start, plane, by_springs=False)
        return page_html(
            content.content_of(
                study,
                start=at,
                quantities=quantities,
                stops=stops,
                subjects=subjects,
                token=token,
            )
        )

    served = Served(page, token, live, planes)
    at = listening(options.port)
    address = f"http://{ADDRESS}:{at.getsockname()[1]}/?token={token}"

    def ready() -> None:
        print(f"Open {address}\nCtrl-C ends it", flush=True)
        served.threads["person"].submit(page)
        if not options.no_browser:
            threading.Thread(target=_open, args=(address, served.seen), daemon=True).start()

    try:
        serve(served, at, ready)
    finally:
        if planes is not None:
            planes.close()


def _open(address: str, seen: threading.Event) -> None:
    """Open the browser at a file that leads to an address, and remove it once the page is seen.

    All users of a machine can read with what a browser was started, and the address has the token.
    The file lies in the home folder because packaged browsers may read neither hidden folders nor
    that of temporary files.
    """
    home = Path.home()
    place = home if os.access(home, os.W_OK) else None
    with tempfile.TemporaryDirectory(prefix="standfast-explore-", dir=place) as folder:
        page = Path(folder) / "open.html"
        page.touch(mode=0o600)
        page.write_text(
            f'<!doctype html><meta http-equiv="refresh" content="0; url={address}">'
            f'<title>standfast</title><a href="{address}">standfast explore</a>',
            encoding="utf-8",
        )
        webbrowser.open(page.as_uri())
        seen.wait(BROWSER_SECONDS)


def _export(options: argparse.Namespace, study: "Study", atlas: "Atlas | None") -> None:
    from standfast.explore import content, embedding, opening, sliders
    from standfast.explore.page import BEGINNING, page_html
    from standfast.explore.planes import Planes
    from standfast.files import in_bytes, require_replaceable, whole_file

    path: Path = options.export
    require_replaceable(path, BEGINNING, "page")
    quantities = content.chosen_quantities(study, options.quantity, live=atlas is None)
    person = _person(options)
    stops, embedded, note = None, None, ""
    if atlas is not None:
        plane = content.plane_of(study, quantities[0], live=False)
        most = embedding.EMBEDDED_BYTES
        start = sliders.start_of(study, person, stops=atlas.axes)
        places = embedding.thinned(study, quantities, plane, most, start=start)
        stops = {name: axis[places[name]] for name, axis in atlas.axes.items()}
        start = sliders.start_of(study, person, stops=stops)
        with contextlib.closing(Planes(atlas)) as planes:
            embedded = embedding.embedded(planes, quantities, plane, places)
            if person.keys().isdisjoint(plane):
                start = opening.standing_start(planes, stops, start, plane)
        note = opening.thinned_words(study, places, in_bytes(most))
    else:
        start = sliders.start_of(study, person)
        by_springs = opening.is_of_springs_alone(study)
        if by_springs:
            note = opening.SPRINGS_ALONE
            quantities = quantities if options.quantity else opening.springs_first(quantities)
        plane = content.plane_of(study, quantities[0], live=True)
        if person.keys().isdisjoint(plane):
            start = opening.standing_start_of_study(study, start, plane, by_springs=by_springs)
    told = content.content_of(
        study,
        start=start,
        quantities=quantities,
        stops=stops,
        embedded=embedded,
        subjects=_subjects(options.mark),
        notes=[note] if note else [],
    )
    text = page_html(told)
    with whole_file(path) as partial:
        partial.write_text(text, encoding="utf-8")
    print(f"Written: {path} ({in_bytes(path.stat().st_size)}), which opens in any browser.")
    if note:
        print(f"standfast: {note}", file=sys.stderr)
