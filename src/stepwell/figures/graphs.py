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
    all others are folded into the ways over them. Loading is blue and solid, unloading vermillion
    and dashed; snaps are marked, and the main loop is bold.

    Args:
        graph: for any actuator, with at most 64 states without a cell half-way.
        program: a way to be highlighted, its turning points numbered.

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
    """One graph with a program, or as one of many of this size [mm] with its states where those of
    all the others are.
    """

    def __init__(
        self,
        graph: TransitionGraph,
        program: Program | None = None,
        size: sheet.Point | None = None,
    ):
        self.program, self.cells = program, graph.cells
        self.strokes = [] if program is None else graph_layout.followed(graph, program)
        self.reduced = graph_layout.folded(graph, [stroke[-1] for stroke in self.strokes])
        self.layout = graph_layout.Layout(self.reduced, graph.cells, size)
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
        """Pairs of shown labels that follow each other on these strokes."""
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
        """Numbers at the turning points of the program."""
        turned = ((stroke[-1], str(k)) for k, stroke in enumerate(self.strokes[:-1], 1))
        for label, turns in grouped(turned).items():
            (x, y), (half, high) = self.layout.at[label], self.layout.half(label)
            # At the corner of a box, above a dot.
            boxed, many = "-" not in label, len(turns) > 1
            x, y = (x + half + 0.6, y + high + 1.2) if boxed else (x, y + high + 1.9)
            look: dict[str, Any] = style.on_black(wide=many) | {"zorder": 10, "gid": "turn"}
            look["ha"] = "left" if many and boxed else "center"
            ax.text(x, y, ",".join(turns), va="center_baseline", **look)

    def key(self) -> list[Artist]:
        """What the marks mean, as far as they occur."""
        shown, named, program = set(self.reduced.shown), self.layout.named, self.program
        vertices = {label for label in shown if "-" not in label}
        circle = style.hollow(3.2, marker="o", markeredgewidth=0.9)
        half_way = legends.mark("half-way state", size=4.2)
        if named:
            half_way = legends.mark("cell half-way", "_", 4.2, color=_GREY)
        aside = _box(style.FAINT, 0.7, f"not reached from {'0' * self.cells}")
        way = f"program, {program.start} to {program.target}" if program is not None else ""
        return legends.those(
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

    Cells are numbered as they load, and states stand at one place in all graphs; below, all
    machines by their share of the designs with its 95 % interval, and how many built after their
    most robust design do the same. Two columns wide.

    Args:
        found: of at most 4 cells.
        most: graphs that are drawn.

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
    wide = (page - 2 * _EDGE - (beside - 1) * _GAP) / beside
    # A state for every subset: the fullest column has those of half of the cells.
    tall = 6.0 + _STATE * comb(count, count // 2)
    foot = _BOTTOM + 2 * _TALL + _BETWEEN + 4.0
    columns = max(1, int(page / _MACHINE_ENTRY))
    foot += _LINE * -(-_ENTRIES // columns) + 1.5
    pitch = wide + _GAP, _HEAD + tall + _GAP
    high = foot + -(-len(shown) // beside) * pitch[1]
    figure = sheet.blank(page, high)
    key: dict[str, Artist] = {}
    corners = sheet.grid(len(shown), beside, pitch, (_EDGE, foot))
    for k, (one, (left, bottom)) in enumerate(zip(shown, corners, strict=True), 1):
        graph = _as_it_loads(one.chain).graph("force" if found.drive == "force" else None)
        drawing = _Drawing(graph, size=(wide, tall))
        drawing.draw(sheet.place(figure, left, bottom, wide, tall))
        key |= {str(each.get_label()): each for each in drawing.key()}
        _head(figure, left + 1.0, bottom + tall, k, one)
    _tell(figure, found, len(shown), page)
    corner = ((_EDGE + 1.0) / page, (foot - 1.0) / high)
    figure.legend(handles=[*key.values()], ncols=columns, loc="upper left", bbox_to_anchor=corner)
    return figure


def _as_it_loads(chain: Chain) -> Chain:
    """The same cells in the order in which they load: their places decide nothing, and concave
    ones, of which an atlas is made, load in the order of their forces at 0.
    """
    cells = [cell for cell in chain.cells if isinstance(cell, Cell)]
    return replace(chain, cells=tuple(sorted(cells, key=lambda cell: cell.force_0)))


def _head(figure: Figure, x: float, y: float, place: int, one: Machine) -> None:
    """The number of a machine, how often it comes, how surely it is built, what it remembers."""
    bold = {"fontweight": "bold", "fontsize": 8.0}
    sheet.text_at(figure, x, y + 3.4, f"{place}", **bold)
    share = f"{number(one.share.share * 100)} % of designs"
    sheet.text_at(figure, x + 5.5, y + 3.4, share, **bold, gid="share")
    grey = {"color": "#5A5A5A", "gid": "name"}
    text = f"{one.name}, yield {number(one.kept.share * 100)} %"
    sheet.text_at(figure, x + 5.5, y, text, **grey)
    sheet.text_at(figure, x + 5.5, y - 3.1, one.memory, **grey)


def _tell(figure: Figure, found: Atlas, shown: int, page: float) -> None:
    """Shares and yields of all machines, most frequent first."""
    corner, wide = (_LEFT, _BOTTOM), page - _LEFT - _RIGHT
    upper, lower = sheet.stack(figure, corner, wide, [_TALL, _TALL], _BETWEEN)
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
        if shown < len(ranks):
            # Where the machines end that are drawn above.
            ax.axvline(shown + 0.5, color=style.FAINT, linewidth=0.7, linestyle=(0, (2.0, 2.0)))
    upper.set_yscale("log")
    upper.yaxis.set_major_locator(LogLocator(numticks=8))
    upper.yaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
    upper.yaxis.set_minor_formatter(NullFormatter())
    upper.set_ylabel("Designs [%]")
    upper.tick_params(axis="x", labelbottom=False)
    lower.set(ylabel="Yield [%]", ylim=(-4.0, 104.0), xlabel="Machine, most frequent first")
    if len(ranks) < 20:
        lower.set_xticks(ranks)
    upper.set_xticks(lower.get_xticks())
    upper.set_xlim(*lower.get_xlim())
