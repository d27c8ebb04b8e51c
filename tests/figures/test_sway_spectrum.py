"""The figure of a person's spectra of sway: what is drawn, in which units, and what is refused."""

import math

import numpy as np
import pytest
from matplotlib.figure import Figure

import standfast as sf
from standfast.cli.app import main

HERTZ = np.geomspace(1e-3, 30.0, 4001)
PERSON = (
    "person --height 1.66 --mass 68 --ankle 900 --knee 1500 --hip inf"
    " --damping ankle=30,knee=20 --noise ankle=1"
)


def person():
    body = sf.Body.from_height_mass(1.66, 68.0, "winter")
    return {
        "body": body, "stiffness": sf.Stiffness(900.0, 1500.0, math.inf),
        "damping": (30.0, 20.0, 0.0), "noise": (1.0, 0.0, 0.0),
    }  # fmt: skip


def drawn(spectrum, **how):
    axes = Figure().subplots(1, 2)
    sf.plot.sway_spectrum(spectrum, axes=axes, **how)
    return [{line.get_label(): line.get_xydata().T for line in ax.lines} for ax in axes]


def test_areas_below_the_curves_are_the_variances_in_degrees_and_millimetres():
    rotations, centres = drawn(sf.sway_spectrum(**person(), frequency=HERTZ))
    assert set(rotations) == {"ankle", "knee"}  # the hip is rigid
    variances = np.diag(sf.sway_covariance(**person()))
    for joint, variance in zip(("ankle", "knee"), variances, strict=False):
        area = np.trapezoid(*rotations[joint][::-1])
        # below 1 mHz little is left
        assert area == pytest.approx(math.degrees(math.degrees(variance)), rel=0.01)
    assert set(centres) == {"CoM", "CoP"}
    spectrum = sf.sway_spectrum(**person(), frequency=HERTZ[2000])
    for name, density in (("CoM", spectrum.com), ("CoP", spectrum.cop)):
        np.testing.assert_allclose(centres[name][:, 2000], [HERTZ[2000], 1e6 * density[0]], 1e-9)


def test_axes_have_units_and_curves_differ_without_colour():
    axes = Figure().subplots(1, 2)
    spectrum = sf.sway_spectrum(**person() | {"noise": (1, 1, 1)}, frequency=HERTZ)
    assert sf.plot.sway_spectrum(spectrum, axes=axes) is axes
    for ax, unit in zip(axes, ("°²/Hz", "mm²/Hz"), strict=True):
        assert unit in ax.get_ylabel()
        assert ax.get_xlabel() == "Frequency (Hz)"
        assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
        styles = [line.get_linestyle() for line in ax.lines]
        assert len(set(styles)) == len(styles) == 2


@pytest.mark.parametrize(("change", "words"), [
    ({"spectrum": None}, "sf.sway_spectrum returns"),
    ({"frequency": [1.0]}, "two or more frequencies"),
    ({"noise": (0.0, 0.0, 0.0)}, "nothing in this spectrum sways"),
    ({"axes": Figure().subplots()}, "two axes"),
])  # fmt: skip
def test_what_is_no_spectrum_is_one_sentence(change, words):
    noise, frequency = change.get("noise", (1, 0, 0)), change.get("frequency", HERTZ)
    found = sf.sway_spectrum(**person() | {"noise": noise}, frequency=frequency)
    with pytest.raises(sf.InputError, match=words):
        sf.plot.sway_spectrum(change.get("spectrum", found), axes=change.get("axes"))


@pytest.mark.parametrize(("options", "spectra"), [
    ("", True),
    (" --ankle 100", False),  # falls
    (" --damping ankle=0,knee=0", False),  # moved ever more
    (" --noise ankle=0", False),
])  # fmt: skip
def test_the_command_draws_spectra_of_whom_noise_sways(tmp_path, monkeypatch, options, spectra):
    told = []

    def remembered(spectrum, **how):
        told.append(spectrum)
        return sf.plot.sway_spectrum(spectrum, **how)

    monkeypatch.setattr("standfast.figures.person.sway_spectrum", remembered)
    assert main([*(PERSON + options).split(), "-o", str(tmp_path / "person.png")]) == 0
    assert bool(told) == spectra
    assert (tmp_path / "person.png").stat().st_size > 10_000
