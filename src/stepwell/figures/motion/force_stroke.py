"""Actuator force against stroke."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.figures.common import (
    BLACK,
    COLUMN,
    PAGE,
    Label,
    beside,
    canvas,
    keep_inside,
    legs,
    marks,
    path_of,
    snaps_of,
    styled,
    told,
    vertices,
)
from stepwell.figures.motion.recorded import draw_recorded

if TYPE_CHECKING:
    from stepwell.lab import Recording
    from stepwell.sequences import Cycle
    from stepwell.statics import Path

# Loading lies under unloading, so it is drawn wider where both take the same way.
_WIDTHS = (2.2, 1.2)


@styled
def force_stroke(
    result: Cycle | Path, *, measured: Sequence[Recording] = (), ax: Axes | None = None
) -> Figure:
    """Actuator force against stroke, loading and unloading, snaps as dashed jumps.

    Args:
        result: a cycle, or a path over any turning points.
        measured: recordings to be drawn behind it in pale colours, four at most, as
            `lab.read` returns them.
        ax: axes to draw into; by default a new figure of one column's width, or of two for
            more than four cells.

    Returns:
        The figure: force [N] against stroke [mm], or what they are in the chain's measure, with
        the states between the branches named where there is room for their names.

    Raises:
        ValueError: too many recordings, or some for a chain of volumes or angles.
    """
    path = path_of(result)
    own = ax is None
    width = COLUMN if len(path.chain) <= 4 else PAGE
    figure, ax = canvas(ax, (width, 62.0), (15.0, 10.0, 2.0, 6.0), keyed=True)
    x, y = told.stroke(path.chain.measure), told.actuator(path.chain.measure)
    stroke, force = path.stroke * x.factor, path.force * y.factor
    ax.set(xlabel=x.label, ylabel=y.label)
    marks.zero_line(ax)
    crowded = len(legs(path)) > marks.MOST_HEADS
    loading, unloading = _WIDTHS
    marks.trace(ax, path, stroke, force, (loading / (1 + crowded), unloading / (1 + crowded)))
    marks.snaps(ax, snaps_of(path), stroke, force)
    recorded = draw_recorded(ax, measured, path.chain.measure)
    ax.margins(x=0.08, y=0.12)
    ax.autoscale_view()
    if own:
        keep_inside(ax)
    marks.legend(ax, path, _WIDTHS, more=recorded, fit=own)

    marks.headings(ax, path, stroke, force)
    rests = vertices(path)
    at = [vertex.sample for vertex in rests]
    # Names in two rows, one above and one below the curves, a character being 0.6 of 7 pt wide.
    needed = sum(4.2 * len(vertex.state) for vertex in rests) / 72 * figure.dpi
    roomy = needed < 1.2 * ax.get_window_extent().width
    size = 1.5 if crowded else 3.4
    ax.plot(stroke[at], force[at], "o", markersize=size, color=BLACK, zorder=7, gid="states")
    if roomy:
        named = [Label(float(stroke[v.sample]), float(force[v.sample]), v.state) for v in rests]
        beside(ax, named, leaders=True)
    return figure
