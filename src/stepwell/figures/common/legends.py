"""Legends, and labels placed where they cover neither curves nor other text."""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox, ScaledTranslation
from matplotlib.typing import ColorType

from stepwell.base import Floats
from stepwell.figures.common import sheet, style
from stepwell.figures.common.words import literal

_DIRECTIONS = [(np.cos(a), np.sin(a)) for a in np.deg2rad([90, 270, 45, 135, 315, 225, 0, 180])]
_DISTANCES = (4.0, 8.0, 13.0, 20.0, 28.0, 38.0, 50.0, 65.0)
# From this distance on, a label needs a line to its point [pt].
_FAR = 13.0


class Label(NamedTuple):
    """A text for a point in data units."""

    at: Sequence[float] | Floats
    text: str
    colour: str = style.INK


def place_labels(
    ax: Axes, labels: Iterable[Label], *, keep_clear: Sequence[Bbox] = (), leaders: bool = False
) -> list[Annotation]:
    """Write labels near their points, the most important first.

    A label is nearest to its own point and avoids lines, labels, the edges of `ax` (with final
    limits) and the boxes `keep_clear` [pixels]. `leaders` adds lines from distant labels to their
    points.
    """
    labels = list(labels)
    spots = ax.transData.transform(np.array([label.at for label in labels]).reshape(-1, 2))
    point = sheet.root(ax).dpi / 72.0
    curves = _curves(ax, 2.0 * point)
    frame = ax.get_window_extent().padded(-1.5 * point)
    taken = list(keep_clear)
    written: list[Annotation] = []
    done: list[tuple[str, float, float]] = []
    for label, here in zip(labels, spots, strict=True):
        others = spots[np.hypot(*(spots - here).T) > 1.0 * point]
        # One label serves all points with its text whose marks overlap.
        if any(t == label.text and np.hypot(*(here - at)) < 6 * point for t, *at in done):
            continue
        done.append((label.text, *here))
        look = {"ha": "center", "va": "center", "fontsize": 7.0, "color": label.colour}
        at = (label.at[0], label.at[1])
        text = ax.annotate(label.text, at, (0, 0), textcoords="offset points", zorder=9, **look)
        text.set_in_layout(False)
        box = text.get_window_extent().padded(0.8 * point)
        best, best_cost, gap = (0.0, 0.0), np.inf, 0.0
        for far in _DISTANCES:
            for dx, dy in _DIRECTIONS:
                # The gap is between the point and the nearest edge of the text.
                x = dx * (far + box.width / point / 2)
                y = dy * (far + box.height / point / 2)
                moved = box.translated(x * point, y * point)
                cost = _cost(moved, frame, taken, curves) + 0.02 * far
                cost += 50.0 * (_distances(moved, others) <= _distances(moved, here[None])).any()
                if cost < best_cost:
                    best, best_cost, gap = (x, y), cost, far
            if best_cost < 1.0:
                break
        text.xyann = best
        taken.append(box.translated(best[0] * point, best[1] * point))
        written.append(text)
        own = float(_distances(taken[-1], here[None])[0])
        if leaders and (gap >= _FAR or (_distances(taken[-1], others) < own + 2 * point).any()):
            edge = ax.transData.inverted().transform(np.clip(here, taken[-1].min, taken[-1].max))
            props = {"arrowstyle": "-", "color": label.colour, "linewidth": 0.5}
            props |= {"shrinkA": 0, "shrinkB": 3}
            ax.annotate("", at, tuple(edge), arrowprops=props, zorder=7, gid="leader")
    return written


def inside(frame: Bbox, box: Bbox) -> bool:
    """Whether a box lies within a frame."""
    return frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1


def _distances(box: Bbox, points: Floats) -> Floats:
    """Distance of each point (n, 2) from a box; 0 inside."""
    return np.hypot(*(points - np.clip(points, box.min, box.max)).T)


def _cost(box: Bbox, frame: Bbox, taken: Sequence[Bbox], curves: Floats) -> float:
    covered = np.count_nonzero(np.all((curves > box.min) & (curves < box.max), axis=1))
    return 1000.0 * (not inside(frame, box)) + 100.0 * sum(box.overlaps(b) for b in taken) + covered


def _curves(ax: Axes, step: float) -> Floats:
    """Points every `step` pixels along every line of the axes, (n, 2)."""
    points = [np.empty((0, 2))]
    for line in ax.get_lines():
        xy = line.get_transform().transform(np.column_stack(line.get_data()))
        points.append(xy[np.isfinite(xy).all(axis=1)])
        start, along = xy[:-1], np.diff(xy, axis=0)
        drawn = np.isfinite(along).all(axis=1) & (line.get_linestyle() != "None")
        start, along = start[drawn], along[drawn]
        parts = np.ceil(np.hypot(*along.T) / step).astype(int)
        which = np.repeat(np.arange(len(parts)), parts)
        part = np.arange(len(which)) - np.repeat(np.cumsum(parts) - parts, parts)
        points.append(start[which] + along[which] * (part / parts[which])[:, None])
    return np.concatenate(points)


