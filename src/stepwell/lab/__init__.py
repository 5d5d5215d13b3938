"""Measured data in, calibrated bands and measured-versus-model verdicts out."""

from stepwell.lab._errors import LabError
from stepwell.lab._spread import Estimate
from stepwell.lab.band import (
    BandTest,
    Loop,
    band_test,
    hysteresis,
    stiffness,
    stiffness_by_window,
)
from stepwell.lab.band_record import band_record
from stepwell.lab.band_table import band_table
from stepwell.lab.calibrate import Calibration, Parameter, Sample, calibrate, fit_record, prepare
from stepwell.lab.calibrated_table import calibrated_table
from stepwell.lab.cell_test import CellTest, Reading
from stepwell.lab.choose import Candidate, Choice, choose_law
from stepwell.lab.compare import Comparison, compare, comparison_record
from stepwell.lab.curve import Curve, mean_curve
from stepwell.lab.laws import LAWS, Fitted, ForceLaw, fit
from stepwell.lab.odd import batch_oddities, oddities
from stepwell.lab.pair_test import PairTest
from stepwell.lab.read import Batch, read, read_all
from stepwell.lab.recording import Recording
from stepwell.lab.rig import PAPER_RIG, Rig
from stepwell.lab.series import Series, Sorted, sort_series
from stepwell.lab.snaps import Snap, find_snaps
from stepwell.lab.table import hashes, summary, table, table_csv

__all__ = [
    "LAWS",
    "PAPER_RIG",
    "BandTest",
    "Batch",
    "Calibration",
    "Candidate",
    "CellTest",
    "Choice",
    "Comparison",
    "Curve",
    "Estimate",
    "Fitted",
    "ForceLaw",
    "LabError",
    "Loop",
    "PairTest",
    "Parameter",
    "Reading",
    "Recording",
    "Rig",
    "Sample",
    "Series",
    "Snap",
    "Sorted",
    "band_record",
    "band_table",
    "band_test",
    "batch_oddities",
    "calibrate",
    "calibrated_table",
    "choose_law",
    "compare",
    "comparison_record",
    "find_snaps",
    "fit",
    "fit_record",
    "hashes",
    "hysteresis",
    "mean_curve",
    "oddities",
    "prepare",
    "read",
    "read_all",
    "sort_series",
    "stiffness",
    "stiffness_by_window",
    "summary",
    "table",
    "table_csv",
]
