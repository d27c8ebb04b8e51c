"""The figure of a recording: the path of the centre of pressure, course in time, spectra."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from standfast.figures.style import BLUE, GREY, PAGE, VERMILION, paper_figure, save
from standfast.recordings.expected import ExpectedSway
from standfast.recordings.measures import (
    CopSpectrum,
    SwayMeasures,
    cop_spectrum,
    ellipse_factor,
    filtered,
)
from standfast.recordings.recording import Recording

AP, ML = "anterior-posterior", "mediolateral"
HIGHEST = 10.0  # Hz that are drawn: beyond there is only noise
MOST_POINTS = 4000  # of a curve in print


def statokinesigram(ax: Axes, ap: np.ndarray, ml: np.ndarray) -> None:
    """Draw the path of the centre of pressure about its mean (m) with the 95 % ellipse, in mm."""
    x, y = 1e3 * (ml - ml.mean()), 1e3 * (ap - ap.mean())
    every = max(1, x.size // (4 * MOST_POINTS))
    ax.plot(x[::every], y[::every], color=GREY, linewidth=0.5, label="path")
    size, axes = np.linalg.eigh(np.cov(x, y))
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    circle = np.stack([np.cos(angle), np.sin(angle)])
    ellipse = axes @ (np.sqrt(ellipse_factor(x.size) * size)[:, None] * circle)
    ax.plot(*ellipse, color=VERMILION, linewidth=1.4, label="95 % ellipse")
    reach = 1.08 * max(np.abs(ellipse).max(), np.abs(x).max(), np.abs(y).max())
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    ax.set(xlabel=f"{ML.capitalize()} (mm)", ylabel=f"{AP.capitalize()} (mm)")


def course(ax: Axes, time: np.ndarray, ap: np.ndarray, ml: np.ndarray) -> None:
    """Draw both directions (m) in time (s), one above the other, in mm."""
    every = max(1, time.size // MOST_POINTS)
    x, y = 1e3 * (ml - ml.mean()), 1e3 * (ap - ap.mean())
    apart = 1.1 * (x.max() - y.min())
    for values, color, name in ((y + apart, BLUE, "AP"), (x, VERMILION, "ML")):
        ax.plot(time[::every], values[::every], color=color, linewidth=0.7)
        ax.text(time[-1] * 1.015, values.mean(), name, color=color, va="center", fontsize=7)
    span = (y + apart).max() - x.min()
    length = next(
        step for step in (100, 50, 20, 10, 5, 2, 1, 0.5, 0.2, 0.1, 0.01) if step < span / 4
    )
    start = x.min()
    ax.plot([-0.03 * time[-1]] * 2, [start, start + length], color="black", linewidth=2.0)
    ax.text(
        -0.045 * time[-1], start + 0.5 * length, f"{length:g} mm", rotation=90, ha="right",
        va="center", fontsize=7,
    )  # fmt: skip
    ax.set(xlim=(-0.1 * time[-1], 1.1 * time[-1]), xlabel="Time (s)", yticks=[])
    ax.spines["left"].set_visible(False)


def spectra(
    ax: Axes,
    spectrum: CopSpectrum,
    measures: SwayMeasures,
    model: ExpectedSway | None = None,
) -> None:
    """Draw the spectra of both directions, mm²/Hz, and mean and median frequency of their sum.

    Beside them a model's, anterior-posterior, if any is given.
    """
    drawn = (spectrum.frequency > 0.0) & (spectrum.frequency <= HIGHEST)
    hertz = spectrum.frequency[drawn]
    styles = ((spectrum.ap, BLUE, "-", "AP"), (spectrum.ml, VERMILION, "--", "ML"))
    for density, color, line, name in styles:
        ax.plot(hertz, 1e6 * density[drawn], color=color, linestyle=line, linewidth=0.9, label=name)
    if model is not None:
        ax.plot(
            model.frequency[drawn],
            1e6 * model.density[drawn],
            color="black",
            linestyle=(0, (4, 1.2, 1, 1.2)),
            linewidth=1.6,
            label="AP, model",
        )
    for value, line, name in (
        (measures.mean_frequency, "-", "mean"),
        (measures.median_frequency, ":", "median"),
    ):
        ax.axvline(value, color="black", linestyle=line, linewidth=0.8, label=name, zorder=1)
    ax.set(xscale="log", yscale="log", xlabel="Frequency (Hz)", ylabel="Spectral density (mm²/Hz)")
    ax.legend(loc="lower left", handlelength=1.6, edgecolor="none", framealpha=1.0, borderpad=0.2)


def draw_recording(
    path: Path,
    recording: Recording,
    measures: SwayMeasures,
    low_pass: float | None,
    model: ExpectedSway | None = None,
) -> list[Path]:
    """Draw a recording into a file, and the spectrum of a model beside its own."""
    ap, ml = filtered(recording, low_pass)
    with paper_figure(width=PAGE, height=2.5, panels=(1, 3)) as (figure, (left, middle, right)):
        statokinesigram(left, ap, ml)
        course(middle, recording.time, ap, ml)
        spectra(right, cop_spectrum(recording, low_pass=low_pass), measures, model)
        left.set_title(f"95 % ellipse {1e6 * measures.area:.3g} mm²")
        middle.set_title(f"mean velocity {1e3 * measures.mean_velocity:.3g} mm/s")
        right.set_title(
            f"mean {measures.mean_frequency:.3g} Hz, median {measures.median_frequency:.3g} Hz"
        )
        return save(figure, path.with_suffix(""), (path.suffix[1:],))
