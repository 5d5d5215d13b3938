"""Design files in and out, and results as files: read, check, write."""

from stepwell.base.write import write_atomic
from stepwell.files.arena import arena_text, arenas, load_arena, loads_arena
from stepwell.files.design import loads, loads_chain, loads_program, loads_robot
from stepwell.files.folder import (
    IncompleteError,
    OverwriteError,
    check_folder,
    digest,
    manifest,
    staged_folder,
)
from stepwell.files.outputs import OUTPUTS, pictures
from stepwell.files.parameters import Parameter, parameters, vary
from stepwell.files.provenance import Given, provenance
from stepwell.files.schema.keys import slips_text
from stepwell.files.shipped import preset, preset_text, presets
from stepwell.files.source import load, load_chain, load_program, load_robot, read
from stepwell.files.tables.program import WrittenProgram
from stepwell.files.text.errors import DesignError
from stepwell.files.write import dumps, save, with_program
from stepwell.reports.design import write_design, write_reprogramming, write_survival, write_yield
from stepwell.reports.graph import checked_suffix, write_graph
from stepwell.reports.measured import (
    write_band,
    write_calibration,
    write_comparison,
    write_readings,
)
from stepwell.reports.page import report
from stepwell.reports.program import write_program
from stepwell.reports.robot import write_maze, write_robot, write_sweep, write_walk
from stepwell.reports.run import write_map, write_parameter_map, write_run
from stepwell.results.design import (
    design_record,
    impossible_record,
    reprogram_record,
    survival_record,
    yield_record,
)
from stepwell.results.graph import graph_record
from stepwell.results.head import head
from stepwell.results.map import parameter_map_record
from stepwell.results.program import program_record, unreachable_record
from stepwell.results.robot import (
    convergence_record,
    maze_record,
    robot_record,
    sweep_record,
    walk_record,
)
from stepwell.results.run import force_scale, map_record, run_record

__all__ = [
    "DesignError",
    "Given",
    "IncompleteError",
    "OUTPUTS",
    "OverwriteError",
    "Parameter",
    "WrittenProgram",
    "arena_text",
    "arenas",
    "check_folder",
    "checked_suffix",
    "convergence_record",
    "design_record",
    "digest",
    "dumps",
    "force_scale",
    "graph_record",
    "head",
    "impossible_record",
    "load",
    "load_arena",
    "load_chain",
    "load_program",
    "load_robot",
    "loads",
    "loads_arena",
    "loads_chain",
    "loads_program",
    "loads_robot",
    "manifest",
    "map_record",
    "maze_record",
    "parameter_map_record",
    "parameters",
    "pictures",
    "preset",
    "preset_text",
    "presets",
    "program_record",
    "provenance",
    "read",
    "report",
    "reprogram_record",
    "robot_record",
    "run_record",
    "save",
    "slips_text",
    "staged_folder",
    "survival_record",
    "sweep_record",
    "unreachable_record",
    "vary",
    "walk_record",
    "with_program",
    "write_atomic",
    "write_band",
    "write_calibration",
    "write_comparison",
    "write_design",
    "write_graph",
    "write_map",
    "write_maze",
    "write_parameter_map",
    "write_program",
    "write_readings",
    "write_reprogramming",
    "write_robot",
    "write_run",
    "write_survival",
    "write_sweep",
    "write_walk",
    "write_yield",
    "yield_record",
]
