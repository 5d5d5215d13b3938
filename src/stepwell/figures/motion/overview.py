"""A cycle on one page: its standard figures, and the energy landscape with the path."""

from collections.abc import Sequence
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from stepwell.base import Floats, InputError
from stepwell.figures.cells.cell_curves import element_curves
from stepwell.figures.cells.mechanism import MOST_CELLS, MOST_STATES, arrange, draw, mechanism
from stepwell.figures.common import marks, reading, sheet, style, words
from stepwell.figures.common.sheet import Draw, Point, blank, canvas, place, text_at
from stepwell.figures.composing import compose
from stepwell.figures.motion.strokes import MOST_LANES, force_stroke, travel_stroke
from stepwell.mechanism import Cell, Chain, Element
from stepwell.sequences import Cycle
from stepwell.statics import Path

# Loading lies under unloading, so it is wider and stays visible where both coincide.
_WIDTHS = (3.0, 1.3)
_SAMPLES = 121
_LEVELS = 16
# Least margin of the landscape [mm].
_ROOM = 4.4
# Largest side of a panel [mm].
_WIDEST = 90.0
# Above this aspect ratio the axes are not true to scale.
_SLIMMEST = 3.0
_FRAME: dict[str, Any] = {"color": style.BLACK, "linewidth": 0.6, "linestyle": (0, (4, 2))}
# Grey, because every hue has a meaning of its own; light, because the path lies on it.
_ENERGY = LinearSegmentedColormap.from_list("stepwell energy", ["#8C939B", "#F7F7F4"])


@style.styled
def landscape(result: Cycle | Path, *, ax: Axes | None = None) -> Figure:
    """Total energy [mJ] of a two-cell chain over both travels [mm], with the path on it.

    Units follow the chain's measure. Thin diagonals join points of equal stroke; snaps follow them.
    States are dots; with elements they are frames, with the phases of the inner cell numbered above
    and those of the outer cell at the right. Where the curve of an element folds back, the energy
    is the least at that travel.

    Args:
        result: a cycle or a path of a chain of two cells.
        ax: axes to draw into, without a colour bar; a new figure of one column by default.

    Raises:
        ValueError: a chain without exactly two cells.

    Source: Kamp et al. 2024, Fig. 2B.
    """
    path = reading.path_of(result)
    if len(path.chain) != 2:
        raise InputError(
            f"the chain has {len(path.chain)} cells: an energy landscape shows exactly 2; "
            f"use force_stroke or travel_stroke."
        )
    own = ax is None
    width = sheet.page_width(style.COLUMN)
    side = min(width - 31.0, _WIDEST)
    size, margins = (width, side + 18.0), (11.0, 11.0, width - side - 11.0, 7.0)
    figure, ax = canvas(ax, size, margins, rigid=True, keyed=True)
    _draw_landscape(ax, path, (side + 14.0, side - 8.0) if own else None)
    return figure


def _draw_landscape(ax: Axes, path: Path, bar: Point | None) -> None:
    """Draw the landscape with the path; `bar` is the left edge and height of a colour bar [mm]."""
    filled = _draw_energy(ax, path)
    if bar is not None:
        ax.apply_aspect()
        sheet.keep_inside(ax, 0.0)
    x, y = path.travel.T * words.travel(path.chain.measure).factor
    marks.trace(ax, path, x, y, _WIDTHS)
    marks.snaps(ax, reading.snaps_of(path), x, y)
    marks.headings(ax, path, x, y, sizes=(13.0, 10.0))
    marks.legend(ax, path, _WIDTHS)
    if bar is not None:
        shades = place(sheet.sheet_of(ax), bar[0], 15.0, 2.5, bar[1])
        sheet.root(ax).colorbar(filled, cax=shades, ticks=MaxNLocator(6))
        shades.tick_params(length=2.0)
        shades.set_ylabel("Energy [mJ]")


