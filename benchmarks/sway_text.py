"""The page of the study of sway: what came out, in numbers. ``sway_study.py`` is the script."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

Norms = Mapping[str, tuple[float, float, float]]
Rows = Sequence[Mapping[str, Any]]
COLUMNS = (
    ("knee (degrees)", "knee (°)", ".2f"),
    ("hip (degrees)", "hip (°)", ".2f"),
    ("CoP (mm)", "CoP (mm)", ".1f"),
    ("CoM / CoP", "CoM/CoP", ".2f"),
    ("frequency (Hz)", "frequency (Hz)", ".2f"),
    ("velocity (mm/s)", "velocity (mm/s)", ".1f"),
)
OFF = (("spectrum off (dB)", "as fitted (dB)"), ("its shape off (dB)", "level free (dB)"))


class Recorded(NamedTuple):
    """Measures of the recordings, how many there are of how many people, slopes of their median."""

    norms: Norms
    trials: int
    people: int
    slopes: Sequence[float]


def page(
    rows: Rows,
    norms: Mapping[str, Norms],
    recorded: Recorded,
    falls: Rows,
    out: Mapping[str, int],
    margins: str,
    density: float,
) -> str:
    """Return the page."""
    people = {**norms["Young"], **recorded.norms}
    parts = [
        "# Sway: the model with published gains, and people",
        "Made by `python benchmarks/sway_study.py` (seeded; the environment variable"
        " `STANDFAST_SWAY` names the folder of the data). What is computed, and how it is to be"
        " read: [Sway](../../docs/sway.md).",
        "People: Santos & Duarte, PeerJ 4 (2016) e2648 (163 people) and dos Santos et al., PeerJ 5"
        f" (2017) e3626 (49 people), CC BY 4.0; {recorded.trials} recordings of {recorded.people}"
        " young people. Eyes open, firm ground, 60 s, anterior-posterior (AP) unless it says"
        " otherwise. [Medians and quartiles](norms.csv), [laws](measures.csv),"
        " [spectra](spectra.csv), [falls](falls.csv).",
        "## Published gains",
        "Noise is white and fitted to one number, the young's ankle SD"
        f" ({people['ankle (degrees)'][1]:.3f}°); all else is prediction. **Bold** lies between the"
        " quartiles of the people's trials; – is a rigid joint.",
        laws(rows, people, "control"),
        fitting(rows, people),
        "![Measures of each law beside the quartiles of people](sway-measures.png)",
        "*Noise at all free joints; rigid joints have no mark.*",
        "## Two definitions of the centre of pressure",
        definitions(rows, people, density),
        laws(rows, people, "total"),
        "## Spectra",
        spectra(rows, recorded),
        "![Spectra of the recordings and of the model](sway-spectra.png)",
        "*Six of the laws, noise at all free joints, fitted to the ankle's SD alone.*",
        "## Old and young",
        ages(norms),
        laws_of_old(rows, norms),
        "## Falls",
        fallers(falls, out),
        margins,
        "![Areas under the ROC curve](sway-falls.png)",
        "*With 95 % intervals. Hollow: the law that gives hardly anybody's frequency. The delay"
        " margin ranks as the critical delay.*",
    ]
    return "\n\n".join(parts) + "\n"


def laws(rows: Rows, people: Norms, definition: str) -> str:
    """Return the table of the laws by one definition."""
    heads = ["CoP of the " + definition + " moment", "noise (N·m·√s)"]
    lines = [
        "| " + " | ".join([*heads, *(said for _, said, _ in COLUMNS)]) + " |",
        "|---" * (2 + len(COLUMNS)) + "|",
        "| people, quartiles | | "
        + " | ".join(f"{people[n][0]:{f}}-{people[n][2]:{f}}" for n, _, f in COLUMNS)
        + " |",
        "| people, median | | " + " | ".join(f"{people[n][1]:{f}}" for n, _, f in COLUMNS) + " |",
    ]
    for row in rows:
        if row["definition"] != definition:
            continue
        where = ", noise at the ankle alone" if row["noise at"] == "ankle" else ""
        cells = [_cell(row[name], people[name], how) for name, _, how in COLUMNS]
        noise = f"{row['noise (N·m·√s)']:.2f}"
        lines.append("| " + " | ".join([row["law"] + where, noise, *cells]) + " |")
    return "\n".join(lines)


def fitting(rows: Rows, people: Norms) -> str:
    """Return what fits, counted."""
    some = [r for r in rows if r["noise at"] == "all" and r["definition"] == "control"]
    said = []
    for name, word, _ in COLUMNS:
        asked = [r for r in some if r[name] > 0.0]
        fit = [r["law"] for r in asked if _inside(r[name], people[name])]
        who = f": {', '.join(fit)}" if 0 < len(fit) < len(asked) else ""
        said.append(f"- {word}: {len(fit)} of {len(asked)} laws fit{who}.")
    every = [
        r["law"] for r in some if all(_inside(r[n], people[n]) for n, _, _ in COLUMNS if r[n] > 0.0)
    ]
    said.append(f"- All that a law predicts: {', '.join(every) if every else 'no law'}.")
    return "Noise at all free joints, control moments:\n\n" + "\n".join(said)


def definitions(rows: Rows, people: Norms, density: float) -> str:
    """Return how far apart the definitions are, and which is nearer to people."""
    control, total = ([r for r in rows if r["definition"] == d] for d in ("control", "total"))
    said = []
    for name, word, _ in COLUMNS[2:]:
        ratio = [t[name] / c[name] for c, t in zip(control, total, strict=True)]
        nearer = sum(
            abs(np.log(c[name] / people[name][1])) < abs(np.log(t[name] / people[name][1]))
            for c, t in zip(control, total, strict=True)
        )
        said.append(
            f"- {word}: total over control {np.median(ratio):.2f} (from {min(ratio):.2f} to"
            f" {max(ratio):.2f}); the control moments are nearer to people in {nearer} of"
            f" {len(ratio)} rows."
        )
    for name, word in OFF:
        c, t = (np.median([r[name] for r in each]) for each in (control, total))
        better = sum(a[name] < b[name] for a, b in zip(control, total, strict=True))
        said.append(
            f"- Spectrum from 0.1 to 5 Hz, {word}: mean distance from people's median"
            f" {c:.1f} (control), {t:.1f} (total); control is nearer in {better} of {len(control)}."
        )
    return (
        "Control moments: springs, damping and feedback at the ankle. Total: with the noise of the"
        " instant too, x − (A q̈)₁/(m g). Both through the recordings' low-pass at 10 Hz. The"
        " densities are derived in the script from H alone; the package's agree with them to"
        f" {density:.0e} (all laws; joints, CoM and CoP of the control moments; 1 mHz to 50 Hz)."
        "\n\n" + "\n".join(said)
    )


def spectra(rows: Rows, recorded: Recorded) -> str:
    """Return slopes, and the laws by how far their spectra are from people's."""
    names = [name for name in rows[0] if name.startswith("slope")]
    lines = [
        f"People's median falls as f^{recorded.slopes[0]:.1f} from 0.05 to 0.5 Hz and as"
        f" f^{recorded.slopes[1]:.1f} from 1.5 to 5 Hz. Laws, by the distance of their spectra:",
        "",
        "| law | CoP | as fitted (dB) | level free (dB) | slope, low | slope, high |",
        "|---|---|---|---|---|---|",
    ]
    some = [row for row in rows if row["noise at"] == "all"]
    for row in sorted(some, key=lambda each: each[OFF[0][0]]):
        cells = [f"{row[name]:.1f}" for name in (*(name for name, _ in OFF), *names)]
        lines.append("| " + " | ".join([row["law"], row["definition"], *cells]) + " |")
    return "\n".join(lines)


