"""Legends: what lines, marks and shades mean, and where that is written."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import ScaledTranslation
from matplotlib.typing import ColorType

from stepwell.figures.common.sheet import in_panel, sheet_of, size_of
from stepwell.figures.common.style import INK, cell_colours, cell_dashes
from stepwell.figures.common.words import literal


def line(label: str, colour: ColorType = INK, width: float = 1.4, **look: Any) -> Line2D:
    """What a line means."""
    return Line2D([], [], color=colour, linewidth=width, label=label, **look)


def mark(label: str, marker: str = "o", size: float = 4.5, **look: Any) -> Line2D:
    """What a mark without a line means."""
    look = {"color": INK, "markersize": size, "marker": marker} | look
    return Line2D([], [], linestyle="none", label=label, **look)


def shade(label: str, colour: ColorType, **look: Any) -> Patch:
    """What a shade means."""
    return Patch(facecolor=colour, label=label, **look)


def cells(
    names: Sequence[str],
    width: float = 1.4,
    label: str = "{}",
    *,
    dashed: bool = False,
    **look: Any,
) -> list[Line2D]:
    """The colour of every cell of these names, inner first, and its dashes if lines have them."""
    found = [
        line(label.format(literal(name)), colour, width, **look)
        for name, colour in zip(names, cell_colours(len(names)), strict=True)
    ]
    for one, dashes in zip(found, cell_dashes(len(names)) if dashed else (), strict=False):
        one.set_linestyle(dashes)
    return found


def laid(count: int, room: float, entry: float, most: int = 100) -> tuple[int, int]:
    """Columns, `most` at most, and rows of so many entries of this width in so much room [mm]."""
    columns = max(1, min(count, most, int(room / entry)))
    return columns, -(-count // columns)


def above(
    ax: Axes,
    handles: Iterable[Artist] | None = None,
    columns: int = 3,
    *,
    fit: bool = False,
    lift: float = 1.2,
    **look: Any,
) -> None:
    """A legend `lift` mm above the axes, of these handles or of all that has a label.

    With `fit`, and in a panel of a page, it has as many columns as have room, and the axes make
    room for its rows.
    """
    # In mm, not as a share of the axes: on high ones that would leave the page.
    lifted = ax.transAxes + ScaledTranslation(0.0, lift / 25.4, sheet_of(ax).dpi_scale_trans)
    place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "bbox_transform": lifted}
    given = {} if handles is None else {"handles": list(handles)}
    legend = ax.legend(**given, **place | {"ncols": columns} | look)
    if not fit and not in_panel():
        return
    page, per_mm = sheet_of(ax).bbox, sheet_of(ax).dpi / 25.4
    while columns > 1 and legend.get_window_extent().x1 > page.x1:
        columns -= 1
        legend = ax.legend(**given, **place | {"ncols": columns} | look)
    _shorten(legend, page.x1)
    over = legend.get_window_extent().y1 + 0.5 * per_mm - page.y1
    if over > 0:
        box = ax.get_position()
        ax.set_position((box.x0, box.y0, box.width, box.height - over / page.height))


def _shorten(legend: Legend, right: float) -> None:
    """Leave out the ends of names that would leave the page."""
    for text in legend.get_texts():
        words = text.get_text()
        while len(words) > 4 and "$" not in words and text.get_window_extent().x1 > right:
            words = words[:-2].rstrip(" …") + "…"
            text.set_text(words)


def on_top(
    figure: Figure, handles: Sequence[Artist], left: float, gap: float = 1.5, columns: int = 0
) -> None:
    """A legend at the top of the figure, `left` and `gap` mm from its edges; in one row if 0."""
    width, height = size_of(figure)
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(left / width, 1 - gap / height),
        ncols=columns or len(handles),
    )


def below(
    figure: Figure, handles: Sequence[Artist], columns: int, left: float | None = None, **look: Any
) -> Legend:
    """A legend 1.5 mm above the figure's lower edge, in its middle or `left` mm from its edge."""
    width, height = size_of(figure)
    return figure.legend(
        handles=handles,
        loc="lower center" if left is None else "lower left",
        bbox_to_anchor=(0.5 if left is None else left / width, 1.5 / height),
        ncols=columns,
        **look,
    )
