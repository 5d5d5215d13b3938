"""The force plane: snap-through against snap-back force of each cell; ranks give the sequence."""

from collections.abc import Sequence
from itertools import pairwise
from operator import itemgetter
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke
from numpy.typing import ArrayLike, NDArray

from stepwell.base import Floats, InputError
from stepwell.figures.common import legends, sheet, style, words
from stepwell.figures.common.words import literal, shortened
from stepwell.mechanism import Chain

MOST_CELLS = 16
_WIDE = 130.0
_ROW = 3.6
# Side of the plane itself [mm].
_LEAST = 28.0
_LEFT, _BOTTOM, _BETWEEN, _RIGHT = 17.0, 10.0, 1.5, 2.0
# Radius, in standard deviations, that contains 95 % of a normal distribution in two dimensions.
_ELLIPSE = 2.4477
_FILL = "#EFEFEF"
_CENTRAL = (2.5, 97.5)
# Least half width of the plane, as a fraction of the mean force.
_ROOM = 0.25
# Characters that a row's name has room for.
_NAME = 9


class _Switch(NamedTuple):
    """Critical forces [N] between two neighbouring phases of a cell: snap-through and snap-back."""

    name: str
    colour: str
    up: float
    down: float


@style.styled
def force_plane(
    chain: Chain,
    *,
    loading: Sequence[int] | None = None,
    unloading: Sequence[int] | None = None,
    region: Sequence[ArrayLike] = (),
    places: ArrayLike | None = None,
    clouds: ArrayLike | None = None,
) -> Figure:
    """F0 against F1 of every cell, feasible anchors, and the loading and unloading orders.

    Cells of one band in tension with negative stiffness load by rising F0 and unload by falling F1.
    With friction f the figure shows F0 + f and F1 - f. An element has one point for each two
    neighbouring phases: its snap-through and snap-back force. The loading order is above the plane,
    the unloading order at its right; each cell has a row, with the central 95 % of its samples as a
    bar. A correct order makes a staircase; the smallest force gap is marked.

    Args:
        chain: up to 16 cells, or 16 transitions of elements.
        loading, unloading: target orders as cell numbers from 0; with elements, numbers of
            transitions, cell by cell. By default the orders of the chain.
        region: closed curves (m, 2) [N] round the feasible pairs (F0, F1) of a cell.
        places: (m, 2) single feasible pairs [N], such as those of drilled holes.
        clouds: (n, N, 2) pairs of the samples of each cell [N]; NaN is left out. Ellipses contain
            95 % of a normal distribution of the same mean and covariance.

    Raises:
        ValueError: too many cells, a panel too narrow, or an order that lacks or repeats a cell.

    Source: sorting theorem, theory page.
    """
    switches = _switches(chain)
    count, colours = len(switches), [switch.colour for switch in switches]
    of = words.force(chain.measure)
    # In drawn units, like everything below.
    forces = np.array([(switch.up, switch.down) for switch in switches]) * of.factor
    up, down = np.argsort(forces * (1, -1), axis=0, kind="stable").T
    orders = _order("loading", loading, up), _order("unloading", unloading, down)
    cloud = None if clouds is None else np.asarray(clouds, float) * of.factor
    strip = _ROW * count + 1.5
    width = sheet.page_width(style.COLUMN if count <= 4 else _WIDE)
    # Names of transitions are longer.
    edge = _LEFT + 3.0 * (count > len(chain))
    side = width - edge - _BETWEEN - strip - _RIGHT
    if side < _LEAST:
        raise InputError(
            f"the force plane of {count} {_counted(chain)} needs {width + _LEAST - side:.0f} mm of "
            f"width, and has {width:.4g} mm."
        )
    step, axis, ends = _smallest_gap(forces, orders)
    gap_label, shade = "smallest force gap", style.pale(style.YELLOW, 0.0)
    if step <= 0:
        gap_label, shade = "order violated by", style.pale(style.VERMILLION, 0.3)
    key = legends.applicable(
        (region, legends.shade("feasible anchors", _FILL, edgecolor=style.FAINT, linewidth=0.8)),
        (places is not None, legends.mark("feasible anchors", ".", 3.0, color=style.FAINT)),
        (cloud is not None, legends.line("95 % of samples", width=1.0)),
    )
    if ends:
        gap_label = f"{gap_label} {abs(step):.3g} {of.sign}"
        key.append(legends.shade(gap_label, shade, alpha=0.6, linewidth=0))
    narrow = width < _WIDE
    columns = 2 if narrow else 3
    height = _BOTTOM + side + _BETWEEN + strip + 4.2 * -(-len(key) // columns) + 3.0
    figure = sheet.blank(width, height)
    ax = sheet.place(figure, edge, _BOTTOM, side, side)
    base = _BOTTOM + side + _BETWEEN
    above = sheet.place(figure, edge, base, side, strip)
    right = sheet.place(figure, edge + side + _BETWEEN, _BOTTOM, strip, side)

    _draw_reachable(ax, region, places, of.factor)
    _draw_clouds(ax, cloud, colours)
    _draw_cells(ax, forces, colours)
    ax.locator_params(nbins=5 if narrow else 8)
    ax.set(xlabel=_name(chain, 0), ylabel=_name(chain, 1))
    if ends:
        # A band across the plane.
        look = {"color": shade, "alpha": 0.6, "linewidth": 0, "gid": "smallest force gap"}
        (ax.axvspan, ax.axhspan)[axis](*ends, **look, zorder=0.5)
    ax.autoscale(False)
    for half, strip_ax in enumerate((above, right)):
        _Order(strip_ax, ax, half, orders[half]).draw(forces, cloud, switches)
    _name_cells(ax, forces, switches)
    middle = {"ha": "center", "va": "center", "rotation": 90}
    sheet.text_at(figure, 3.0, base + strip / 2, "loading", **middle)
    # Centred over a narrow column, the text would leave the page.
    sheet.text_at(figure, width - _RIGHT, 4.8, "unloading", ha="right", va="top")
    legends.above(above, key, columns, left=3.0 if narrow else None)
    return figure


def _switches(chain: Chain) -> list[_Switch]:
    """Transitions of all cells: one fewer than the phases of each; forces include friction."""
    switches: list[_Switch] = []
    colours = style.cell_colours(len(chain))
    for cell, name, colour in zip(chain.cells, chain.names, colours, strict=True):
        pairs = list(pairwise(cell.phases))
        for k, (before, after) in enumerate(pairs):
            numbered = f"{shortened(name, _NAME - 4)} {k}>{k + 1}" if len(pairs) > 1 else name
            up, down = before.force_high + cell.friction, after.force_low - cell.friction
            switches.append(_Switch(numbered, colour, up, down))
    if not switches:
        raise InputError("the chain has no cell with two phases: add a bistable cell.")
    if len(switches) > MOST_CELLS:
        raise InputError(
            f"the chain has {len(switches)} {_counted(chain)}: at most {MOST_CELLS} are legible."
        )
    return switches


def _counted(chain: Chain) -> str:
    return "switches" if chain.elements else "cells"


def _order(name: str, wanted: Sequence[int] | None, own: NDArray[np.intp]) -> tuple[int, ...]:
    order = tuple(int(i) for i in (own if wanted is None else wanted))
    if sorted(order) != list(range(len(own))):
        raise InputError(
            f"{name} = {wanted!r}: must contain each of the cells 0..{len(own) - 1} once, in the "
            f"order of motion."
        )
    return order


def _smallest_gap(
    forces: Floats, orders: tuple[Sequence[int], Sequence[int]]
) -> tuple[float, int, list[float]]:
    """Smallest force gap between neighbours in the orders: size (negative if the order is
    violated), axis and ends; no ends for a single cell.
    """
    steps = (
        ((1 - 2 * k) * float(forces[j, k] - forces[i, k]), k, sorted(forces[[i, j], k].tolist()))
        for k in (0, 1)
        for i, j in pairwise(orders[k])
    )
    return min(steps, key=itemgetter(0), default=(0.0, 0, []))


def _name(chain: Chain, side: int) -> str:
    of = words.force(chain.measure)
    if chain.elements:
        return f"{of.word} {('up to the next phase', 'back down')[side]} [{of.sign}]"
    rubs = ("+f", "-f")[side] if any(cell.friction > 0 for cell in chain.cells) else ""
    return f"$F_{side}{rubs}$, at {side} [{of.sign}]"


def _draw_reachable(
    ax: Axes, region: Sequence[ArrayLike], places: ArrayLike | None, factor: float
) -> None:
    """Draw the feasible force pairs of a cell as an area and as single points."""
    for curve in region:
        points = np.asarray(curve, float) * factor
        ax.add_patch(Polygon(points, facecolor=_FILL, linewidth=0, zorder=0))
        closed = np.concatenate([points, points[:1]])
        ax.plot(*closed.T, color=style.FAINT, linewidth=0.8, zorder=1, gid="region")
    if places is not None:
        pairs = np.asarray(places, float) * factor
        ax.plot(*pairs.T, ".", markersize=2.0, color=style.FAINT, zorder=1, gid="places")


def _draw_cells(ax: Axes, forces: Floats, colours: Sequence[str]) -> None:
    """Draw a dot for each transition and set axis limits with room around all dots."""
    dot = {"markersize": 5.0, "markeredgecolor": "white", "zorder": 6, "gid": "cells"}
    for (x, y), colour in zip(forces.tolist(), colours, strict=True):
        ax.plot(x, y, "o", color=colour, **dot)
    ax.margins(0.12)
    ax.autoscale_view()
    # Without room round a single cell, its tick labels would be too long for the page.
    for middle, (low, high), limit in zip(
        forces.mean(axis=0), (ax.get_xlim(), ax.get_ylim()), (ax.set_xlim, ax.set_ylim), strict=True
    ):
        room = _ROOM * abs(middle)
        limit(min(low, middle - room), max(high, middle + room))


def _name_cells(ax: Axes, forces: Floats, switches: Sequence[_Switch]) -> None:
    # Each name has the colour of its dot and its ellipse.
    named = zip(forces.tolist(), switches, strict=True)
    labels = [legends.Label(at, literal(one.name), one.colour) for at, one in named]
    for text in legends.place_labels(ax, labels, leaders=True):
        text.set_path_effects([withStroke(linewidth=1.6, foreground="white")])


def _draw_clouds(ax: Axes, clouds: Floats | None, colours: Sequence[str]) -> None:
    if clouds is not None:
        for i, colour in enumerate(colours):
            _draw_cloud(ax, clouds[:, i], colour)


def _draw_cloud(ax: Axes, points: Floats, colour: str) -> None:
    """Draw samples as dots, and the ellipse that contains 95 % of them."""
    points = points[np.isfinite(points).all(axis=1)]
    ax.scatter(*points.T, s=0.8, color=colour, alpha=0.35, linewidth=0, zorder=2, rasterized=True)
    if len(points) < 3:
        return
    values, vectors = np.linalg.eigh(np.cov(points.T))
    around = np.linspace(0.0, 2 * np.pi, 73)
    circle = np.column_stack([np.cos(around), np.sin(around)])
    outline = points.mean(axis=0) + _ELLIPSE * circle * np.sqrt(np.maximum(values, 0)) @ vectors.T
    ax.plot(*outline.T, color=colour, linewidth=1.0, zorder=4, gid="cloud")


class _Order(NamedTuple):
    """A strip next to the plane with one row per cell, the first to move on top."""

    ax: Axes
    main: Axes
    side: int
    cells: Sequence[int]

    def draw(self, forces: Floats, cloud: Floats | None, switches: Sequence[_Switch]) -> None:
        """Draw each cell at its force with the range of its samples, and label the rows."""
        ax, main, side, count = self.ax, self.main, self.side, len(self.cells)

        def turned(values: Sequence[float], rows: Sequence[float]) -> Floats:
            return np.array([values, rows] if side == 0 else [rows, values])

        for row, cell in enumerate(self.cells):
            value, colour = float(forces[cell, side]), switches[cell].colour
            if cloud is not None:
                ends = np.nanpercentile(cloud[:, cell, side], _CENTRAL).tolist()
                bar = {"linewidth": 4.0, "solid_capstyle": "butt", "zorder": 2, "gid": "spread"}
                ax.plot(*turned(ends, [row, row]), color=style.pale(colour, 0.45), **bar)
            dot = {"markersize": 3.6, "zorder": 4, "gid": "order"}
            ax.plot(*turned([value], [row]), "o", color=colour, **dot)
            # From the cell's place in the plane to its row.
            lead = {"color": style.FAINT, "linewidth": 0.5, "linestyle": (0, (1, 2)), "zorder": 1}
            last = count - 0.4 if side == 0 else -0.6
            ax.plot(*turned([value, value], [row, last]), **lead)
            end = main.get_ylim()[1] if side == 0 else main.get_xlim()[1]
            main.plot(*turned([value, value], [forces[cell, 1 - side], end]), **lead)
        names = [literal(shortened(switches[i].name, _NAME)) for i in self.cells]
        if side == 0:
            ax.set_xticks(main.get_xticks(), [])
            ax.set(xlim=main.get_xlim(), ylim=(count - 0.4, -0.6))
            ax.set_yticks(range(count), names)
            labels = ax.get_yticklabels()
        else:
            ax.set_yticks(main.get_yticks(), [])
            ax.set(xlim=(-0.6, count - 0.4), ylim=main.get_ylim())
            ax.xaxis.tick_top()
            ax.set_xticks(range(count), names, rotation=90)
            labels = ax.get_xticklabels()
        ax.tick_params(length=0.0, labelsize=7.0, pad=2.0)
        for label, cell in zip(labels, self.cells, strict=True):
            label.set(color=switches[cell].colour, fontweight="bold")
