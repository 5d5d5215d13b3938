"""Every plot, one function each: results in, a matplotlib Figure out."""

from stepwell.figures._animation import animation
from stepwell.figures._band_test import band_laws
from stepwell.figures._calibration import calibration
from stepwell.figures._contacts import contacts
from stepwell.figures._force_plane import force_plane
from stepwell.figures._force_stroke import force_stroke
from stepwell.figures._gait import gait
from stepwell.figures._landscape import landscape
from stepwell.figures._maze import maze
from stepwell.figures._maze_timeline import maze_timeline
from stepwell.figures._measured_cells import measured_energies, measured_forces
from stepwell.figures._measured_pairs import measured_pairs
from stepwell.figures._mechanism import mechanism
from stepwell.figures._overview import overview
from stepwell.figures._parameter_map import parameter_map
from stepwell.figures._prediction import prediction
from stepwell.figures._robot import robot_above, robot_drawing, robot_side
from stepwell.figures._side_by_side import landscapes, strokes
from stepwell.figures._standard import standard
from stepwell.figures._stroke_program import stroke_program
from stepwell.figures._sweep import sweep
from stepwell.figures._tornado import Effect, Sensitivity, tornado
from stepwell.figures._trajectory import trajectories, trajectory
from stepwell.figures._transition_graph import transition_graph
from stepwell.figures._transition_map import transition_map
from stepwell.figures._travel_stroke import travel_stroke
from stepwell.figures._unit_cell import unit_cell_energy, unit_cell_force
from stepwell.figures._write import save, svg
from stepwell.figures._yield_bars import yield_bars

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
