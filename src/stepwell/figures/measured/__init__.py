"""Measured data beside their model."""

from stepwell.figures.measured.band_test import band_laws
from stepwell.figures.measured.calibration import calibration
from stepwell.figures.measured.measured import measured_energies, measured_forces, measured_pairs
from stepwell.figures.measured.recording import recording
