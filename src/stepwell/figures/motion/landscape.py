"""Energy of a two-cell chain over its two travels, with the path on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from stepwell.figures.common import (
    BLACK,
    COLUMN,
    FAINT,
    MJ,
    MM,
    canvas,
    literal,
    marks,
    path_of,
    place,
    require_two_cells,
    root,
    snaps_of,
    styled,
)
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    from stepwell.sequences import Cycle
    from stepwell.statics import Path

# Loading lies under unloading, so it is drawn wider where both take the same way.
_WIDTHS = (3.0, 1.3)
_SAMPLES = 121
_LEVELS = 16
# Grey, because every hue has a meaning of its own; light, because the path lies on it.
_ENERGY = LinearSegmentedColormap.from_list("stepwell energy", ["#8C939B", "#F7F7F4"])


@styled
def landscape(result: Cycle | Path, *, ax: Axes | None = None) -> Figure:
    """Total energy of a two-cell chain over both travels, with the path on it.

    Args:
        result: a cycle or a path of a chain of two cells.
        ax: axes to draw into, without a colour bar; a new figure of one column by default.

    Returns:
        The figure: energy [mJ] over the travels of the inner and the outer cell [mm]; thin
        diagonals join points of equal stroke, along which snaps run.

    Raises:
        ValueError: a chain that has not exactly two cells.

    Source: Kamp et al. 2024, Fig. 2B.
    """
    path = path_of(result)
    require_two_cells(path.chain, "an energy landscape")
    own = ax is None
    figure, ax = canvas(ax, (COLUMN, 72.0), (11.0, 11.0, 20.0, 7.0))
    filled = draw_energy(ax, path.chain)
    draw_path(ax, path)
    if own:
        colour_bar(filled, place(figure, COLUMN - 17.0, 15.0, 2.5, 46.0))
    return figure


def draw_energy(ax: Axes, chain: Chain) -> QuadContourSet:
    """The landscape itself with its stops, states and lines of equal stroke."""
    inner, outer = chain.cells
    s_in = np.linspace(0.0, inner.full_travel, _SAMPLES)
    s_out = np.linspace(0.0, outer.full_travel, _SAMPLES)
    energy = inner.energy(inner.angle(s_in)) + outer.energy(outer.angle(s_out))[:, None]
    x, y, energy = s_in * MM, s_out * MM, energy * MJ
    filled = ax.contourf(x, y, energy, _LEVELS, cmap=_ENERGY)
    ax.contour(x, y, energy, filled.levels, colors="#7C838B", linewidths=0.3)

    width, height = x[-1], y[-1]
    dots = {"color": FAINT, "linewidth": 0.4, "linestyle": (0, (1, 2)), "gid": "equal stroke"}
    for u in np.linspace(0.0, width + height, 9)[1:-1]:
        ends = np.array([max(0.0, u - height), min(width, u)])
        ax.plot(ends, u - ends, **dots)
    ax.plot([0, width, width, 0, 0], [0, 0, height, height, 0], color=FAINT, linewidth=0.6)

    pad = 0.085 * max(width, height)
    ax.set(xlim=(-pad, width + pad), ylim=(-pad, height + pad), aspect="equal")
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines.bottom.set_bounds(0, width)
    ax.spines.left.set_bounds(0, height)
    ax.tick_params(length=2.0)
    xlabel, ylabel = (f"Travel of {literal(name)} [mm]" for name in chain.names)
    ax.set(xlabel=xlabel, ylabel=ylabel)
    for name in ("00", "10", "11", "01"):
        one, other = int(name[0]), int(name[1])
        at = (one * width, other * height)
        ax.plot(*at, "o", markersize=3.4, color=BLACK, zorder=7, gid="states")
        off = (13.0 * one - 6.5, 13.0 * other - 6.5)
        text = ax.annotate(name, at, off, textcoords="offset points", ha="center", va="center")
        text.set_fontweight("bold")
    return filled


def colour_bar(filled: QuadContourSet, ax: Axes) -> None:
    """What the shades mean."""
    root(ax).colorbar(filled, cax=ax, ticks=MaxNLocator(6))
    ax.tick_params(length=2.0)
    ax.set_ylabel("Energy [mJ]")


def draw_path(ax: Axes, path: Path) -> None:
    """Loading, unloading and snaps of the path, with their legend."""
    x, y = path.travel.T * MM
    marks.trace(ax, path, x, y, _WIDTHS)
    marks.snaps(ax, snaps_of(path), x, y)
    marks.headings(ax, path, x, y, sizes=(13.0, 10.0))
    marks.legend(ax, path, _WIDTHS)
