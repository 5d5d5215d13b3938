"""Measured data in, calibrated bands and measured-versus-model verdicts out."""

from stepwell.lab.bands.band import BandTest, band_test, hysteresis, stiffness, stiffness_by_window
from stepwell.lab.bands.band_fit import BandFit, fit_bands
from stepwell.lab.bands.choice import Candidate, Choice, choose_law
from stepwell.lab.bands.halves import Estimate, Hysteresis
from stepwell.lab.bands.laws import LAWS, Fitted, ForceLaw, fit
from stepwell.lab.builds import Observed, Pull, WrongHole, pulls_of
from stepwell.lab.calibration import Calibration, Correlated, FittedParameter, calibrate
from stepwell.lab.cell_test import RISE, CellReading, CellTest, Rise
from stepwell.lab.chain_test import ChainTest, SnapComparison, require_travel
from stepwell.lab.comparison import Comparison, Refit, compare, refit
from stepwell.lab.copy_test import CopyNumber, CopyTest, CopyVerdict, copy_test
from stepwell.lab.first_build import (
    FIRST_BUILD,
    WRONG_HOLE,
    AnchorMove,
    AsBuilt,
    Move,
    ParameterEstimate,
    as_built,
)
from stepwell.lab.fit_model import SnapPrediction
from stepwell.lab.fit_samples import Prepared, Sample, Weighing, prepare
from stepwell.lab.measured_element import MeasuredElement, measure_element
from stepwell.lab.pair_test import PairTest
from stepwell.lab.recordings.curve import Curve, MeasuredCurve, mean_curve, read_curve
from stepwell.lab.recordings.read import (
    SAMPLE,
    Batch,
    hashes,
    list_columns,
    read,
    read_all,
    read_bytes,
    read_every,
    table,
    to_csv,
)
from stepwell.lab.recordings.reading import FILE as READING_FILE, Reading, save as save_reading
from stepwell.lab.recordings.recording import LabError, Recording
from stepwell.lab.recordings.recording_warnings import batch_warnings, recording_warnings
from stepwell.lab.rig import NOT_JUDGED, PAPER_RIG, Rig
from stepwell.lab.series import Series, Sorted, sort_series
from stepwell.lab.snaps import HalfCycle, MeasuredSnap, find_snaps, half_cycles
from stepwell.lab.tables import band_table, calibrated_table, tension_tables

__all__ = [
    "AsBuilt",
    "BandFit",
    "BandTest",
    "Batch",
    "Calibration",
    "Candidate",
    "CellReading",
    "CellTest",
    "ChainTest",
    "Choice",
    "Comparison",
    "CopyNumber",
    "CopyTest",
    "CopyVerdict",
    "Correlated",
    "Curve",
    "Estimate",
    "FIRST_BUILD",
    "Fitted",
    "FittedParameter",
    "ForceLaw",
    "HalfCycle",
    "Hysteresis",
    "LAWS",
    "LabError",
    "MeasuredCurve",
    "MeasuredElement",
    "MeasuredSnap",
    "Move",
    "NOT_JUDGED",
    "Observed",
    "PAPER_RIG",
    "PairTest",
    "ParameterEstimate",
    "Prepared",
    "Pull",
    "READING_FILE",
    "RISE",
    "Reading",
    "Recording",
    "Refit",
    "Rig",
    "Rise",
    "Sample",
    "Series",
    "SAMPLE",
    "SnapComparison",
    "SnapPrediction",
    "Sorted",
    "AnchorMove",
    "WRONG_HOLE",
    "Weighing",
    "WrongHole",
    "as_built",
    "band_table",
    "band_test",
    "batch_warnings",
    "calibrate",
    "calibrated_table",
    "choose_law",
    "compare",
    "copy_test",
    "find_snaps",
    "fit",
    "fit_bands",
    "half_cycles",
    "hashes",
    "hysteresis",
    "list_columns",
    "mean_curve",
    "measure_element",
    "recording_warnings",
    "prepare",
    "pulls_of",
    "read",
    "read_all",
    "read_bytes",
    "read_curve",
    "read_every",
    "refit",
    "require_travel",
    "save_reading",
    "sort_series",
    "stiffness",
    "stiffness_by_window",
    "table",
    "tension_tables",
    "to_csv",
]