def ages(norms: Mapping[str, Norms]) -> str:
    """Return medians of old over young."""
    lines = ["| median, published | young | old | old / young |", "|---|---|---|---|"]
    for name, (_, young, _) in norms["Young"].items():
        old = norms["Old"][name][1]
        lines.append(f"| {name} | {young:.3g} | {old:.3g} | {old / young:.2f} |")
    return (
        "Area, velocity and frequency are of both directions. With a law unchanged, more noise"
        " multiplies every SD and the velocity by one number and the area by its square, and leaves"
        " the frequency as it is. The old are not the young with more noise:\n\n" + "\n".join(lines)
    )


def laws_of_old(rows: Rows, norms: Mapping[str, Norms]) -> str:
    """Return what laws with noise for the old's ankle say of the old."""
    old = norms["Old"]
    more = old["ankle (degrees)"][1] / norms["Young"]["ankle (degrees)"][1]
    asked = (("knee (degrees)",) * 2, ("hip (degrees)",) * 2, (
        "frequency (Hz)", "mean frequency (Hz)",
    ))  # fmt: skip
    lines = [
        f"Noise fitted to the ankle of the old ({more:.2f} times that of the young), at all free"
        " joints, control moments. The frequency is the model's AP beside the published one of"
        " both directions; recordings of the old are too few for more (6, of 2 people).",
        "",
        "| law | knee (°) | hip (°) | frequency (Hz) |",
        "|---|---|---|---|",
        "| old people, quartiles | "
        + " | ".join(f"{old[name][0]:.2f}-{old[name][2]:.2f}" for _, name in asked)
        + " |",
    ]
    for row in rows:
        if row["noise at"] == "all" and row["definition"] == "control":
            values = [row[ours] * (more if "deg" in ours else 1.0) for ours, _ in asked]
            cells = [
                _cell(value, old[name], ".2f")
                for value, (_, name) in zip(values, asked, strict=True)
            ]
            lines.append("| " + " | ".join([row["law"], *cells]) + " |")
    return "\n".join(lines)


