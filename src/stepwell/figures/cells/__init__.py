"""Unit cells and the mechanism itself, drawn."""

from stepwell.figures.cells.drawing import Drawing
from stepwell.figures.cells.element_curve import element_curve, element_curves
from stepwell.figures.cells.force_plane import force_plane
from stepwell.figures.cells.labelled import labelled_cell, labelled_chain
from stepwell.figures.cells.linkage import LinkageDrawing, Pose
from stepwell.figures.cells.mechanism import (
    MOST_CELLS,
    MOST_STATES,
    arrange,
    draw,
    ground,
    mechanism,
)
from stepwell.figures.cells.unit_cell import unit_cell_energy, unit_cell_force
