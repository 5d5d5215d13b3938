"""Every plot, one function each: results in, a matplotlib Figure out."""

from stepwell.figures.cells import (
    element_curve,
    element_curves,
    force_plane,
    mechanism,
    unit_cell_energy,
    unit_cell_force,
)
from stepwell.figures.common import save, svg
from stepwell.figures.graphs import transition_graph
from stepwell.figures.maps import (
    Effect,
    Sensitivity,
    tornado,
    transition_map,
    yield_bars,
)
from stepwell.figures.measured import (
    band_laws,
    calibration,
    measured_energies,
    measured_forces,
    measured_pairs,
)
from stepwell.figures.motion import (
    animation,
    force_stroke,
    landscape,
    landscapes,
    moving,
    overview,
    snap_motion,
    standard,
    stroke_program,
    strokes,
    travel_stroke,
)
from stepwell.figures.robots import robot_above, robot_drawing, robot_side
from stepwell.figures.runs import (
    contacts,
    gait,
    maze,
    maze_timeline,
    prediction,
    sweep,
    trajectories,
    trajectory,
)

__all__ = [
    "Effect",
    "Sensitivity",
    "animation",
    "band_laws",
    "calibration",
    "contacts",
    "element_curve",
    "element_curves",
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
    "moving",
    "overview",
    "prediction",
    "robot_above",
    "robot_drawing",
    "robot_side",
    "save",
    "snap_motion",
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
