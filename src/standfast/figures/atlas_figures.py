"""Which figures an atlas gets: chosen from its axes and quantities by rule, one file each.

A quantity with two long axes is drawn on the plane of both, others along its longest axis. The
values of other axes are curves or small multiples, named where they are. What draws a panel is what
Python offers as ``standfast.plot``.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from standfast.atlas.reader import Atlas
from standfast.errors import InputError, nearest_name
from standfast.figures import along, limits, maps, marking, pictures, style
from standfast.figures.marking import Subject
from standfast.figures.slicing import slice_of

# Figures that are called by a name that is no quantity's, and by the quantities that they show.
FIGURES = ("limits", "locus")
LIMITS = ("limits", "stable")


def plot(
    atlases: Atlas | Sequence[Atlas],
    folder: Path,
    *,
    quantities: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    at: Mapping[str, Any] | None = None,
    overlay: str | None = None,
    mark: Sequence[Subject] = (),
    progress: Callable[[int, int], None] | None = None,
) -> list[style.Drawing]:
    """Draw an atlas into ``folder``, or the limits of several into one figure.

    On a plane: the limits of standing (one curve a delay or a knee, small multiples over the
    rest), a map of each quantity with the limit of standing, and for ``hip_ankle_ratio`` the
    regions of ankle and hip strategy. Without a plane each quantity along its longest axis; the
    rightmost root as its locus over the delay. ``progress`` is told how many panels are done.

    Raises
    ------
    InputError
        before anything is drawn: for what is not inside, or no figure can show.
    """
    atlases = [atlases] if isinstance(atlases, Atlas) else list(atlases)
    for atlas in atlases:
        _check_names(atlas, quantities)
    names = "-".join(atlas.path.name.removesuffix(".h5") for atlas in atlases)
    cut = slice_of([atlas.study for atlas in atlases], at, "--at")
    request = pictures.Request(atlases, cut, mark, folder / names, formats)
    drawn = list(_pictures_of(request, quantities, overlay))
    if not drawn:
        wanted = " or ".join(quantities or atlases[0].quantities)
        raise InputError(f"{atlases[0].path} has no axis to draw {wanted} along")
    _check_marked(mark, drawn)
    total, done = sum(picture.panels for picture in drawn), 0

    def tick() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, total)

    said = [style.Drawing([], remark) for remark in cut.remarks]
    return [*said, *(picture.draw(tick) for picture in drawn)]


def _check_names(atlas: Atlas, names: Sequence[str]) -> None:
    """Refuse what is neither a quantity inside an atlas nor a figure of its own name."""
    known = [*atlas.quantities, *FIGURES]
    for name in names:
        if name not in known:
            raise InputError(
                f"{atlas.path} has no {name!r}{nearest_name(name, known)} "
                f"(inside: {', '.join(atlas.quantities)}; figures: {', '.join(FIGURES)})"
            )


def _pictures_of(
    request: pictures.Request, quantities: Sequence[str], overlay: str | None
) -> Iterator[pictures.Picture]:
    """Go through the figures that are drawn."""
    atlas, index = request.atlas, request.cut.index
    if len(request.atlases) > 1 and (others := [n for n in quantities if n not in LIMITS]):
        raise InputError(
            f"limits of standing of several files go into one figure, {others[0]} of one alone"
        )
    plan = None
    try:
        plan = limits.plan_of(request.atlases, index, overlay)
    except InputError:
        if overlay is not None or len(request.atlases) > 1 or "limits" in quantities:
            raise
    if plan is not None and (not quantities or set(LIMITS) & set(quantities)):
        yield pictures.limits_picture(request, plan, overlay and plan.along)
    if len(request.atlases) > 1:
        return
    loci = not quantities and along.has_locus(atlas, index)
    if loci or "locus" in quantities:
        yield pictures.locus_picture(request, along.locus_cut(atlas, index))
    for name in [each for each in quantities or atlas if each not in FIGURES]:
        layout = maps.layout_of(atlas, name, index)
        if (name == "stable" and plan) or (name in along.ROOT and loci and layout is None):
            continue  # the limits show it, or the loci
        if layout is not None:
            yield pictures.map_picture(request, name, layout)
        elif (curves := along.cut_of(atlas, name, index)) is not None:
            yield pictures.curves_picture(request, name, curves)


def _check_marked(subjects: Sequence[Subject], drawn: Sequence[pictures.Picture]) -> None:
    """Refuse subjects none of whom any figure can show; of a single one the figures say it."""
    every = list(dict.fromkeys(picture.plane for picture in drawn if picture.plane))
    if subjects and all(marking.missing_axes(one, axes) for one in subjects for axes in every):
        words = ", or ".join(" and ".join(axes) for axes in every)
        needs = f"; a figure here has the axes {words}" if every else "; no figure is a plane"
        raise InputError(f"--mark {subjects[0].called} names no axes of a figure{needs}")