def fallers(falls: Rows, out: Mapping[str, int]) -> str:
    """Return the areas under the ROC curves."""
    groups = list(dict.fromkeys(row["group"] for row in falls))
    falls = sorted(falls, key=lambda row: "," not in row["predictor"])
    cells: dict[str, list[str]] = {}
    for row in falls:
        said = f"{row['AUC']:.2f} ({row['low']:.2f}-{row['high']:.2f})"
        cells.setdefault(row["predictor"], []).append(said)
    counts = {row["group"]: f"{row['fell']} of {row['people']} fell" for row in falls}
    apart = [r for r in falls if r["low"] > 0.5 or r["high"] < 0.5]
    tail = "; ".join(f"{r['predictor']} ({r['group']}, {r['AUC']:.2f})" for r in apart)
    lines = [
        "Choices were fixed before (`benchmarks/sway_falls.py`, with what was added and when). AUC"
        " with 95 % intervals (DeLong); above 0.5 a small margin, or a large value of what is no"
        " margin, goes with falls.",
        "",
        "Whose mean frequency no value of the fitted number gives, of 163: "
        + "; ".join(f"{name} {count}" for name, count in out.items())
        + ". They are put at the end of the range, where margins hold hardly more than height.",
        "",
        "| | " + " | ".join(f"{group}: {counts[group]}" for group in groups) + " |",
        "|---" * (1 + len(groups)) + "|",
        *("| " + " | ".join([name, *each]) + " |" for name, each in cells.items()),
        "",
        f"Of {len(falls)} intervals {len(apart)} leave 0.5 out{': ' if apart else ''}{tail}; about"
        f" {0.05 * len(falls):.0f} would by chance if they were independent, which they are not.",
    ]
    return "\n".join(lines)


def medians(rows: Sequence[tuple[str, np.ndarray, np.ndarray]], alike: float) -> str:
    """Return medians of safety factor and critical delay of groups."""
    lines = [
        "By dec-2015, fit of the gain; its delay is 0.16 s:",
        "",
        "| group | people | safety factor, median (quartiles) | critical delay, s |",
        "|---|---|---|---|",
    ]
    for group, factor, delay in rows:
        said = [
            "{1:{how}} ({0:{how}}-{2:{how}})".format(*np.percentile(x, [25, 50, 75]), how=how)
            for x, how in ((factor, ".2f"), (delay, ".3f"))
        ]
        lines.append(f"| {group} | {factor.size} | {said[0]} | {said[1]} |")
    lines += [
        "",
        "Among the 163 the critical delay ranks as the mean frequency does, backwards: Spearman's"
        f" ρ = {alike:.2f}. So fitted to one number a margin tells what this number tells; and the"
        " larger the gain, the larger the safety factor and the shorter the critical delay.",
    ]
    return "\n".join(lines)


def _inside(value: float, norm: tuple[float, float, float]) -> bool:
    return norm[0] <= value <= norm[2]


def _cell(value: float, norm: tuple[float, float, float], how: str) -> str:
    if value == 0.0:
        return "–"
    return f"**{value:{how}}**" if _inside(value, norm) else f"{value:{how}}"
