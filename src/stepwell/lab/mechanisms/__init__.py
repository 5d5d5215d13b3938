"""Cells and pairs on the test machine beside their model."""

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
from stepwell.lab.mechanisms.schema import CELL_TEST, ERROR, PAIR_TEST, PARAMETER
from stepwell.lab.mechanisms.series import Series, Sorted, sort_series
from stepwell.lab.mechanisms.snaps import Snap, find_snaps
from stepwell.lab.mechanisms.table import calibrated_table

__all__ = [
    "CELL_TEST",
    "ERROR",
    "PAIR_TEST",
    "PAPER_RIG",
    "PARAMETER",
    "Calibration",
    "CellTest",
    "Comparison",
    "PairTest",
    "Parameter",
    "Reading",
    "Rig",
    "Sample",
    "Series",
    "Snap",
    "Sorted",
    "calibrate",
    "calibrated_table",
    "compare",
    "comparison_record",
    "find_snaps",
    "fit_record",
    "prepare",
    "sort_series",
]
