"""Every plot, one function each: results in, a matplotlib Figure out."""

from stepwell.figures.cells.force_plane import force_plane
from stepwell.figures.cells.mechanism import mechanism
from stepwell.figures.cells.unit_cell import unit_cell_energy, unit_cell_force
from stepwell.figures.common.write import save, svg
from stepwell.figures.graphs.transition_graph import transition_graph
from stepwell.figures.maps.parameter_map import parameter_map
from stepwell.figures.maps.tornado import Effect, Sensitivity, tornado
from stepwell.figures.maps.transition_map import transition_map
from stepwell.figures.maps.yield_bars import yield_bars
from stepwell.figures.measured.band_test import band_laws
from stepwell.figures.measured.calibration import calibration
from stepwell.figures.measured.measured_cells import measured_energies, measured_forces
from stepwell.figures.measured.measured_pairs import measured_pairs
from stepwell.figures.motion.animation import animation
from stepwell.figures.motion.force_stroke import force_stroke
from stepwell.figures.motion.landscape import landscape
from stepwell.figures.motion.overview import overview
from stepwell.figures.motion.side_by_side import landscapes, strokes
from stepwell.figures.motion.standard import standard
from stepwell.figures.motion.stroke_program import stroke_program
from stepwell.figures.motion.travel_stroke import travel_stroke
from stepwell.figures.robots.robot import robot_above, robot_drawing, robot_side
from stepwell.figures.runs.contacts import contacts
from stepwell.figures.runs.gait import gait
from stepwell.figures.runs.maze import maze
from stepwell.figures.runs.maze_timeline import maze_timeline
from stepwell.figures.runs.prediction import prediction
from stepwell.figures.runs.sweep import sweep
from stepwell.figures.runs.trajectory import trajectories, trajectory

__all__ = [
    "Effect",
    "Sensitivity",
    "animation",
    "band_laws",
    "calibration",
    "contacts",
    "force_plane",
    "force_stroke",
    "gait",
    "landscape",
    "landscapes",
    "maze",
    "maze_timeline",
    "measured_energies",
    "measured_forces",
    "measured_pairs",
    "mechanism",
    "overview",
    "parameter_map",
    "prediction",
    "robot_above",
    "robot_drawing",
    "robot_side",
    "save",
    "standard",
    "stroke_program",
    "strokes",
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
