"""Design files in and out, and results as files: read, check, write."""

from stepwell.files._errors import DesignError
from stepwell.files.arena import arena_text, arenas, load_arena, loads_arena
from stepwell.files.atomic import staged_folder, write_atomic
from stepwell.files.bundle import write_map, write_run
from stepwell.files.design import loads, loads_chain, loads_robot
from stepwell.files.measured import (
    write_band,
    write_calibration,
    write_comparison,
    write_readings,
)
from stepwell.files.parameters import Parameter, parameters, vary
from stepwell.files.provenance import Given, provenance
from stepwell.files.record import force_scale, map_record, run_record
from stepwell.files.report import report
from stepwell.files.robot_bundle import write_maze, write_robot, write_sweep, write_walk
from stepwell.files.robot_record import maze_record, robot_record, sweep_record, walk_record
from stepwell.files.shipped import preset, preset_text, presets
from stepwell.files.source import load, load_chain, load_robot, read
from stepwell.files.write import dumps, save

__all__ = [
    "DesignError",
    "Given",
    "Parameter",
    "arena_text",
    "arenas",
    "dumps",
    "force_scale",
    "load",
    "load_arena",
    "load_chain",
    "load_robot",
    "loads",
    "loads_arena",
    "loads_chain",
    "loads_robot",
    "map_record",
    "maze_record",
    "parameters",
    "preset",
    "preset_text",
    "presets",
    "provenance",
    "read",
    "report",
    "robot_record",
    "run_record",
    "save",
    "staged_folder",
    "sweep_record",
    "vary",
    "walk_record",
    "write_atomic",
    "write_band",
    "write_calibration",
    "write_comparison",
    "write_map",
    "write_maze",
    "write_robot",
    "write_readings",
    "write_run",
    "write_sweep",
    "write_walk",
]
