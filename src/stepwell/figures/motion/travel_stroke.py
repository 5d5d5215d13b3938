"""Travel of each cell against stroke."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import Floats, InputError
from stepwell.figures.common import (
    COLUMN,
    FAINT,
    MM,
    canvas,
    cell_colours,
    keep_inside,
    literal,
    marks,
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
    ticks: list[tuple[float, str]] = []
    # Past a dozen lanes their names would run into each other.
    named = len(cells) <= 12
    every = math.ceil(len(cells) / 20)
    base = 0.0
    for i, (base, top, travel, colour) in enumerate(lanes(ax, path, _GAP)):
        name = path.chain.names[i]
        if named:
            ticks += [(base, "0"), (top, f"{top - base:.3g}")]
            name_lane(ax, (0.0, top), name, colour, (3.0, 1.5), va="bottom")
        elif i % every == 0:
            ticks.append(((base + top) / 2, literal(name)))
        marks.trace(ax, path, stroke, travel, _WIDTHS, _UNLOADING_DASHES)
        marks.snaps(ax, [snap for snap in snaps if i in snap.cells], stroke, travel, size=3.2)
    ax.set_yticks(*zip(*ticks, strict=True))
    ax.set(
        xlabel="Stroke $u$ [mm]",
        ylabel="Travel $s$ [mm]" if named else "Travel $s$ of each cell, 0 to $S$",
    )
    ax.margins(x=0.06)
    ax.set_ylim(base - 0.12 * longest, (1.0 + _GAP) * longest)
    if own:
        keep_inside(ax)
    marks.legend(ax, path, _WIDTHS, _UNLOADING_DASHES)
    return figure


def lanes(ax: Axes, path: Path, gap: float) -> Iterator[tuple[float, float, Floats, str]]:
    """Lines for both stops of every cell, innermost on top.

    Args:
        ax: axes to draw into.
        path: of a chain of any length.
        gap: between two lanes, as a fraction of the longest travel.

    Returns:
        Of each cell the height of its stops 0 and 1, its travel (n,) on the first [mm], its colour.
    """
    cells = path.chain.cells
    longest = max(cell.full_travel for cell in cells) * MM
    for i, (cell, colour) in enumerate(zip(cells, cell_colours(len(cells)), strict=True)):
        base = -i * (1.0 + gap) * longest
        top = base + cell.full_travel * MM
        for stop in (base, top):
            ax.axhline(stop, color=FAINT, linewidth=0.4, zorder=0)
        yield base, top, base + path.travel[:, i] * MM, colour


def name_lane(
    ax: Axes, at: tuple[float, float], name: str, colour: str, offset: tuple[float, float], va: str
) -> None:
    """A cell's name `offset` pt from a share of the width and a height."""
    ax.annotate(
        literal(name),
        at,
        offset,
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        ha="left",
        va=va,
        color=colour,
        fontweight="bold",
    )