def _draw_energy(ax: Axes, path: Path) -> QuadContourSet:
    """Draw the energy with stops or phases, states and lines of equal stroke."""
    chain, of = path.chain, words.travel(path.chain.measure)
    spans = [reading.span(path, i) for i in range(2)]
    along = [np.linspace(low, high, _SAMPLES) for low, high in spans]
    inner, outer = (_energy(*pair) for pair in zip(chain.cells, along, strict=True))
    x, y = (travel * of.factor for travel in along)
    energy = (inner + outer[:, None]) * style.MJ
    filled = ax.contourf(x, y, energy, _LEVELS, cmap=_ENERGY)
    ax.contour(x, y, energy, filled.levels, colors="#7C838B", linewidths=0.3)
    (left, right), (low, high) = (x[0], x[-1]), (y[0], y[-1])
    width, height = right - left, high - low
    dots = {"color": style.FAINT, "linewidth": 0.4, "linestyle": (0, (1, 2)), "gid": "equal stroke"}
    for u in np.linspace(left + low, right + high, 9)[1:-1]:
        ends = np.array([max(left, u - high), min(right, u - low)])
        ax.plot(ends, u - ends, **dots)
    frame = [left, right, right, left, left], [low, low, high, high, low]
    ax.plot(*frame, color=style.FAINT, linewidth=0.6)
    # Small axes need a larger margin for the names of the states.
    page, dpi = ax.get_window_extent(), sheet.root(ax).dpi / 25.4
    room = max(0.085, _ROOM * dpi / min(page.width, page.height))
    pads = room * width, room * height
    if max(pads) < _SLIMMEST * min(pads):
        ax.set_aspect("equal")
        pads = max(pads), max(pads)
    ax.set(xlim=(left - pads[0], right + pads[0]), ylim=(low - pads[1], high + pads[1]))
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines.bottom.set_bounds(left, right)
    ax.spines.left.set_bounds(low, high)
    ax.tick_params(length=2.0)
    xlabel, ylabel = (f"{of.word} of {words.literal(name)} [{of.sign}]" for name in chain.names)
    ax.set(xlabel=xlabel, ylabel=ylabel)
    if chain.elements:
        _frame_states(ax, chain, ((left, right), (low, high)))
    else:
        _name_states(ax, width, height)
    return filled


def _energy(cell: Cell | Element, travel: Floats) -> Floats:
    # The least energy [J] of all sheets at each travel.
    laws = cell.laws if isinstance(cell, Element) else ()
    if len(laws) < 2:
        return cell.energy_at(travel)
    least = np.full(travel.shape, np.inf)
    for number, law in enumerate(laws):
        low = law.begin if law.begin > cell.low else -np.inf
        high = law.end if law.end < cell.high else np.inf
        here = (travel >= low) & (travel <= high)
        least[here] = np.minimum(least[here], cell.energy_at(travel[here], number))
    return least


def _name_states(ax: Axes, width: float, height: float) -> None:
    look: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "center"}
    for one, other in ((0, 0), (1, 0), (1, 1), (0, 1)):
        at = (one * width, other * height)
        ax.plot(*at, "o", markersize=3.4, color=style.BLACK, zorder=7, gid="states")
        off = (13.0 * one - 6.5, 13.0 * other - 6.5)
        ax.annotate(f"{one}{other}", at, off, **look, fontweight="bold")


def _frame_states(ax: Axes, chain: Chain, ends: Sequence[tuple[float, float]]) -> None:
    """Draw a frame round each state, with the inner digits above and the outer at the right."""
    factor = words.travel(chain.measure).factor
    both = [
        [np.clip([phase.low * factor, phase.high * factor], *within) for phase in phases]
        for phases, within in zip(chain.phases, ends, strict=True)
    ]
    for (left, right), (low, high) in product(*both):
        corners = [(left, low), (right, low), (right, high), (left, high), (left, low)]
        ax.plot(*zip(*corners, strict=True), **_FRAME, zorder=2.5, gid="states")
    (_, right), (_, top) = ends
    look = {"textcoords": "offset points", "ha": "center", "va": "center", "zorder": 8}
    look |= {"fontweight": "bold", "gid": "digit"}
    for cell, (stretches, colour) in enumerate(zip(both, style.cell_colours(2), strict=True)):
        for digit, stretch in enumerate(stretches):
            middle = float(np.mean(stretch))
            at, off = ((middle, top), (0, 6)) if cell == 0 else ((right, middle), (6, 0))
            ax.annotate(str(digit), at, off, **look, color=colour)
    # The number of ticks is known only when the axes have their shape.
    ax.apply_aspect()
    for axis, (low, high) in zip((ax.xaxis, ax.yaxis), ends, strict=True):
        slip = 1e-9 * (high - low)
        axis.set_ticks([t for t in axis.get_ticklocs() if low - slip <= t <= high + slip])


