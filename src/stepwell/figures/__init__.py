"""Every plot, one function each: results in, a matplotlib Figure out."""

from stepwell.base import have, missing

if not have("figures"):
    raise missing("figures")

from stepwell.figures.cells import (
    element_curve,
    element_curves,
    force_plane,
    labelled_cell,
    labelled_chain,
    mechanism,
    unit_cell_energy,
    unit_cell_force,
)
from stepwell.figures.common import PRINT_DPI, save, svg
from stepwell.figures.graphs import transition_graph
from stepwell.figures.maps import (
    Effect,
    Sensitivity,
    margins,
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
    recording,
)
from stepwell.figures.motion import (
    animation,
    force_stroke,
    landscape,
    moving,
    overview,
    snap_motion,
    standard,
    standard_draws,
    stroke_program,
    travel_stroke,
)
from stepwell.figures.pages import WIDTHS as JOURNAL_WIDTHS, JournalWidth, compose, length
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
from stepwell.figures.studies import influences, machines, outcomes
from stepwell.figures.usual import plot

__all__ = [
    "JOURNAL_WIDTHS",
    "PRINT_DPI",
    "Effect",
    "JournalWidth",
    "Sensitivity",
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
