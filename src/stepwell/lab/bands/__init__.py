"""Tension tests of bands, the laws they follow, and the bands they become."""

from stepwell.lab.bands.band import (
    BandTest,
    band_test,
    hysteresis,
    stiffness,
    stiffness_by_window,
)
from stepwell.lab.bands.choice import Candidate, Choice, choose_law
from stepwell.lab.bands.halves import Hysteresis
from stepwell.lab.bands.laws import LAWS, Fitted, ForceLaw, fit
from stepwell.lab.bands.record import band_record
from stepwell.lab.bands.spread import Estimate, student
from stepwell.lab.bands.table import band_line, band_table