def line(label: str, colour: ColorType = style.INK, width: float = 1.4, **look: Any) -> Line2D:
    """Legend entry of a line."""
    return Line2D([], [], color=colour, linewidth=width, label=label, **look)


def mark(label: str, marker: str = "o", size: float = 4.5, **look: Any) -> Line2D:
    """Legend entry of a mark without a line."""
    look = {"color": style.INK, "markersize": size, "marker": marker} | look
    return Line2D([], [], linestyle="none", label=label, **look)


def shade(label: str, colour: ColorType, **look: Any) -> Patch:
    """Legend entry of a shade."""
    return Patch(facecolor=colour, label=label, **look)


def cells(
    names: Sequence[str],
    width: float = 1.4,
    label: str = "{}",
    *,
    dashed: bool = False,
    **look: Any,
) -> list[Line2D]:
    """Legend entries of the cells with these names, inner first, `dashed` if their lines are."""
    count = len(names)
    dashes = style.cell_dashes(count) if dashed else ["-"] * count
    return [
        line(label.format(literal(name)), colour, width, linestyle=dash, **look)
        for name, colour, dash in zip(names, style.cell_colours(count), dashes, strict=True)
    ]


def applicable(*handles: tuple[object, Artist]) -> list[Artist]:
    """The handles whose condition, the first of each pair, is true."""
    return [handle for holds, handle in handles if holds]


def grid_size(count: int, room: float, entry: float, most: int = 100) -> tuple[int, int]:
    """Columns (at most `most`) and rows of `count` entries of width `entry` in `room` [mm]."""
    columns = max(1, min(count, most, int(room / entry)))
    return columns, -(-count // columns)


def above(
    ax: Axes,
    handles: Iterable[Artist] | None = None,
    columns: int = 3,
    *,
    fit: bool = False,
    lift: float = 1.2,
    left: float | None = None,
    **look: Any,
) -> None:
    """Put a legend `lift` mm above the axes, of these handles or of all labelled artists.

    With `fit`, and in a panel, the columns suit the width and the axes make room for the rows.
    The legend begins at the axes, or `left` mm from the page's edge.
    """
    # In mm, not as a fraction of the axes: on high axes that would leave the page.
    lifted = ax.transAxes + ScaledTranslation(0.0, lift / 25.4, sheet.sheet_of(ax).dpi_scale_trans)
    page_wide, frame = sheet.size_of(sheet.sheet_of(ax))[0], ax.get_position()
    start = frame.x0 if left is None else (left + sheet.current().indent) / page_wide
    at = ((start - frame.x0) / frame.width, 1.0)
    place = {"loc": "lower left", "bbox_to_anchor": at, "bbox_transform": lifted}
    given = {} if handles is None else {"handles": list(handles)}
    legend = ax.legend(**given, **place | {"ncols": columns} | look)
    if sheet.current().alone and not fit:
        return
    page, per_mm = sheet.sheet_of(ax).bbox, sheet.sheet_of(ax).dpi / 25.4
    while columns > 1 and legend.get_window_extent().x1 > page.x1:
        columns -= 1
        legend = ax.legend(**given, **place | {"ncols": columns} | look)
    _shorten(legend, page.x1)
    over = legend.get_window_extent().y1 + 0.5 * per_mm - page.y1
    if over > 0:
        box = ax.get_position()
        ax.set_position((box.x0, box.y0, box.width, box.height - over / page.height))


def _shorten(legend: Legend, right: float) -> None:
    """Shorten names that would leave the page."""
    for text in legend.get_texts():
        words = text.get_text()
        while len(words) > 4 and "$" not in words and text.get_window_extent().x1 > right:
            words = words[:-2].rstrip(" …") + "…"
            text.set_text(words)


def on_top(
    figure: Figure, handles: Sequence[Artist], left: float, gap: float = 1.5, columns: int = 0
) -> None:
    """Put a legend at the top of the figure, `left` and `gap` mm from its edges; 0: one row."""
    width, height = sheet.size_of(figure)
    place = {"loc": "upper left", "bbox_to_anchor": (left / width, 1 - gap / height)}
    figure.legend(handles=handles, ncols=columns or len(handles), **place)


def below(
    figure: Figure, handles: Sequence[Artist], columns: int, left: float | None = None, **look: Any
) -> Legend:
    """Put a legend 1.5 mm above the figure's lower edge, centred or `left` mm from its edge."""
    width, height = sheet.size_of(figure)
    place, x = ("lower center", 0.5) if left is None else ("lower left", left / width)
    look |= {"loc": place, "bbox_to_anchor": (x, 1.5 / height)}
    return figure.legend(handles=handles, ncols=columns, **look)
