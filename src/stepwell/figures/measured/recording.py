"""What a test machine recorded, as it recorded it."""

from __future__ import annotations

from matplotlib.figure import Figure

from stepwell.figures.common import COLUMN, MM, canvas, direction_colour, legends, literal, styled
from stepwell.lab import Recording


@styled
def recording(result: Recording) -> Figure:
    """Force against stroke of one recording, loading and unloading halves in their colours.

    Args:
        result: any recording.

    Returns:
        A figure of one column's width: force [N] against the stroke of the machine [mm].
    """
    figure, ax = canvas(None, (COLUMN, 62.0), (14.0, 10.0, 2.0, 10.0))
    shown: set[str] = set()
    for half in result.halves:
        way = result.direction_of(half)
        label = "_" if way in shown else way
        shown.add(way)
        colour = direction_colour(1 if way == "loading" else -1)
        ax.plot(
            result.stroke[half] * MM, result.force[half], color=colour, linewidth=1.0, label=label
        )
    ax.set(xlabel="Stroke of the machine [mm]", ylabel="Force [N]")
    legends.above(ax)
    figure.text(0.98, 0.965, literal(result.name), ha="right", va="top")
    return figure
