"""The figures that answer what a mechanism will do."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from stepwell.figures.cells import MOST_CELLS, MOST_STATES, element_curves, mechanism
from stepwell.figures.common import Draw
from stepwell.figures.motion.force_stroke import force_stroke
from stepwell.figures.motion.landscape import landscape
from stepwell.figures.motion.travel_stroke import MOST_LANES, travel_stroke
from stepwell.figures.pages import compose
from stepwell.mechanism import Element

if TYPE_CHECKING:
    from stepwell.sequences import Cycle

# Those that take two columns of a page where they are given them.
_WIDE = "mechanism", "force_stroke", "element_curves"


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
    return {
        name: draw() if width is None or name not in _WIDE else compose([draw], width=width)
        for name, draw in standard_draws(cycle).items()
    }


def standard_draws(cycle: Cycle) -> dict[str, Draw]:
    """What draws each figure of `standard`, by its function's name."""
    chain = cycle.chain
    found: dict[str, Draw] = {}
    if len(chain) <= MOST_CELLS and len(cycle.sequence) <= MOST_STATES:
        found["mechanism"] = partial(mechanism, chain, cycle.sequence)
    if len(chain) == 2:
        found["landscape"] = partial(landscape, cycle)
    found["force_stroke"] = partial(force_stroke, cycle)
    if len(chain) <= MOST_LANES:
        found["travel_stroke"] = partial(travel_stroke, cycle)
    cells = zip(chain.names, chain.cells, strict=True)
    elements = {name: cell for name, cell in cells if isinstance(cell, Element)}
    if 0 < len(elements) <= MOST_CELLS:
        found["element_curves"] = partial(element_curves, elements)
    return found
