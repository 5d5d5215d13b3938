"""One model of rubber and rig fitted to everything that recordings of cells show."""

from stepwell.lab.calibration.calibrate import (
    Calibration,
    FittedParameter,
    calibrate,
)
from stepwell.lab.calibration.predict import SnapPrediction
from stepwell.lab.calibration.samples import Prepared, Sample, Weighing, prepare
from stepwell.lab.calibration.schema import ERROR, PARAMETER, SNAP, fit_record
from stepwell.lab.calibration.table import calibrated_table
from stepwell.lab.calibration.tables import tension_tables