# Height of the lanes of many cells on a page [mm].
_LANES = 120.0


@style.styled
def overview(cycle: Cycle) -> Figure:
    """The mechanism in every state of its full cycle, its energy landscape and its force loop.

    A chain without exactly two cells shows the travel of each cell instead of the landscape. A
    chain too long to draw has no mechanism panel. Two columns wide.
    """
    chain = cycle.chain
    drawable = len(chain) <= MOST_CELLS
    lanes = max(46.0, min(20.0, (_LANES if drawable else 200.0) / len(chain)) * len(chain))
    body = 58.0 if len(chain) == 2 else lanes
    tallest = style.PAGE_HEIGHT - body - 23.0
    plan = arrange(chain, cycle, tallest=tallest) if drawable else None
    height = (plan.height + 3.0 if plan is not None else 0.0) + body + 20.0
    figure = blank(style.PAGE, height)
    corners = [(2.0, body + 13.0), (92.0, body + 13.0)]
    if plan is not None:
        draw(place(figure, 0.0, height - plan.height, style.PAGE, plan.height), plan)
        corners.insert(0, (2.0, height - 4.0))
    if len(chain) == 2:
        ax = place(figure, 11.0, 11.0, 58.0, body)
        _draw_landscape(ax, cycle.path, (72.5, body - 8.0))
    else:
        lanes_ax = place(figure, 14.0, 11.0, 66.0, body)
        travel_stroke(cycle, ax=lanes_ax)
        sheet.keep_inside(lanes_ax)
    # A force loop that is taller than wide is illegible.
    high = min(body, 72.0)
    force_stroke(cycle, ax=place(figure, 105.0, 11.0 + body - high, 72.0, high))
    for letter, corner in zip("ABC", corners, strict=False):
        text_at(figure, *corner, letter, fontsize=10, fontweight="bold")
    return figure


# Figures that can be two columns wide.
_WIDE = "mechanism", "force_stroke", "element_curves"


def standard(cycle: Cycle, *, width: float | None = None) -> dict[str, Figure]:
    """All standard figures of a full cycle, by function name.

    They are mechanism (up to 12 cells), landscape (two cells), force_stroke, travel_stroke (up to
    60 cells), and element_curves (up to 12 elements). `width` [mm] applies to figures that can be
    wider than one column; by default each has its own width.
    """
    return {
        name: draw() if width is None or name not in _WIDE else compose([draw], width=width)
        for name, draw in standard_draws(cycle).items()
    }


def standard_draws(cycle: Cycle) -> dict[str, Draw]:
    """Functions that draw the figures of `standard`, by function name."""
    chain = cycle.chain
    draws: dict[str, Draw] = {}
    if len(chain) <= MOST_CELLS and len(cycle.sequence) <= MOST_STATES:
        draws["mechanism"] = partial(mechanism, chain, cycle)
    if len(chain) == 2:
        draws["landscape"] = partial(landscape, cycle)
    draws["force_stroke"] = partial(force_stroke, cycle)
    if len(chain) <= MOST_LANES:
        draws["travel_stroke"] = partial(travel_stroke, cycle)
    cells = zip(chain.names, chain.cells, strict=True)
    elements = {name: cell for name, cell in cells if isinstance(cell, Element)}
    if 0 < len(elements) <= MOST_CELLS:
        draws["element_curves"] = partial(element_curves, elements)
    return draws
