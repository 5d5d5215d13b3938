"""Design files in and out, and results as files: read, check, write."""

from stepwell.files._errors import DesignError
from stepwell.files.atomic import staged_folder, write_atomic
from stepwell.files.bundle import write_map, write_run
from stepwell.files.design import loads
from stepwell.files.measured import (
    write_band,
    write_calibration,
    write_comparison,
    write_readings,
)
from stepwell.files.record import force_scale, map_record, run_record
from stepwell.files.report import report
from stepwell.files.shipped import preset, preset_text, presets
from stepwell.files.source import load, read
from stepwell.files.write import dumps, save

__all__ = [
    "DesignError",
    "dumps",
    "force_scale",
    "load",
    "loads",
    "map_record",
    "preset",
    "preset_text",
    "presets",
    "read",
    "report",
    "run_record",
    "save",
    "staged_folder",
    "write_atomic",
    "write_band",
    "write_calibration",
    "write_comparison",
    "write_map",
    "write_readings",
    "write_run",
]
