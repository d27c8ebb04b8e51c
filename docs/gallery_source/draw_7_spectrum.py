"""
Spectrum of sway
================

What white noise of the torques makes of a person who stands by a published law of feedback: spectra
of the rotations, of the centre of mass and of the centre of pressure.
"""

import numpy as np

import standfast as sf

law = sf.LAWS["wang-fpd-det"]
frequency = np.geomspace(0.02, 10, 300)  # Hz
spectrum = sf.sway_spectrum(**law.person, frequency=frequency)
sf.plot.sway_spectrum(spectrum)
