"""The figures of the study of sway, at the widths of a journal; ``sway_study.py`` is the script."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from standfast.figures.style import BLUE, GREY, LINE_STYLES, PAGE, VERMILION, paper_figure, save

BAND = "0.85"
PANELS = (
    ("knee (degrees)", "SD of the knee (degrees)"),
    ("hip (degrees)", "SD of the hip (degrees)"),
    ("CoP (mm)", "SD of the CoP, AP (mm)"),
    ("CoM / CoP", "SD of the CoM / SD of the CoP"),
    ("frequency (Hz)", "mean frequency of the CoP (Hz)"),
    ("velocity (mm/s)", "mean velocity of the CoP (mm/s)"),
)
LOOKS = {"control": ("o", BLUE, BLUE), "total": ("s", "none", VERMILION)}
SAID = {"control": "CoP of the control moments", "total": "CoP of the total moment"}
OUT_OF_RANGE = "pasma-2017"  # hardly anybody's frequency comes out: drawn hollow
SHOWN = (
    "pasma-2017",
    "independent-channel-0.5deg",
    "dec-2015",
    "wang-fpd-sto3",
    "opty-park-2004",
    "lqr-edwards2007",
)


def draw_measures(
    stem: Path,
    rows: Sequence[Mapping[str, Any]],
    joints: Mapping[str, tuple[float, float, float]],
    measured: Mapping[str, tuple[float, float, float]],
) -> None:
    """Draw every law's measures beside the quartiles of the young, noise at all joints."""
    rows = [row for row in rows if row["noise at"] == "all"]
    laws = list(dict.fromkeys(row["law"] for row in rows))
    norms = {**joints, **measured}
    with paper_figure(PAGE, 5.6, (2, 3)) as (figure, axes):
        for ax, (name, label) in zip(axes, PANELS, strict=True):
            low, middle, high = norms[name]
            ax.axvspan(low, high, color=BAND, lw=0, label="people, quartiles")
            ax.axvline(middle, color=GREY, lw=1.0, label="people, median")
            for definition, (marker, face, edge) in LOOKS.items():
                if definition == "total" and "degrees" in name:
                    continue
                some = [r for r in rows if r["definition"] == definition and r[name] > 0.0]
                x = [row[name] for row in some]
                y = [laws.index(row["law"]) for row in some]
                look = {"marker": marker, "mfc": face, "mec": edge, "ms": 4.5, "ls": ""}
                ax.plot(x, y, **look, label=SAID[definition])
            if "degrees" in name:
                ax.set_xlim(left=0.0)
            else:
                ax.set_xscale("log")
                ticks = _ticks(*ax.get_xlim())
                ax.set_xticks(ticks, [f"{t:g}" for t in ticks])
                ax.set_xticks([], minor=True)
            ax.set_yticks(range(len(laws)), laws if ax in {axes[0], axes[3]} else [])
            ax.set_ylim(len(laws) - 0.5, -0.5)
            ax.grid(axis="y", lw=0.3, color="0.9")
            ax.set_axisbelow(True)
            ax.set_xlabel(label)
        handles, words = axes[-1].get_legend_handles_labels()
        figure.legend(handles, words, loc="outside upper center", ncols=4, frameon=False)
        save(figure, stem, ("png",))


def draw_spectra(
    stem: Path,
    hertz: np.ndarray,
    people: np.ndarray,
    spectra: Mapping[tuple[str, str, str], np.ndarray],
    shown: np.ndarray,
) -> None:
    """Draw spectra of the CoP by both definitions over the quartiles of the recordings."""
    with paper_figure(PAGE, 3.4, (1, 2), shared=True) as (figure, axes):
        for ax, definition, letter in zip(axes, SAID, "ab", strict=True):
            low, middle, high = 1e6 * people
            ax.fill_between(hertz, low, high, color=BAND, lw=0, label="people, quartiles")
            ax.plot(hertz, middle, color="black", lw=2.0, label="people, median", zorder=3)
            colors = ("#0072B2", "#56B4E9", "#009E73", "#E69F00", "#D55E00", "#7A2E5D")
            for law, color, line in zip(SHOWN, colors, LINE_STYLES, strict=True):
                density = 1e6 * spectra[law, "all", definition][shown]
                ax.plot(hertz, density, color=color, ls=line, lw=1.1, label=law)
            ax.set_xscale("log")
            ax.set_yscale("log")
            ax.set_ylim(1e-4, 1e3)
            ax.set_xticks([0.03, 0.1, 0.3, 1, 3, 10], ["0.03", "0.1", "0.3", "1", "3", "10"])
            ax.set_xticks([], minor=True)
            ax.set_xlim(hertz[0], 10.0)
            ax.set_xlabel("frequency (Hz)")
            ax.set_title(f"{letter}  {SAID[definition]}", loc="left")
        axes[0].set_ylabel("density of the CoP, AP (mm²/Hz)")
        handles, words = axes[0].get_legend_handles_labels()
        figure.legend(handles, words, loc="outside right center", frameon=False, handlelength=2.6)
        save(figure, stem, ("png",))


def draw_falls(stem: Path, falls: Sequence[Mapping[str, Any]]) -> None:
    """Draw the AUC of every predictor with its interval, a panel a group.

    The delay margin ranks as the critical delay, and is left out.
    """
    falls = [row for row in falls if "delay margin" not in row["predictor"]]
    names = list(dict.fromkeys(row["predictor"] for row in falls))
    ours = [name for name in names if "," in name]
    names = [*ours, *(name for name in names if name not in ours)]
    groups = list(dict.fromkeys(row["group"] for row in falls))
    with paper_figure(PAGE, 3.2, (1, 3)) as (figure, axes):
        for ax, group in zip(axes, groups, strict=True):
            some = {row["predictor"]: row for row in falls if row["group"] == group}
            for y, name in enumerate(names):
                row = some[name]
                color, marker = (BLUE, "o") if name in ours else (VERMILION, "s")
                ax.plot([row["low"], row["high"]], [y, y], color=color, lw=1.0)
                face = "white" if name.split(", ")[1:2] == [OUT_OF_RANGE] else color
                ax.plot(row["AUC"], y, marker, color=color, mfc=face, ms=4)
            ax.axvline(0.5, color=GREY, lw=0.8, ls="--")
            ax.set_xlim(0.2, 0.9)
            ax.set_ylim(len(names) - 0.5, -0.5)
            ax.set_yticks(range(len(names)), names if ax is axes[0] else [])
            first = some[names[0]]
            ax.set_title(f"{group}: {first['fell']} of {first['people']} fell", loc="left")
            ax.set_xlabel("area under the ROC curve")
        save(figure, stem, ("png",))


def _ticks(low: float, high: float) -> list[float]:
    digits = (1, 3) if high > 12.0 * low else (1, 2, 3, 5)
    every = [digit * 10.0**power for power in range(-3, 4) for digit in digits]
    return [tick for tick in every if low <= tick <= high]
