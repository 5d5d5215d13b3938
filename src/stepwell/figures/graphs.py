"""The transition graph: states by the sum of their digits, and what the actuator does between."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Polygon

from stepwell.base import InputError
from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.marks import plain
from stepwell.figures.graph_layout import (
    DOT,
    FoldedGraph,
    FoldedTransition,
    Layout,
    folded,
    followed,
    head,
)

if TYPE_CHECKING:
    from stepwell.sequences import Program, TransitionGraph

MOST_STATES = 64
_DASHES = (3.0, 1.4)
_BOLD, _THIN = 1.9, 0.8
_HALO = 4.2
# What an entry of the key takes [mm].
_ENTRY = 42.0
_FILL, _GREY = "#EEEEEE", "#6A6A6A"
_ASIDE = (0, (2.5, 1.5))


@style.styled
def transition_graph(graph: TransitionGraph, *, program: Program | None = None) -> Figure:
    """States and the ways between them, from all cells at 0 on the left to all at 1 on the right.

    A state with all cells at a stop, or in a phase, is a box with its name, in columns by the sum
    of its digits. A half-way state is a dot, and shown only where turning back leads elsewhere;
    all others are folded into the ways over them.

    Args:
        graph: for any actuator, with at most 64 states without a cell half-way.
        program: a way to be highlighted, its turning points numbered.

    Returns:
        The figure: loading blue and solid, unloading vermillion and dashed, snaps marked, the
        main loop in bold.

    Raises:
        ValueError: too many states, or a program of another chain.

    Source: Mungan and Terzi, 2019, for the main loop and the Garden-of-Eden states.
    """
    count = len(graph.nodes.vertices)
    if count > MOST_STATES:
        raise InputError(
            f"the graph has {count} states: at most {MOST_STATES} can be read in a figure. Export "
            f"it for Graphviz, or pass start= to graph() to see only what is reached from there."
        )
    strokes = [] if program is None else followed(graph, program)
    reduced = folded(graph, [stroke[-1] for stroke in strokes])
    drawing = _Drawing(graph, reduced, Layout(reduced, graph.cells), strokes)
    key = drawing.key(program)
    wide, high = drawing.layout.width, drawing.layout.height
    columns = max(1, int(wide / _ENTRY))
    figure = sheet.blank(wide, high + 4.2 * -(-len(key) // columns) + 2.0)
    ax = sheet.place(figure, 0.0, 0.0, wide, high)
    drawing.draw(ax)
    legends.above(ax, key, columns, bbox_to_anchor=(max(0.015, sheet.indent() / wide), 1.0))
    return figure


def small_graph(graph: TransitionGraph, ax: Axes, width: float, height: float) -> list[Artist]:
    """A transition graph as one of many, its states where those of all the others are.

    Args:
        graph: with at most 64 states without a cell half-way.
        ax: where to; it covers the sheet's width and height.
        width, height: of the axes [mm].

    Returns:
        What its marks mean, for a legend.
    """
    reduced = folded(graph)
    drawing = _Drawing(graph, reduced, Layout(reduced, graph.cells, (width, height)), ())
    drawing.draw(ax)
    return drawing.key()


class _Drawing:
    """One graph, laid out in mm."""

    def __init__(
        self,
        graph: TransitionGraph,
        reduced: FoldedGraph,
        layout: Layout,
        strokes: Sequence[Sequence[str]],
    ):
        self.reduced, self.layout, self.strokes = reduced, layout, strokes
        self.cells = graph.cells
        loop = graph.reading.main_loop
        self.in_loop = {*loop.up, *loop.down}
        self.loop_ways = self._between([loop.up, loop.down])
        self.program_ways = self._between(strokes)
        self.reachable = graph.reachable(loop.up[0])
        self.gardens = set(graph.reading.garden_of_eden or ())

    def draw(self, ax: Axes) -> None:
        """Into axes of its size."""
        plain(ax, (0.0, self.layout.width, 0.0, self.layout.height))
        for way in self.reduced.ways:
            self._draw_way(ax, way)
        for label in self.reduced.shown:
            self._draw_node(ax, label)
        self._draw_turns(ax)

    def _between(self, strokes: Iterable[Sequence[str]]) -> set[tuple[str, str]]:
        """Pairs of shown labels that follow each other on these strokes."""
        shown = set(self.reduced.shown)
        return {
            pair
            for stroke in strokes
            for pair in pairwise(label for label in stroke if label in shown)
        }

    def _draw_way(self, ax: Axes, way: FoldedTransition) -> None:
        curve = self.layout.curve(way)
        known = way.source in self.reachable
        colour = style.direction_colour(way.direction)
        colour = colour if known else style.pale(colour)
        bold = (way.source, way.target) in self.loop_ways
        level = 2.0 + 2.0 * bold + known
        if (way.source, way.target) in self.program_ways:
            ax.plot(*curve.T, color=style.YELLOW, linewidth=_HALO, zorder=1, gid="program")
        dash, gid = ("-", "loading") if way.direction > 0 else ((0, _DASHES), "unloading")
        look = {"color": colour, "linewidth": _BOLD if bold else _THIN, "linestyle": dash}
        look |= {"solid_capstyle": "butt", "dash_capstyle": "butt"}
        ax.plot(*curve.T, **look, zorder=level, gid=gid)
        tip = head(curve, 1.5 + 0.5 * bold)
        ax.add_patch(Polygon(tip, facecolor=colour, linewidth=0, zorder=level + 0.5))
        if way.snaps:
            look = style.hollow(3.2 if bold else 2.6, colour, markeredgewidth=0.9, gid="snaps")
            ax.plot(*curve[len(curve) // 4], "o", **look, zorder=level + 0.6)

    def _draw_node(self, ax: Axes, label: str) -> None:
        (x, y), (half, high) = self.layout.at[label], self.layout.half(label)
        known = label in self.reachable
        if "-" in label and not self.layout.named:
            colour = style.INK if known else style.FAINT
            ax.plot(x, y, "o", markersize=2 * DOT / 25.4 * 72, color=colour, zorder=8, gid="half")
            return
        ends = (self.strokes[0][0], self.strokes[-1][-1]) if self.strokes else ()
        garden, bold = label in self.gardens, label in self.in_loop
        if "-" not in label:
            shape = "square,pad=0" if garden else "round,pad=0,rounding_size=1.2"
            ax.add_patch(
                FancyBboxPatch(
                    (x - half, y - high),
                    2 * half,
                    2 * high,
                    boxstyle=shape,
                    facecolor=style.YELLOW if label in ends else _FILL if known else "white",
                    edgecolor=style.ORANGE if garden else style.INK if known else style.FAINT,
                    linewidth=1.3 if bold or garden else 0.7,
                    linestyle="-" if known else _ASIDE,
                    zorder=8,
                    gid="garden" if garden else "state" if known else "unreachable",
                )
            )
        text = ax.text(
            x,
            y,
            self.layout.name(label),
            ha="center",
            va="center_baseline" if "\n" not in self.layout.name(label) else "center",
            linespacing=1.05,
            fontweight="bold" if bold and "-" not in label else "normal",
            color=style.INK if known and "-" not in label else _GREY,
            zorder=9,
        )
        if "-" in label:
            text.set_bbox(style.on_white())

    def _draw_turns(self, ax: Axes) -> None:
        """Numbers at the turning points of the program."""
        numbers: dict[str, list[str]] = {}
        for k, stroke in enumerate(self.strokes[:-1], 1):
            numbers.setdefault(stroke[-1], []).append(str(k))
        for label, turns in numbers.items():
            (x, y), (half, high) = self.layout.at[label], self.layout.half(label)
            # At the corner of a box, above a dot.
            boxed = "-" not in label
            many = len(turns) > 1
            ax.text(
                x + (half + 0.6 if boxed else 0.0),
                y + high + (1.2 if boxed else 1.9),
                ",".join(turns),
                ha="left" if many and boxed else "center",
                va="center_baseline",
                zorder=10,
                gid="turn",
                **style.on_black(wide=many),
            )

    def key(self, program: Program | None = None) -> list[Artist]:
        """What the marks mean, as far as they occur."""
        ways = self.reduced.ways
        key: list[Artist] = [
            legends.line("loading", style.LOADING, 1.2),
            legends.line("unloading", style.UNLOADING, 1.2, linestyle=(0, _DASHES)),
            legends.line("main loop", width=_BOLD),
        ]
        if any(way.snaps for way in ways):
            look = style.hollow(3.2, marker="o", markeredgewidth=0.9)
            key.append(legends.line("snap", width=_THIN, **look))
        if any("-" in label for label in self.reduced.shown):
            if self.layout.named:
                key.append(legends.mark("cell half-way", "_", 4.2, color=_GREY))
            else:
                key.append(legends.mark("half-way state", size=4.2))
        aside = set(self.reduced.shown) - self.reachable
        zero = "0" * self.cells
        if {label for label in aside if "-" not in label} - self.gardens:
            key.append(_box(style.FAINT, 0.7, f"not reached from {zero}"))
        if self.gardens:
            key.append(_box(style.ORANGE, 1.3, "Garden of Eden"))
        if program is not None:
            label = f"program, {program.start} to {program.to}"
            key.append(legends.line(label, style.YELLOW, _HALO))
        return key


def _box(edge: str, width: float, label: str) -> Artist:
    return legends.shade(label, "white", edgecolor=edge, linewidth=width, linestyle=_ASIDE)
