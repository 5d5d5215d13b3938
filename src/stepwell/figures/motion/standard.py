"""The figures that answer what a mechanism will do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from stepwell.figures.cells import MOST_CELLS, MOST_STATES, element_curves, mechanism
from stepwell.figures.motion.force_stroke import force_stroke
from stepwell.figures.motion.landscape import landscape
from stepwell.figures.motion.travel_stroke import MOST_LANES, travel_stroke
from stepwell.mechanism import Element

if TYPE_CHECKING:
    from stepwell.sequences import Cycle


def standard(cycle: Cycle, *, width: float | None = None) -> dict[str, Figure]:
    """Every figure of a cycle that can be drawn for a chain of its length.

    Args:
        cycle: a full cycle.
        width: of those that can be wider than one column of a page [mm]; as their functions have
            it by default.

    Returns:
        By function name: mechanism (up to 12 cells), landscape (two cells), force_stroke and
        travel_stroke (up to 60 cells); element_curves of up to 12 elements.
    """
    chain = cycle.chain
    wide: dict[str, Any] = {} if width is None else {"width": width}
    found: dict[str, Figure] = {}
    if len(chain) <= MOST_CELLS and len(cycle.sequence) <= MOST_STATES:
        found["mechanism"] = mechanism(chain, cycle.sequence, **wide)
    if len(chain) == 2:
        found["landscape"] = landscape(cycle)
    found["force_stroke"] = force_stroke(cycle, **wide)
    if len(chain) <= MOST_LANES:
        found["travel_stroke"] = travel_stroke(cycle)
    cells = zip(chain.names, chain.cells, strict=True)
    elements = {name: cell for name, cell in cells if isinstance(cell, Element)}
    if 0 < len(elements) <= MOST_CELLS:
        found["element_curves"] = element_curves(elements, **wide)
    return found
