"""Spectra of a person's sway: rotations of the joints, centre of mass and of pressure."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from standfast.errors import InputError, shortened
from standfast.figures.style import BLUE, GREEN, VERMILION, new_axes
from standfast.parameters import JOINTS
from standfast.stability.sway.person import Spectrum

DEGREES, MILLI = math.degrees(1.0), 1e3
DECADES = 7.0  # below the highest density that are drawn: what lies lower nobody measures
# Colours that are apart in grey too, and line styles that tell them where there is none.
JOINT_LINES = dict(zip(JOINTS, ((BLUE, "-"), (VERMILION, "--"), (GREEN, ":")), strict=True))
CENTRE_LINES = {"com": ("black", "--", "CoM"), "cop": (BLUE, "-", "CoP")}


def sway_spectrum(spectrum: Spectrum, *, axes: Sequence[Axes] | None = None) -> Sequence[Axes]:
    """Draw the spectra of a person's sway, as :func:`standfast.sway_spectrum` finds them.

    Both axes are logarithmic: one-sided power spectral densities of the rotations (°²/Hz, a rigid
    joint left out) and of centre of mass and of pressure (mm²/Hz) over the frequency (Hz).

    Parameters
    ----------
    spectrum
        at two or more frequencies above 0.
    axes
        two axes to draw into (default: those of a new figure of pyplot).

    Returns
    -------
    The two axes.

    Raises
    ------
    InputError
        if the spectrum is no such one, nothing in it sways, or two axes are not given.

    Examples
    --------
    >>> import standfast as sf
    >>> law = sf.LAWS["pasma-2017"]
    >>> spectrum = sf.sway_spectrum(**law.person, frequency=[0.1, 0.3, 1.0])
    >>> rotations, centres = sf.plot.sway_spectrum(spectrum)
    >>> centres.get_xlabel()
    'Frequency (Hz)'
    """
    if not isinstance(spectrum, Spectrum):
        raise InputError(f"spectrum = {shortened(spectrum)}; give what sf.sway_spectrum returns")
    if np.count_nonzero(spectrum.frequency > 0.0) < 2:
        raise InputError("a figure of a spectrum needs two or more frequencies above 0 Hz")
    if not np.any(spectrum.cop > 0.0):
        raise InputError("nothing in this spectrum sways; noise = 0 at all joints that turn")
    if axes is None:
        axes = new_axes(2)
    given = np.ravel(np.array(axes, dtype=object))
    if len(given) != 2 or not all(isinstance(ax, Axes) for ax in given):
        raise InputError(f"axes = {shortened(axes)}; give two axes, as figure.subplots(1, 2)")
    rotations, centres = given
    for joint, (color, line) in JOINT_LINES.items():
        _draw(rotations, spectrum, getattr(spectrum, joint) * DEGREES**2, color, line, joint)
    for name, (color, line, words) in CENTRE_LINES.items():
        _draw(centres, spectrum, getattr(spectrum, name) * MILLI**2, color, line, words)
    for ax, what, unit in ((rotations, "rotation", "°"), (centres, "sway", "mm")):
        highest = max(float(np.max(line.get_ydata())) for line in ax.lines)
        lowest = min(float(np.min(line.get_ydata())) for line in ax.lines)
        ax.set(xscale="log", yscale="log", xlabel="Frequency (Hz)")
        ax.set_ylabel(f"Spectral density of {what} ({unit}²/Hz)")
        ax.set_ylim(bottom=max(0.5 * lowest, highest * 10.0**-DECADES), top=3.0 * highest)
        ax.legend(loc="lower left", frameon=False, handlelength=2.2)
    return axes


def _draw(
    ax: Axes, spectrum: Spectrum, density: np.ndarray, color: str, line: str, name: str
) -> None:
    """Draw one density over the frequencies, if it is any."""
    drawn = (spectrum.frequency > 0.0) & (density > 0.0)
    if drawn.any():
        ax.plot(
            spectrum.frequency[drawn], density[drawn], color=color, linestyle=line, label=name
        )  # fmt: skip
