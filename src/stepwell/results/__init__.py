"""Results as plain numbers with the unit in every name."""

from stepwell.results.design import (
    design_record,
    impossible_record,
    reprogram_record,
    survival_record,
    yield_record,
)
from stepwell.results.graph import graph_record
from stepwell.results.head import head
from stepwell.results.map import boundary_rows, map_record, told_in
from stepwell.results.program import program_record, unreachable_record
from stepwell.results.robot import (
    convergence_record,
    maze_record,
    robot_record,
    sweep_record,
    walk_record,
)
from stepwell.results.run import LONGEST_BECOMING, force_scale, run_record
from stepwell.results.ties import tie_notes

__all__ = [
    "LONGEST_BECOMING",
    "boundary_rows",
    "convergence_record",
    "design_record",
    "force_scale",
    "graph_record",
    "head",
    "impossible_record",
    "map_record",
    "maze_record",
    "program_record",
    "reprogram_record",
    "robot_record",
    "run_record",
    "survival_record",
    "sweep_record",
    "tie_notes",
    "told_in",
    "unreachable_record",
    "walk_record",
    "yield_record",
]
