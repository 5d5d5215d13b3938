"""Cells and pairs on the test machine beside their model."""

from stepwell.lab.mechanisms.calibrate import (
    Calibration,
    FittedParameter,
    Sample,
    calibrate,
    fit_record,
    prepare,
)
from stepwell.lab.mechanisms.cell_test import CellReading, CellTest
from stepwell.lab.mechanisms.compare import Comparison, compare, comparison_record
from stepwell.lab.mechanisms.pair_test import PairTest
from stepwell.lab.mechanisms.refit import Refit, refit
from stepwell.lab.mechanisms.rig import PAPER_RIG, Rig
from stepwell.lab.mechanisms.schema import CELL_TEST, ERROR, PAIR_TEST, PARAMETER
from stepwell.lab.mechanisms.series import Series, Sorted, sort_series
from stepwell.lab.mechanisms.snaps import MeasuredSnap, find_snaps
from stepwell.lab.mechanisms.table import calibrated_table
