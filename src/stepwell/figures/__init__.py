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
from stepwell.figures.cells.labelled import labelled_cell, labelled_chain
from stepwell.figures.cells.mechanism import mechanism
from stepwell.figures.common.write import PRINT_DPI, save, svg
from stepwell.figures.composing import WIDTHS as JOURNAL_WIDTHS, JournalWidth, compose, length
from stepwell.figures.graphs import transition_graph
from stepwell.figures.influences import influences
from stepwell.figures.machines import machines
from stepwell.figures.maps import transition_map
from stepwell.figures.margins import margins
from stepwell.figures.measured import measured_energies, measured_forces, measured_pairs
from stepwell.figures.measured_bands import band_laws, calibration, recording
from stepwell.figures.motion.animation import animation
from stepwell.figures.motion.landscape import landscape
from stepwell.figures.motion.moving import moving
from stepwell.figures.motion.overview import overview, standard, standard_draws
from stepwell.figures.motion.snap_motion import snap_motion
from stepwell.figures.motion.stroke_program import stroke_program
from stepwell.figures.motion.strokes import force_stroke, travel_stroke
from stepwell.figures.outcomes import outcomes
from stepwell.figures.robots.contacts import contacts
from stepwell.figures.robots.gait import gait
from stepwell.figures.robots.mazes import maze, maze_timeline
from stepwell.figures.robots.predictions import prediction
from stepwell.figures.robots.robot import robot_above, robot_drawing, robot_side
from stepwell.figures.robots.sweeps import sweep
from stepwell.figures.robots.trajectory import trajectories, trajectory
from stepwell.figures.tornado import tornado
from stepwell.figures.usual import plot
from stepwell.figures.yield_bars import yield_bars

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
    "force_plane",
    "force_stroke",
    "gait",
    "influences",
    "labelled_cell",
    "labelled_chain",
    "landscape",
    "length",
    "machines",
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
    "recording",
    "robot_above",
    "robot_drawing",
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
