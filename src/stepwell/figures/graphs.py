"""Transition graphs: of one chain, and the classes of an atlas side by side."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from math import comb
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Polygon
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from stepwell.base import InputError, number
from stepwell.figures import graph_layout
from stepwell.figures.common import legends, marks, sheet, style
from stepwell.mechanism import Cell

if TYPE_CHECKING:
    from stepwell.mechanism import Chain
    from stepwell.sequences import Program, TransitionGraph
    from stepwell.studies import Atlas, Machine


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
    strokes = [] if program is None else graph_layout.followed(graph, program)
    reduced = graph_layout.folded(graph, [stroke[-1] for stroke in strokes])
    drawing = _Drawing(graph, reduced, graph_layout.Layout(reduced, graph.cells), strokes)
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
    reduced = graph_layout.folded(graph)
    drawing = _Drawing(
        graph, reduced, graph_layout.Layout(reduced, graph.cells, (width, height)), ()
    )
    drawing.draw(ax)
    return drawing.key()


class _Drawing:
    """One graph, laid out in mm."""

    def __init__(
        self,
        graph: TransitionGraph,
        reduced: graph_layout.FoldedGraph,
        layout: graph_layout.Layout,
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
        marks.plain(ax, (0.0, self.layout.width, 0.0, self.layout.height))
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
            colour = style.INK if known else style.FAINT
            ax.plot(
                x,
                y,
                "o",
                markersize=2 * graph_layout.DOT / 25.4 * 72,
                color=colour,
                zorder=8,
                gid="half",
            )
            return
        name, boxed = self.layout.name(label), "-" not in label
        if boxed:
            self._draw_box(ax, label)
        text = ax.text(
            x,
            y,
            name,
            ha="center",
            va="center_baseline" if "\n" not in name else "center",
            linespacing=1.05,
            fontweight="bold" if boxed and label in self.in_loop else "normal",
            color=style.INK if boxed and known else _GREY,
            zorder=9,
        )
        if not boxed:
            text.set_bbox(style.on_white())

    def _draw_box(self, ax: Axes, label: str) -> None:
        (x, y), (half, high) = self.layout.at[label], self.layout.half(label)
        known, garden = label in self.reachable, label in self.gardens
        ends = (self.strokes[0][0], self.strokes[-1][-1]) if self.strokes else ()
        shape = "square,pad=0" if garden else "round,pad=0,rounding_size=1.2"
        ax.add_patch(
            FancyBboxPatch(
                (x - half, y - high),
                2 * half,
                2 * high,
                boxstyle=shape,
                facecolor=style.YELLOW if label in ends else _FILL if known else "white",
                edgecolor=style.ORANGE if garden else style.INK if known else style.FAINT,
                linewidth=1.3 if garden or label in self.in_loop else 0.7,
                linestyle="-" if known else _ASIDE,
                zorder=8,
                gid="garden" if garden else "state" if known else "unreachable",
            )
        )

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
            label = f"program, {program.start} to {program.target}"
            key.append(legends.line(label, style.YELLOW, _HALO))
        return key


def _box(edge: str, width: float, label: str) -> Artist:
    return legends.shade(label, "white", edgecolor=edge, linewidth=width, linestyle=_ASIDE)


# What a graph needs at least, by how many cells it has [mm].
_WIDTHS = {1: 36.0, 2: 40.0, 3: 52.0, 4: 80.0}
# Graphs at most; entries of the key at most, and what one takes [mm].
_GRAPHS, _ENTRIES, _MACHINE_ENTRY, _LINE = 12, 7, 42.0, 3.9
_EDGE, _HEAD, _GAP = 2.0, 8.0, 4.0
# Of a state in the fullest column [mm].
_STATE = 8.5
_LEFT, _RIGHT, _BOTTOM, _TALL, _BETWEEN = 17.0, 4.0, 11.0, 26.0, 4.5


@style.styled
def machines(found: Atlas, most: int = _GRAPHS) -> Figure:
    """The most frequent machines of an atlas as graphs, and the share and yield of all.

    Args:
        found: of at most 4 cells.
        most: graphs that are drawn.

    Returns:
        A figure of two columns' width. Cells are numbered as they load, and states stand at one
        place in all graphs; below, all machines by their share of the designs with its 95 %
        interval, and how many built after their most robust design do the same.

    Raises:
        ValueError: more cells, or an atlas without a machine.
    """
    count = len(found.chain)
    if count not in _WIDTHS:
        raise InputError(
            f"the atlas has {count} cells: graphs of at most {max(_WIDTHS)} can be read side by "
            "side."
        )
    if not found.machines:
        raise InputError("the atlas holds no machine yet: build more designs.")
    shown = found.machines[: max(1, most)]
    page = sheet.page_width(style.PAGE)
    room = int((page - 2 * _EDGE + _GAP) / (_WIDTHS[count] + _GAP))
    beside = max(1, min(len(shown), room))
    rows = -(-len(shown) // beside)
    wide = (page - 2 * _EDGE - (beside - 1) * _GAP) / beside
    # A state for every subset: the fullest column has those of half of the cells.
    tall = 6.0 + _STATE * comb(count, count // 2)
    foot = _BOTTOM + 2 * _TALL + _BETWEEN + 4.0
    columns = max(1, int(page / _MACHINE_ENTRY))
    key_high = _LINE * -(-_ENTRIES // columns) + 1.5
    high = foot + key_high + rows * (_HEAD + tall + _GAP)
    figure = sheet.blank(page, high)
    key: dict[str, Artist] = {}
    for k, one in enumerate(shown):
        row, column = divmod(k, beside)
        left = _EDGE + column * (wide + _GAP)
        bottom = foot + key_high + (rows - 1 - row) * (_HEAD + tall + _GAP)
        ax = sheet.place(figure, left, bottom, wide, tall)
        graph = _as_it_loads(one.chain).graph("force" if found.drive == "force" else None)
        key |= {str(each.get_label()): each for each in small_graph(graph, ax, wide, tall)}
        _head(figure, left + 1.0, bottom + tall, k + 1, one)
    _tell(figure, found, len(shown), page)
    handles = list(key.values())
    figure.legend(
        handles=handles, ncols=columns, loc="upper left",
        bbox_to_anchor=((_EDGE + 1.0) / page, (foot + key_high - 1.0) / high),
    )  # fmt: skip
    return figure


def _as_it_loads(chain: Chain) -> Chain:
    """The same cells in the order in which they load.

    Cells in series share one force, so their places decide nothing; concave ones, and an atlas has
    no others, load in the order of their forces at 0.
    """
    cells = [cell for cell in chain.cells if isinstance(cell, Cell)]
    return replace(chain, cells=tuple(sorted(cells, key=lambda cell: cell.force_0)))


def _head(figure: Figure, x: float, y: float, place: int, one: Machine) -> None:
    """The number of a machine, how often it comes, how surely it is built, what it remembers."""
    sheet.text_at(figure, x, y + 3.4, f"{place}", fontweight="bold", fontsize=8.0)
    share = f"{number(one.share.share * 100)} % of designs"
    sheet.text_at(figure, x + 5.5, y + 3.4, share, fontweight="bold", fontsize=8.0, gid="share")
    grey = {"color": "#5A5A5A", "gid": "name"}
    text = f"{one.name}, yield {number(one.kept.share * 100)} %"
    sheet.text_at(figure, x + 5.5, y, text, **grey)
    sheet.text_at(figure, x + 5.5, y - 3.1, one.memory, **grey)


def _tell(figure: Figure, found: Atlas, shown: int, page: float) -> None:
    """Shares and yields of all machines, most frequent first."""
    wide = page - _LEFT - _RIGHT
    upper = sheet.place(figure, _LEFT, _BOTTOM + _TALL + _BETWEEN, wide, _TALL)
    lower = sheet.place(figure, _LEFT, _BOTTOM, wide, _TALL)
    ranks = np.arange(1, len(found.machines) + 1)
    for ax, colour, shares in (
        (upper, style.BLUE, [one.share for one in found.machines]),
        (lower, style.GREEN, [one.kept for one in found.machines]),
    ):
        ends = np.array([[each.low, each.high] for each in shares]) * 100.0
        values = np.array([each.share for each in shares]) * 100.0
        ax.vlines(ranks, *ends.T, color=colour, linewidth=1.0)
        ax.plot(ranks, values, "o", color=colour, markersize=3.2, markeredgewidth=0, gid="machines")
        ax.set_xlim(0.3, len(ranks) + 0.7)
        _drawn_end(ax, shown, len(ranks))
    upper.set_yscale("log")
    upper.yaxis.set_major_locator(LogLocator(numticks=8))
    upper.yaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
    upper.yaxis.set_minor_formatter(NullFormatter())
    upper.set_ylabel("Designs [%]")
    upper.tick_params(axis="x", labelbottom=False)
    lower.set(ylabel="Yield [%]", ylim=(-4.0, 104.0))
    lower.set_xlabel("Machine, most frequent first")
    if len(ranks) < 20:
        lower.set_xticks(ranks)
    upper.set_xticks(lower.get_xticks())
    upper.set_xlim(*lower.get_xlim())


def _drawn_end(ax: Axes, shown: int, count: int) -> None:
    """Where the machines end that are drawn above."""
    if shown < count:
        ax.axvline(shown + 0.5, color=style.FAINT, linewidth=0.7, linestyle=(0, (2.0, 2.0)))
