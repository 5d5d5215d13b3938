"""Transition graphs: of one chain, and the classes of an atlas side by side."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from math import comb
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Polygon
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from stepwell.base import InputError, grouped, number
from stepwell.figures import graph_layout
from stepwell.figures.common import legends, marks, sheet, style
from stepwell.mechanism import Cell, Chain
from stepwell.sequences import Program, TransitionGraph

if TYPE_CHECKING:
    from stepwell.studies import Atlas, GraphClass


MOST_STATES = 64
_DASHES = (3.0, 1.4)
_BOLD, _THIN = 1.9, 0.8
_HALO = 4.2
# Width of a legend entry [mm].
_ENTRY = 42.0
_FILL, _GREY = "#EEEEEE", "#6A6A6A"
_ASIDE = (0, (2.5, 1.5))


@style.styled
def transition_graph(graph: TransitionGraph, *, program: Program | None = None) -> Figure:
    """States and transitions, from all cells at 0 on the left to all cells at 1 on the right.

    A state with all cells at a stop or in a phase is a box, in columns by the sum of its digits. A
    half-way state is a dot, shown only if a reversal there leads to another state; all others are
    merged into their transitions. Loading is blue and solid, unloading vermillion and dashed; snaps
    are marked, and the main loop is bold.

    Args:
        graph: transition graph with at most 64 states without a cell half-way.
        program: stroke program to highlight, with its turning points numbered.

    Raises:
        ValueError: too many states, or a program of another chain.

    Source: Mungan and Terzi, 2019, for the main loop and the Garden-of-Eden states.
    """
    count = len(graph.nodes.vertices)
    if count > MOST_STATES:
        raise InputError(
            f"the graph has {count} states: at most {MOST_STATES} are legible in a figure. Export "
            f"it for Graphviz, or pass start= to graph() for the states reachable from there."
        )
    drawing = _Drawing(graph, program)
    key = drawing.key()
    wide, high = drawing.layout.width, drawing.layout.height
    columns = max(1, int(wide / _ENTRY))
    figure = sheet.blank(wide, high + 4.2 * -(-len(key) // columns) + 2.0)
    ax = sheet.place(figure, 0.0, 0.0, wide, high)
    drawing.draw(ax)
    left = max(0.015, sheet.current().indent / wide)
    legends.above(ax, key, columns, bbox_to_anchor=(left, 1.0))
    return figure


class _Drawing:
    """One graph with a program, or one of many of this size [mm] with common state positions."""

    def __init__(
        self,
        graph: TransitionGraph,
        program: Program | None = None,
        size: sheet.Point | None = None,
    ):
        self.program, self.cells = program, graph.cells
        self.strokes = [] if program is None else graph_layout.followed(graph, program)
        self.reduced = graph_layout.folded(graph, [stroke[-1] for stroke in self.strokes])
        self.layout = graph_layout.GraphLayout(self.reduced, graph.cells, size)
        loop = graph.reading.main_loop
        self.in_loop = {*loop.up, *loop.down}
        self.loop_ways = self._between([loop.up, loop.down])
        self.program_ways = self._between(self.strokes)
        self.reachable = graph.reachable(loop.up[0])
        self.gardens = set(graph.reading.garden_of_eden or ())

    def draw(self, ax: Axes) -> None:
        marks.plain(ax, (0.0, self.layout.width, 0.0, self.layout.height))
        for way in self.reduced.ways:
            self._draw_way(ax, way)
        for label in self.reduced.shown:
            self._draw_node(ax, label)
        self._draw_turns(ax)

    def _between(self, strokes: Iterable[Sequence[str]]) -> set[tuple[str, str]]:
        """Pairs of consecutive shown labels on these strokes."""
        shown = set(self.reduced.shown)
        visible = ([label for label in stroke if label in shown] for stroke in strokes)
        return {pair for labels in visible for pair in pairwise(labels)}

    def _draw_way(self, ax: Axes, way: graph_layout.FoldedTransition) -> None:
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
        tip = graph_layout.head(curve, 1.5 + 0.5 * bold)
        ax.add_patch(Polygon(tip, facecolor=colour, linewidth=0, zorder=level + 0.5))
        if way.snaps:
            look = style.hollow(3.2 if bold else 2.6, colour, markeredgewidth=0.9, gid="snaps")
            ax.plot(*curve[len(curve) // 4], "o", **look, zorder=level + 0.6)

    def _draw_node(self, ax: Axes, label: str) -> None:
        x, y = self.layout.at[label]
        known = label in self.reachable
        if "-" in label and not self.layout.named:
            colour, size = style.INK if known else style.FAINT, 2 * graph_layout.DOT / 25.4 * 72
            ax.plot(x, y, "o", markersize=size, color=colour, zorder=8, gid="half")
            return
        name, boxed = self.layout.name(label), "-" not in label
        if boxed:
            self._draw_box(ax, label)
        look = {
            "fontweight": "bold" if boxed and label in self.in_loop else "normal",
            "color": style.INK if boxed and known else _GREY,
            "bbox": None if boxed else style.on_white(),
            "va": "center_baseline" if "\n" not in name else "center",
        }
        ax.text(x, y, name, ha="center", linespacing=1.05, **look, zorder=9)

    def _draw_box(self, ax: Axes, label: str) -> None:
        (x, y), (half, high) = self.layout.at[label], self.layout.half(label)
        known, garden = label in self.reachable, label in self.gardens
        ends = (self.strokes[0][0], self.strokes[-1][-1]) if self.strokes else ()
        look = {
            "boxstyle": "square,pad=0" if garden else "round,pad=0,rounding_size=1.2",
            "facecolor": style.YELLOW if label in ends else _FILL if known else "white",
            "edgecolor": style.ORANGE if garden else style.INK if known else style.FAINT,
            "linewidth": 1.3 if garden or label in self.in_loop else 0.7,
            "linestyle": "-" if known else _ASIDE,
            "gid": "garden" if garden else "state" if known else "unreachable",
        }
        box = FancyBboxPatch((x - half, y - high), 2 * half, 2 * high, **look, zorder=8)
        ax.add_patch(box)

    def _draw_turns(self, ax: Axes) -> None:
        """Number the turning points of the program."""
        turned = ((stroke[-1], str(k)) for k, stroke in enumerate(self.strokes[:-1], 1))
        for label, turns in grouped(turned).items():
            (x, y), (half, high) = self.layout.at[label], self.layout.half(label)
            # At the corner of a box, above a dot.
            boxed, several = "-" not in label, len(turns) > 1
            x, y = (x + half + 0.6, y + high + 1.2) if boxed else (x, y + high + 1.9)
            look: dict[str, Any] = style.on_black(wide=several) | {"zorder": 10, "gid": "turn"}
            look["ha"] = "left" if several and boxed else "center"
            ax.text(x, y, ",".join(turns), va="center_baseline", **look)

    def key(self) -> list[Artist]:
        """Legend entries for the marks that occur."""
        shown, named, program = set(self.reduced.shown), self.layout.named, self.program
        vertices = {label for label in shown if "-" not in label}
        circle = style.hollow(3.2, marker="o", markeredgewidth=0.9)
        half_way = legends.mark("half-way state", size=4.2)
        if named:
            half_way = legends.mark("cell half-way", "_", 4.2, color=_GREY)
        aside = _box(style.FAINT, 0.7, f"unreachable from {'0' * self.cells}")
        way = f"program, {program.start} to {program.target}" if program is not None else ""
        return legends.applicable(
            (True, legends.line("loading", style.LOADING, 1.2)),
            (True, legends.line("unloading", style.UNLOADING, 1.2, linestyle=(0, _DASHES))),
            (True, legends.line("main loop", width=_BOLD)),
            (any(w.snaps for w in self.reduced.ways), legends.line("snap", width=_THIN, **circle)),
            (shown - vertices, half_way),
            (vertices - self.reachable - self.gardens, aside),
            (self.gardens, _box(style.ORANGE, 1.3, "Garden of Eden")),
            (way, legends.line(way, style.YELLOW, _HALO)),
        )


def _box(edge: str, width: float, label: str) -> Artist:
    return legends.shade(label, "white", edgecolor=edge, linewidth=width, linestyle=_ASIDE)


# Least width of a graph, by number of cells [mm].
_WIDTHS = {1: 36.0, 2: 40.0, 3: 52.0, 4: 80.0}
# Largest number of graphs and of legend entries; width of an entry, height of a row [mm].
_GRAPHS, _ENTRIES, _CLASS_ENTRY, _LINE = 12, 7, 42.0, 3.9
_EDGE, _HEAD, _GAP = 2.0, 8.0, 4.0
# Height of a state in the fullest column [mm].
_STATE = 8.5
_LEFT, _RIGHT, _BOTTOM, _TALL, _BETWEEN = 17.0, 4.0, 11.0, 26.0, 4.5


@style.styled
def graph_classes(atlas: Atlas, most: int = _GRAPHS) -> Figure:
    """The most frequent transition graphs of an atlas, and the fraction and yield of all graphs.

    Cells are numbered in loading order; states have the same positions in all graphs. Plots below
    show, with 95 % intervals, the fraction of designs with each graph, and the yield of its most
    robust design. Two columns wide.

    Args:
        atlas: an atlas of at most 4 cells.
        most: number of graphs to draw.

    Raises:
        ValueError: more than 4 cells, or an atlas without a graph.
    """
    count = len(atlas.chain)
    if count not in _WIDTHS:
        raise InputError(
            f"the atlas has {count} cells: at most {max(_WIDTHS)} are legible; plot a single "
            "graph with transition_graph."
        )
    if not atlas.graph_classes:
        raise InputError("the atlas contains no transition graph yet: compute more designs.")
    shown = atlas.graph_classes[: max(1, most)]
    page = sheet.page_width(style.PAGE)
    room = int((page - 2 * _EDGE + _GAP) / (_WIDTHS[count] + _GAP))
    per_row = max(1, min(len(shown), room))
    wide = (page - 2 * _EDGE - (per_row - 1) * _GAP) / per_row
    # The fullest column has the states with half of the cells at 1.
    tall = 6.0 + _STATE * comb(count, count // 2)
    foot = _BOTTOM + 2 * _TALL + _BETWEEN + 4.0
    columns = max(1, int(page / _CLASS_ENTRY))
    foot += _LINE * -(-_ENTRIES // columns) + 1.5
    pitch = wide + _GAP, _HEAD + tall + _GAP
    high = foot + -(-len(shown) // per_row) * pitch[1]
    figure = sheet.blank(page, high)
    key: dict[str, Artist] = {}
    corners = sheet.grid(len(shown), per_row, pitch, (_EDGE, foot))
    for k, (one, (left, bottom)) in enumerate(zip(shown, corners, strict=True), 1):
        graph = _in_loading_order(one.chain).graph("force" if atlas.drive == "force" else None)
        drawing = _Drawing(graph, size=(wide, tall))
        drawing.draw(sheet.place(figure, left, bottom, wide, tall))
        key |= {str(each.get_label()): each for each in drawing.key()}
        _head(figure, left + 1.0, bottom + tall, k, one)
    _draw_fractions(figure, atlas, len(shown), page)
    corner = ((_EDGE + 1.0) / page, (foot - 1.0) / high)
    figure.legend(handles=[*key.values()], ncols=columns, loc="upper left", bbox_to_anchor=corner)
    return figure


def _in_loading_order(chain: Chain) -> Chain:
    """The same cells in loading order, which for the concave cells of an atlas is that of F0. The
    order of cells in series does not change the behaviour.
    """
    cells = [cell for cell in chain.cells if isinstance(cell, Cell)]
    return replace(chain, cells=tuple(sorted(cells, key=lambda cell: cell.force_0)))


def _head(figure: Figure, x: float, y: float, place: int, one: GraphClass) -> None:
    """Write the rank of a transition graph, its fraction of designs, yield and memory."""
    bold = {"fontweight": "bold", "fontsize": 8.0}
    sheet.text_at(figure, x, y + 3.4, f"{place}", **bold)
    fraction = f"{number(one.fraction.estimate * 100)} % of designs"
    sheet.text_at(figure, x + 5.5, y + 3.4, fraction, **bold, gid="share")
    grey = {"color": "#5A5A5A", "gid": "name"}
    text = f"{one.name}, yield {number(one.kept.estimate * 100)} %"
    sheet.text_at(figure, x + 5.5, y, text, **grey)
    sheet.text_at(figure, x + 5.5, y - 3.1, one.memory, **grey)


def _draw_fractions(figure: Figure, atlas: Atlas, shown: int, page: float) -> None:
    """Draw fractions and yields of all transition graphs, most frequent first."""
    corner, wide = (_LEFT, _BOTTOM), page - _LEFT - _RIGHT
    upper, lower = sheet.stack(figure, corner, wide, [_TALL, _TALL], _BETWEEN)
    ranks = np.arange(1, len(atlas.graph_classes) + 1)
    for ax, colour, fractions in (
        (upper, style.BLUE, [one.fraction for one in atlas.graph_classes]),
        (lower, style.GREEN, [one.kept for one in atlas.graph_classes]),
    ):
        ends = np.array([[each.low, each.high] for each in fractions]) * 100.0
        values = np.array([each.estimate for each in fractions]) * 100.0
        ax.vlines(ranks, *ends.T, color=colour, linewidth=1.0)
        ax.plot(ranks, values, "o", color=colour, markersize=3.2, markeredgewidth=0, gid="classes")
        ax.set_xlim(0.3, len(ranks) + 0.7)
        if shown < len(ranks):
            # After the last graph drawn above.
            ax.axvline(shown + 0.5, color=style.FAINT, linewidth=0.7, linestyle=(0, (2.0, 2.0)))
    upper.set_yscale("log")
    upper.yaxis.set_major_locator(LogLocator(numticks=8))
    upper.yaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
    upper.yaxis.set_minor_formatter(NullFormatter())
    upper.set_ylabel("Designs [%]")
    upper.tick_params(axis="x", labelbottom=False)
    lower.set(
        ylabel="Yield [%]", ylim=(-4.0, 104.0), xlabel="Transition graph, most frequent first"
    )
    if len(ranks) < 20:
        lower.set_xticks(ranks)
    upper.set_xticks(lower.get_xticks())
    upper.set_xlim(*lower.get_xlim())
