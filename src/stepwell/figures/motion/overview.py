"""A cycle on one page, and the figures that answer what a mechanism will do."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from stepwell.figures.cells.cell_curves import element_curves
from stepwell.figures.cells.mechanism import MOST_CELLS, MOST_STATES, arrange, draw, mechanism
from stepwell.figures.common import style
from stepwell.figures.common.sheet import Draw, blank, keep_inside, place, text_at
from stepwell.figures.composing import compose
from stepwell.figures.motion.landscape import colour_bar, draw_energy, draw_path, landscape
from stepwell.figures.motion.strokes import MOST_LANES, force_stroke, travel_stroke
from stepwell.mechanism import Element

if TYPE_CHECKING:
    from stepwell.sequences import Cycle


# Height of a page, and of the lanes of many cells on it [mm].
_PAGE, _LANES = 247.0, 120.0


@style.styled
def overview(cycle: Cycle) -> Figure:
    """The mechanism in every state of its cycle, its energy landscape and its force loop.

    A chain of other than two cells shows the travel of each cell in place of the landscape, and
    one too long to draw leaves the mechanism out.

    Args:
        cycle: a full cycle.

    Returns:
        A figure of two columns' width.
    """
    chain = cycle.chain
    drawable = len(chain) <= MOST_CELLS
    lanes = max(46.0, min(20.0, (_LANES if drawable else 200.0) / len(chain)) * len(chain))
    body = 58.0 if len(chain) == 2 else lanes
    tallest = _PAGE - body - 23.0
    sheet = arrange(chain, cycle.sequence, tallest=tallest) if drawable else None
    above = sheet.height + 3.0 if sheet is not None else 0.0
    height = above + body + 20.0
    figure = blank(style.PAGE, height)
    letters: list[tuple[str, float, float]] = []
    if sheet is not None:
        draw(place(figure, 0.0, height - sheet.height, style.PAGE, sheet.height), sheet)
        letters.append(("A", 2.0, height - 4.0))
    below = body + 13.0
    if len(chain) == 2:
        ax = place(figure, 11.0, 11.0, 58.0, body)
        filled = draw_energy(ax, cycle.path)
        ax.apply_aspect()
        keep_inside(ax, 0.0)
        draw_path(ax, cycle.path)
        colour_bar(filled, place(figure, 72.5, 15.0, 2.5, body - 8.0))
    else:
        lanes_ax = place(figure, 14.0, 11.0, 66.0, body)
        travel_stroke(cycle, ax=lanes_ax)
        keep_inside(lanes_ax)
    # Higher than wide, a force loop is but a row of lines.
    high = min(body, 72.0)
    force_stroke(cycle, ax=place(figure, 105.0, 11.0 + body - high, 72.0, high))
    letters += [("BC"[k] if drawable else "AB"[k], (2.0, 92.0)[k], below) for k in (0, 1)]
    for letter, x, y in letters:
        text_at(figure, x, y, letter, fontsize=10, fontweight="bold")
    return figure


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
