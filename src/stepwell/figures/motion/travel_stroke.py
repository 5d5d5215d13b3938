"""Travel of each cell against stroke."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import InputError
from stepwell.figures.common import (
    COLUMN,
    FAINT,
    MM,
    canvas,
    cell_colours,
    curve,
    direction_colour,
    keep_inside,
    literal,
    marks as _marks,
    path_of,
    snaps_of,
    styled,
)

if TYPE_CHECKING:
    from stepwell.sequences import Cycle
    from stepwell.statics import Path

MOST_LANES = 60
_WIDTHS = (2.0, 1.3)
_UNLOADING_DASHES = (0, (3.2, 1.6))
# Between the lanes of two cells, as a fraction of the longest travel.
_GAP = 0.42


@styled
def travel_stroke(result: Cycle | Path, *, ax: Axes | None = None) -> Figure:
    """Travel of each cell against stroke, one lane a cell, innermost on top.

    Lanes, because in one frame the loading curve of one cell often lies on the unloading curve
    of another.

    Args:
        result: a cycle, or a path over any turning points.
        ax: axes to draw into; a new figure of one column's width by default.

    Returns:
        The figure: travel [mm] against stroke [mm]; loading solid, unloading dashed, snaps as
        dashed jumps.

    Raises:
        ValueError: more cells than lanes can be told apart.
    """
    path = path_of(result)
    cells = path.chain.cells
    if len(cells) > MOST_LANES:
        raise InputError(
            f"the chain has {len(cells)} cells: at most {MOST_LANES} lanes can be told apart; "
            f"path.travel has the numbers."
        )
    lane = min(20.0, 200.0 / len(cells))
    own = ax is None
    figure, ax = canvas(ax, (COLUMN, 16.0 + lane * len(cells)), (13.0, 10.0, 2.0, 6.0))
    longest = max(cell.full_travel for cell in cells) * MM
    stroke = path.stroke * MM
    snaps = snaps_of(path)
    ticks: list[float] = []
    marks: list[str] = []
    # Past a dozen lanes their names would run into each other.
    named = len(cells) <= 12
    every = math.ceil(len(cells) / 20)
    for i, (cell, name, colour) in enumerate(
        zip(cells, path.chain.names, cell_colours(len(cells)), strict=True)
    ):
        base = -i * (1.0 + _GAP) * longest
        top = base + cell.full_travel * MM
        for stop in (base, top):
            ax.axhline(stop, color=FAINT, linewidth=0.4, zorder=0)
        if named:
            ticks += [base, top]
            marks += ["0", f"{cell.full_travel * MM:.3g}"]
            ax.annotate(
                literal(name),
                (0.0, top),
                (3.0, 1.5),
                xycoords=("axes fraction", "data"),
                textcoords="offset points",
                ha="left",
                va="bottom",
                color=colour,
                fontweight="bold",
            )
        elif i % every == 0:
            ticks.append((base + top) / 2)
            marks.append(name)
        travel = base + path.travel[:, i] * MM
        for direction, width in zip((1, -1), _WIDTHS, strict=True):
            ax.plot(
                *curve(path, direction, stroke, travel),
                color=direction_colour(direction),
                linestyle="-" if direction > 0 else _UNLOADING_DASHES,
                linewidth=width,
                zorder=2 if direction > 0 else 3,
            )
        _marks.snaps(ax, [snap for snap in snaps if i in snap.cells], stroke, travel, size=3.2)
    ax.set_yticks(ticks, marks)
    ax.set_xlabel("Stroke $u$ [mm]")
    ax.set_ylabel("Travel $s$ [mm]" if named else "Travel $s$ of each cell, 0 to $S$")
    ax.margins(x=0.06)
    lowest = -(len(cells) - 1) * (1.0 + _GAP)
    ax.set_ylim((lowest - 0.12) * longest, (1.0 + _GAP) * longest)
    if own:
        keep_inside(ax)
    _marks.legend(ax, path, _WIDTHS, _UNLOADING_DASHES)
    return figure
