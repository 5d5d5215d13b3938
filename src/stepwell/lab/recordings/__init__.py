"""Recordings of test machines: read, named, looked at for oddities, averaged."""

from stepwell.lab.recordings.curve import Curve, from_zero, mean_curve, rms
from stepwell.lab.recordings.errors import LabError
from stepwell.lab.recordings.measured_curve import MeasuredCurve, read_curve
from stepwell.lab.recordings.names import (
    PLACES,
    Setup,
    is_baseline,
    run_number,
    sample_number,
    setup_of,
    stem_of,
)
from stepwell.lab.recordings.oddities import batch_oddities, missing, oddities, unlike, unusable
from stepwell.lab.recordings.read import Batch, natural, read, read_all, read_bytes
from stepwell.lab.recordings.recording import Recording
from stepwell.lab.recordings.spikes import without_spikes
from stepwell.lab.recordings.table import SUMMARY, hashes, summary, table, to_csv
