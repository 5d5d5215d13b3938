"""One model of rubber and rig fitted to everything that recordings of cells show."""

from stepwell.lab.calibration.calibrate import (
    Calibration,
    FittedParameter,
    Sample,
    calibrate,
    fit_record,
    prepare,
)
from stepwell.lab.calibration.table import calibrated_table
