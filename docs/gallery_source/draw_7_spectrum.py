"""
Spectrum of sway
================

What white noise of the torques makes of a person who stands by a published law of feedback:
spectra of the centre of pressure and of the centre of mass.
"""

import matplotlib.pyplot as plt
import numpy as np

import standfast as sf

frequency = np.geomspace(0.02, 10, 300)  # Hz
fig, ax = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
for name, style in (("pasma-2017", "-"), ("dec-2015", "--")):
    spectrum = sf.sway_spectrum(**sf.LAWS[name].person, frequency=frequency)
    ax.loglog(frequency, 1e6 * spectrum.cop, style, color="black", label=f"{name}: pressure")
    ax.loglog(frequency, 1e6 * spectrum.com, style, color="0.6", label=f"{name}: mass")
ax.set(
    xlabel="Frequency (Hz)",
    ylabel="Power spectral density (mm²/Hz)",
    title="Noise of 1 N·m·√s at each free joint",
)
ax.legend(frameon=False)
