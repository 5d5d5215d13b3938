"""A cycle on one page: the mechanism above, what it does below."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from stepwell.figures.cells import MOST_CELLS, arrange, draw
from stepwell.figures.common import PAGE, blank, keep_inside, place, styled, text_at
from stepwell.figures.motion.force_stroke import force_stroke
from stepwell.figures.motion.landscape import colour_bar, draw_energy, draw_path
from stepwell.figures.motion.travel_stroke import travel_stroke

if TYPE_CHECKING:
    from stepwell.sequences import Cycle


# Height of a page, and of the lanes of many cells on it [mm].
_PAGE, _LANES = 247.0, 120.0


@styled
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
    figure = blank(PAGE, height)
    letters: list[tuple[str, float, float]] = []
    if sheet is not None:
        draw(place(figure, 0.0, height - sheet.height, PAGE, sheet.height), sheet)
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
