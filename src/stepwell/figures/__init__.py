"""Every plot, one function each: results in, a matplotlib Figure out."""

from stepwell.base import have, missing

if not have("figures"):
    raise missing("figures")

from stepwell.figures.cells.cell_curves import (
    element_curve,
    element_curves,
    unit_cell_energy,
    unit_cell_force,
)
from stepwell.figures.cells.force_plane import force_plane
from stepwell.figures.cells.holes import holes
from stepwell.figures.cells.labelled import labelled_cell, labelled_chain
from stepwell.figures.cells.layers import layers
from stepwell.figures.cells.mechanism import mechanism
from stepwell.figures.common.write import PRINT_DPI, save, svg
from stepwell.figures.composing import WIDTHS as JOURNAL_WIDTHS, JournalWidth, compose, length
from stepwell.figures.defaults import plot
from stepwell.figures.graphs import graph_classes, transition_graph
from stepwell.figures.maps import transition_map
from stepwell.figures.measured import (
    band_laws,
    calibration,
    measured_element,
    measured_energies,
    measured_forces,
    measured_pairs,
    recording,
    recordings,
)
from stepwell.figures.motion.animation import animation
from stepwell.figures.motion.moving import moving
from stepwell.figures.motion.overview import landscape, overview, standard, standard_draws
from stepwell.figures.motion.stroke_program import stroke_program
from stepwell.figures.motion.strokes import force_stroke, snap_motion, travel_stroke
from stepwell.figures.robots.build import robot_parts
from stepwell.figures.robots.gait_plane import gait_plane
from stepwell.figures.robots.gaits import prediction, sweep
from stepwell.figures.robots.jumps import energy_flow, flight
from stepwell.figures.robots.mazes import maze, maze_timeline
from stepwell.figures.robots.robot import robot_above, robot_drawing, robot_side
from stepwell.figures.robots.trajectory import trajectories, trajectory
from stepwell.figures.robots.walks import contacts, gait
from stepwell.figures.robustness import margins, tornado, yield_bars
from stepwell.figures.studies import influences, outcomes

__all__ = [
    "JOURNAL_WIDTHS",
    "PRINT_DPI",
    "JournalWidth",
    "animation",
    "band_laws",
    "calibration",
    "compose",
    "contacts",
    "element_curve",
    "element_curves",
    "energy_flow",
    "flight",
    "force_plane",
    "force_stroke",
    "gait",
    "gait_plane",
    "holes",
    "influences",
    "labelled_cell",
    "labelled_chain",
    "landscape",
    "layers",
    "length",
    "graph_classes",
    "margins",
    "maze",
    "maze_timeline",
    "measured_energies",
    "measured_forces",
    "measured_pairs",
    "mechanism",
    "moving",
    "outcomes",
    "overview",
    "plot",
    "prediction",
    "measured_element",
    "recording",
    "recordings",
    "robot_above",
    "robot_drawing",
    "robot_parts",
    "robot_side",
    "save",
    "snap_motion",
    "standard",
    "standard_draws",
    "stroke_program",
    "svg",
    "sweep",
    "tornado",
    "trajectories",
    "trajectory",
    "transition_graph",
    "transition_map",
    "travel_stroke",
    "unit_cell_energy",
    "unit_cell_force",
    "yield_bars",
]
