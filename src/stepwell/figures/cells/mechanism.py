"""Drawings of the mechanism in a sequence of states."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import InputError
from stepwell.figures.cells.linkage import SLACK_DASHES, THICKEST, Drawing
from stepwell.figures.common import legends, marks, reading, style, words
from stepwell.figures.common.sheet import Box, Point, canvas, page_width
from stepwell.mechanism import Chain, Element, layout
from stepwell.sequences import Cycle

# More cells or states are too small to see on a page.
MOST_CELLS = 12
MOST_STATES = 30

# On the page [mm]: between two drawings, above and below each, and for the legend at the bottom.
_BETWEEN, _ABOVE, _BELOW, _KEY = 7.0, 4.8, 7.4, 6.0
# Legend: width of an entry, and height of each row after the first [mm].
_ENTRY, _MORE = 25.0, 3.8
# Least width of a page with the longer legend of a band [mm].
_WIDE = 120.0
# Largest length of the scale bar [mm].
_BAR = 12.0
_LARGEST, _SMALLEST_WANTED = 0.9, 0.21
# Height of a page; drawings shrink to stay within it.
_TALLEST = 270.0

State = str | Sequence[float]
States = Iterable[State] | Cycle


@style.styled
def mechanism(
    chain: Chain, states: States, *, columns: int | None = None, ax: Axes | None = None
) -> Figure:
    """The chain in a sequence of states, with arrows between them and the stroke below each.

    The stroke runs to the right and the fixed block is at the left. Loading proceeds to the right,
    unloading to the left. Every second cell is mirrored across the stroke, which changes no length
    and no force. The thickness of a band shows its tension; a slack band is dashed. An element is a
    box with its force curve and a mark at its travel. A state of a cycle has the travels in the
    middle of its range of the stroke, as in `force_stroke`; any other state of an element is at
    zero or smallest force.

    Args:
        chain: up to 12 cells.
        states: up to 30, each as "010" or as (N,) travels [m]; or a cycle, for its states.
        columns: drawings side by side; by default as many as are legible.
        ax: axes to draw into; a new figure of two columns' width by default.

    Raises:
        ValueError: a state that this chain does not have, or too many cells or states.

    Source: Kamp et al. 2024, Figs. 1A and 2A.
    """
    plan = arrange(chain, states, columns=columns)
    figure, ax = canvas(ax, (plan.width, plan.height), (0.0, 0.0, 0.0, 0.0), rigid=True)
    draw(ax, plan)
    return figure


@dataclass(frozen=True)
class DrawingPlan:
    """Positions of the drawings on a page of this width and height [mm]."""

    linkage: layout.ChainLayout
    # Travel and sheet of every cell, and the title above.
    places: list[list[tuple[float, int | None]]]
    titles: list[str]
    # Whether states of elements are those of a cycle.
    visited: bool
    origins: list[Point]
    scale: float
    bounds: Box
    # Right edge of the outermost block at zero stroke [m drawn].
    rest: float
    # Change of stroke before every drawing but the first: 1 loading, -1 unloading.
    ways: list[int]
    width: float
    height: float


def arrange(
    chain: Chain, states: States, *, columns: int | None = None, tallest: float = _TALLEST
) -> DrawingPlan:
    """Lay the drawings out in rows, if possible within the height `tallest` [mm]."""
    wanted, places, visited = _wanted_places(chain, states)
    travels = [[travel for travel, _ in place] for place in places]
    linkage = layout.ChainLayout(chain, travels)
    left, bottom, right, top = linkage.bounds(travels)
    # The wall of the fixed block is part of the picture.
    left = min(left, -1.7 * linkage.reach)
    wide, high = (right - left) * style.MM, (top - bottom) * style.MM
    strokes = [*map(math.fsum, travels)]
    ways = [1 if b >= a else -1 for a, b in pairwise(strokes)]
    page = page_width(style.PAGE)
    # Entries: cells, the thickness of a band or the marks of states, and a slack band.
    key = _KEY + _MORE * (legends.grid_size(len(chain) + 2, page, _ENTRY)[1] - 1)

    def sized(c: int) -> tuple[list[tuple[int, int]], tuple[bool, bool], float, float]:
        """Cells of the grid, arrows at the left and right edge, scale and height of c columns."""
        grid = _grid(ways, c)
        entered = {(way, column) for way, (_, column) in zip(ways, grid[1:], strict=True)}
        edges = (1, 0) in entered, (-1, c - 1) in entered
        room = page - 4.0 - (c - 1 + sum(edges)) * _BETWEEN
        scale = min(_LARGEST, room / (c * wide))
        return grid, edges, scale, key + (grid[-1][0] + 1) * (high * scale + _ABOVE + _BELOW)

    if columns is None:
        most = 1 + max((len(list(run)) for _, run in groupby(ways)), default=0)
        columns = max((c for c in range(2, most + 1) if sized(c)[2] >= _SMALLEST_WANTED), default=1)
        # Rows are filled evenly.
        columns = math.ceil(most / math.ceil(most / columns))
        while columns < most and sized(columns)[3] > tallest:
            columns += 1
    grid, edges, scale, height = sized(columns)
    row = high * scale + _ABOVE + _BELOW
    step = wide * scale + _BETWEEN
    first = (page - columns * step + _BETWEEN + (edges[0] - edges[1]) * _BETWEEN) / 2
    x, y = first - left * style.MM * scale, height + _BELOW - bottom * style.MM * scale
    origins = [(x + column * step, y - (at + 1) * row) for at, column in grid]
    titles = [_title(chain, state) for state in wanted]
    bounds = left, bottom, right, top
    rest = float(linkage.pose(travels[0]).blocks[-1, 2]) - linkage.unit * strokes[0]
    where = origins, scale, bounds, rest, ways, page, height
    return DrawingPlan(linkage, places, titles, visited, *where)


def _wanted_places(
    chain: Chain, states: States
) -> tuple[list[State], list[list[tuple[float, int | None]]], bool]:
    """The states to draw, travel and sheet of each cell, and whether those are of the cycle."""
    visits: list[reading.Vertex] = []
    if isinstance(states, Cycle):
        visits = [*reading.vertices(states.path)]
        wanted: list[State] = [one.state for one in visits]
    else:
        wanted = list(states)
    refuse_long(chain)
    if not 0 < len(wanted) <= MOST_STATES:
        raise InputError(f"states has {len(wanted)} entries: must be 1 to {MOST_STATES}.")
    if not isinstance(states, Cycle) or not chain.elements:
        return wanted, [_place(chain, state) for state in wanted], False
    at, path = [one.sample for one in visits], states.path
    each = zip(path.travel[at].tolist(), path.sheet[at].tolist(), strict=True)
    return wanted, [[*zip(*row, strict=True)] for row in each], True


def refuse_long(chain: Chain, most: int = MOST_CELLS, reason: str = "can be drawn") -> None:
    """Raise an error if the chain has too many cells to draw; `reason` follows their most."""
    if len(chain) > most:
        raise InputError(
            f"the chain has {len(chain)} cells: at most {most} {reason}; draw a part of it, "
            f"Chain(chain.cells[:{most}])."
        )


def _grid(ways: Sequence[int], columns: int) -> list[tuple[int, int]]:
    """Row and column of every state; `ways` are the directions between states, and each change of
    direction begins a row.
    """
    places = [(0, columns - 1 if ways[:1] == [-1] else 0)]
    for before, way in zip([*ways[:1], *ways], ways, strict=False):
        row, column = places[-1][0], places[-1][1] + way
        if not 0 <= column < columns:
            row, column = row + 1, 0 if way > 0 else columns - 1
        elif way != before:
            row += 1
        places.append((row, column))
    return places


def draw(ax: Axes, plan: DrawingPlan) -> None:
    """Draw all states into axes that become a page in millimetres."""
    marks.plain(ax, (0.0, plan.width, 0.0, plan.height))
    per_metre, linkage = plan.scale * style.MM, plan.linkage
    weight = min(1.0, 0.55 + 0.9 * plan.scale)
    left, bottom, right, top = (b * per_metre for b in plan.bounds)
    slack = False
    stroke_of = words.stroke(linkage.chain.measure)
    drawings = zip([0, *plan.ways], plan.places, plan.titles, plan.origins, strict=True)
    for way, place, title, origin in drawings:
        travels, sheets = zip(*place, strict=True)
        pose = Drawing(ax, linkage, origin, per_metre, weight).move(travels, sheets)
        slack = slack or bool(pose.slack.any())
        middle = origin[0] + (left + right) / 2
        above = {"ha": "center", "va": "bottom", "fontweight": "bold", "fontsize": 8}
        ax.text(middle, origin[1] + top + 1.0, title, **above)
        stroke = math.fsum(travels)
        # Elements rest at numerical roots, so a stroke of rounding errors is set to 0.
        if abs(stroke) < 1e-9 * linkage.chain.full_stroke:
            stroke = 0.0
        # From the outermost block's edge at zero stroke to its current position.
        start = origin[0] + plan.rest * per_metre
        now = start + stroke * linkage.unit * per_metre
        y = origin[1] + bottom - 1.6
        ax.plot([start, start], [y - 0.8, y + 0.8], color=style.INK, linewidth=0.6)
        if now - start > 2.0:
            ax.plot([start, now - 1.0], [y, y], color=style.INK, linewidth=0.6)
            marks.head(ax, (start, y), (now, y), style.INK, size=5)
        ax.text(middle, y - 1.4, stroke_of.value(stroke), ha="center", va="top", fontsize=7)
        if way:
            # An arrow from the previous state, in the direction of the stroke.
            x = origin[0] + (left - _BETWEEN / 2 if way > 0 else right + _BETWEEN / 2)
            y = origin[1] + (bottom + top) / 2
            colour = style.direction_colour(way)
            ends = [x - 2.4 * way, x + 1.0 * way]
            ax.plot(ends, [y, y], color=colour, linewidth=1.6, gid="arrow")
            marks.head(ax, (ends[0], y), (x + 2.6 * way, y), colour, size=9)
    _key(ax, plan, slack)


def _key(ax: Axes, plan: DrawingPlan, slack: bool) -> None:
    linkage, scale = plan.linkage, plan.scale
    handles = legends.cells(linkage.chain.names, 2.0)
    if len(linkage.owner):
        width = " (width of band)" * (plan.width >= _WIDE)
        strongest = f"tension {linkage.greatest_tension():.2f} N{width}"
        handles.append(legends.line(strongest, width=THICKEST * 0.8))
    if plan.visited:
        handles.append(legends.mark(marks.STATE, size=3.4, color=style.INK))
    if slack:
        handles.append(legends.line("slack band", width=0.8, linestyle=SLACK_DASHES))
    columns, _ = legends.grid_size(len(handles), plan.width, _ENTRY)
    legends.above(ax, handles, columns, bbox_to_anchor=(0.02, 0.6 / plan.height))
    if not len(linkage.owner):
        return  # Only elements: the drawing has no length scale.
    # A round length.
    bar, x = marks.round_length(_BAR / scale), plan.width - 4.0
    look = {"color": style.INK, "linewidth": 1.4, "solid_capstyle": "butt", "gid": "scale bar"}
    ax.plot([x - bar * scale, x], [2.4, 2.4], **look)
    ax.text(x - bar * scale - 1.2, 2.4, f"{bar:g} mm", ha="right", va="center")


def _place(chain: Chain, state: State) -> list[tuple[float, int | None]]:
    """Travel and sheet of every cell; None selects the first sheet with this travel."""
    if isinstance(state, str):
        known = [{str(k): phase for k, phase in enumerate(cell)} for cell in chain.phases]
        phases = [own.get(digit) for own, digit in zip(known, state, strict=False)]
        if len(state) != len(chain) or None in phases:
            raise InputError(f"state {state!r}: must be {_state_format(chain)}, innermost first.")
        return [
            (layout.rest_of(cell, phase) if isinstance(cell, Element) else phase.low, phase.sheet)
            for cell, phase in zip(chain.cells, phases, strict=True)
            if phase is not None
        ]
    if len(state) != len(chain):
        raise InputError(f"a state has {len(state)} travels: must be {len(chain)}, one per cell.")
    return [(float(travel), None) for travel in state]


def _state_format(chain: Chain) -> str:
    """Description of the allowed states of this chain."""
    counts = [len(phases) for phases in chain.phases]
    ranges = ", ".join("0" if n == 1 else f"0 to {n - 1}" for n in counts)
    each = "each 0 or 1" if set(counts) == {2} else f"one per cell ({ranges})"
    return f"{len(chain)} characters, {each}"


def _title(chain: Chain, state: State) -> str:
    if isinstance(state, str):
        return state
    travel = words.travel(chain.measure)
    return f"{travel.symbol} = {', '.join(map(travel.number, state))} {travel.sign}"
