"""Measured data in, calibrated bands and measured-versus-model verdicts out."""

from stepwell.lab.bands.band import (
    BandTest,
    Loop,
    band_test,
    hysteresis,
    stiffness,
    stiffness_by_window,
)
from stepwell.lab.bands.choice import Candidate, Choice, choose_law
from stepwell.lab.bands.laws import LAWS, Fitted, ForceLaw, fit
from stepwell.lab.bands.record import band_record
from stepwell.lab.bands.spread import Estimate
from stepwell.lab.bands.table import band_table
from stepwell.lab.mechanisms.calibrate import (
    Calibration,
    Parameter,
    Sample,
    calibrate,
    fit_record,
    prepare,
)
from stepwell.lab.mechanisms.cell_test import CellTest, Reading
from stepwell.lab.mechanisms.compare import Comparison, compare, comparison_record
from stepwell.lab.mechanisms.pair_test import PairTest
from stepwell.lab.mechanisms.rig import PAPER_RIG, Rig
from stepwell.lab.mechanisms.series import Series, Sorted, sort_series
from stepwell.lab.mechanisms.snaps import Snap, find_snaps
from stepwell.lab.mechanisms.table import calibrated_table
from stepwell.lab.recordings.curve import Curve, mean_curve
from stepwell.lab.recordings.errors import LabError
from stepwell.lab.recordings.oddities import batch_oddities, oddities
from stepwell.lab.recordings.read import Batch, read, read_all
from stepwell.lab.recordings.recording import Recording
from stepwell.lab.recordings.table import hashes, summary, table, table_csv

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
