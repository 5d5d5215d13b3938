"""Cells and pairs on the test machine beside their model."""

from stepwell.lab.mechanisms.cell_test import CellReading, CellTest
from stepwell.lab.mechanisms.compare import Comparison, compare, comparison_record
from stepwell.lab.mechanisms.pair_test import PairTest, pair_tests
from stepwell.lab.mechanisms.predict import mover, path_of
from stepwell.lab.mechanisms.refit import TIED, Refit, correlations, refit
from stepwell.lab.mechanisms.rig import PAPER_RIG, Rig
from stepwell.lab.mechanisms.schema import CELL_TEST, PAIR_TEST, RIG
from stepwell.lab.mechanisms.series import (
    TENSION_TEST,
    Geometry,
    Series,
    Sorted,
    counted_bands,
    over_geometries,
    sort_series,
)
from stepwell.lab.mechanisms.snaps import MeasuredSnap, find_snaps
