"""Force and energy of single cells, against lever angle and against travel."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stepwell.base import Floats, InputError
from stepwell.figures.common import legends, marks, sheet, style, words
from stepwell.figures.common.words import literal, minus
from stepwell.mechanism import Cell, Element, Phase

_SAMPLES = 241
# Travel shown past an open end and past a stop, as fractions of the full travel.
_BEYOND, _WALL = 0.08, 0.03
_BOLD, _THIN, _PAST = 2.2, 0.9, 1.5
_DOTS = (0, (1, 1.6))
# Elements share a force axis if its range is at most this factor times that of each.
_FLAT = 4.0
# Least width of the axes of one element, and of a legend entry of several [mm].
_LEAST, _ENTRY = 44.0, 37.0
_COLOUR = style.cell_colours(1)[0]
_PALE = style.pale(_COLOUR)
_SHADE: dict[str, Any] = {"alpha": 0.8, "linewidth": 0}


@style.styled
def element_curve(element: Element, *, source: str = "", ax: Axes | None = None) -> Figure:
    """Force and energy of an element against its travel, with phases and critical forces.

    Phases are shaded, numbered and bold; between them the element is stable only under a prescribed
    travel. Circles mark the critical forces, friction included: snap-through on loading, snap-back
    on unloading. The curve is extrapolated past an open end as a dotted straight line; a stop is
    hatched. Where the curve folds back, arrows mark the snaps at constant travel. Units are those
    of the element's measure.

    Args:
        element: the element to plot.
        source: origin of its curve, printed below the plot.
        ax: axes of the force; by default a new figure of one column's width, with the energy below.
    """
    own = ax is None
    key = element_key([element])
    foot, head = 10.0 + 4.5 * bool(source), 2.5 + 4.0 * -(-len(key) // 2)
    figure, ax = sheet.canvas(
        ax, (style.COLUMN, foot + 74.0 + head), (14.0, foot + 28.0, 2.0, head)
    )
    drawn = _Curve(ax, element)
    drawn.draw_force()
    ax.set_ylabel(drawn.force.label)
    legends.above(ax, key, 2, left=3.0 if own else None)
    if not own:
        ax.set_xlabel(drawn.travel.label)
        drawn.name_fields()
        return figure
    below = sheet.place(figure, 14.0, foot, style.COLUMN - 16.0, 25.0)
    _Curve(below, element).draw_law(element.energy_at, style.MJ)
    below.set(xlabel=drawn.travel.label, ylabel="Energy [mJ]")
    ax.tick_params(labelbottom=False)
    sheet.keep_both_inside(ax, below)
    drawn.name_fields()
    if source:
        sheet.text_at(figure, 2.0, 1.5, literal(source), color=style.FAINT)
    return figure


@style.styled
def element_curves(elements: Mapping[str, Element]) -> Figure:
    """The force curves of several elements over two columns, each as in `element_curve`.

    Args:
        elements: the elements by the titles of their panels.

    Raises:
        ValueError: no elements.
    """
    if not elements:
        raise InputError("elements is empty: give one element or more, by name.")
    page = sheet.page_width(style.PAGE)
    across = min(max(1, int(page / _LEAST)), 3, len(elements))
    each, tall, foot = page / across, 54.0, 7.0
    rows = -(-len(elements) // across)
    key = element_key(elements.values())
    columns, lines = legends.grid_size(len(key), page, _ENTRY)
    foot += 3.8 * (lines - 1)
    figure = sheet.blank(page, rows * tall + foot)
    corners = sheet.grid(len(elements), across, (each, tall), (13.0, 11.0 + foot))
    axes = [sheet.place(figure, *corner, each - 15.0, tall - 17.0) for corner in corners]
    curves = [_Curve(ax, element) for ax, element in zip(axes, elements.values(), strict=True)]
    for curve in curves:
        curve.draw_force()
    low, high = np.transpose([ax.get_ylim() for ax in axes])
    # One force axis, unless a curve would be flat on it or has another unit.
    comparable = len({curve.force for curve in curves}) == 1
    if comparable and np.max(high) - np.min(low) <= _FLAT * np.min(high - low):
        for ax in axes:
            ax.set_ylim(np.min(low), np.max(high))
    for name, curve in zip(elements, curves, strict=True):
        curve.ax.locator_params(nbins=5)
        curve.ax.set(xlabel=curve.travel.label, ylabel=curve.force.label)
        curve.name_fields()
        sheet.name_panel(curve.ax, literal(name))
    legends.below(figure, key, columns)
    return figure


class _Curve:
    """An element on axes, between the travels left and right [m]."""

    def __init__(self, ax: Axes, element: Element):
        self.ax, self.element = ax, element
        self.travel, self.force = words.travel(element.measure), words.force(element.measure)
        past = [(_WALL if stop else _BEYOND) * element.full_travel for stop in element.stopped]
        self.left, self.right = element.low - past[0], element.high + past[1]
        ax.set_xlim(self.left * self.travel.factor, self.right * self.travel.factor)

    def draw_force(self) -> None:
        """Draw the force with its error band, friction, snaps and phases, without force labels."""
        marks.zero_line(self.ax)
        rubs, band = self.element.friction, self.element.error_band
        for number, one in enumerate(self.element.laws):
            travel = np.linspace(one.begin, one.end, _SAMPLES)
            x, force = travel * self.travel.factor, self.element.force_at(travel, number)
            if band:
                low, high = ((force + sign * band) * self.force.factor for sign in (-1, 1))
                look = {"color": _PALE, "zorder": 2, "gid": "error band"}
                self.ax.fill_between(x, low, high, **look | _SHADE)
            for sign, colour in ((1, style.LOADING), (-1, style.UNLOADING)) if rubs else ():
                y = (force + sign * rubs) * self.force.factor
                self.ax.plot(x, y, color=colour, linewidth=_THIN, zorder=2.5, gid="friction")
            self._draw_jumps(number)
        self.draw_law(self.element.force_at, self.force.factor)
        for travel, force, colour in self.fields:
            self.ax.plot(travel, force, "o", **_circle(colour), zorder=7, gid="fields")
        low, high = self.ax.get_ylim()
        # Room for the digits.
        self.ax.set_ylim(low, high + 0.06 * (high - low))
        self._number_phases()

    @property
    def fields(self) -> list[tuple[float, float, str]]:
        """Travel and critical force of each phase end, in drawn units, and the colour."""
        phases, rubs = self.element.phases, self.element.friction
        fields = [(phase.high, phase.force_high + rubs, style.LOADING) for phase in phases[:-1]]
        fields += [(phase.low, phase.force_low - rubs, style.UNLOADING) for phase in phases[1:]]
        return [(s * self.travel.factor, f * self.force.factor, colour) for s, f, colour in fields]

    def name_fields(self) -> None:
        """Label the critical forces, on axes that have their final position."""
        sign = self.force.sign
        names = (
            legends.Label((x, f), minus(f"{f:.3g} {sign}"), colour) for x, f, colour in self.fields
        )
        legends.place_labels(self.ax, names)

    def draw_law(self, law: Callable[[Floats, int], Floats], factor: float) -> None:
        """Draw a law of travel: bold in its phases, dotted past its ends; shade the phases."""
        element = self.element
        low, high = element.low, element.high

        def draw(number: int, begin: float, end: float, **look: Any) -> Floats:
            kinks = element.laws[number].rows[:, 0]
            inside = kinks[(kinks > begin) & (kinks < end)]
            travel = np.unique(np.concatenate([np.linspace(begin, end, _SAMPLES), inside]))
            y = law(travel, number) * factor
            self.ax.plot(travel * self.travel.factor, y, color=_COLOUR, **look)
            return y

        heights = np.concatenate(
            [
                draw(number, one.begin, one.end, linewidth=_THIN, zorder=3, gid="curve")
                for number, one in enumerate(element.laws)
            ]
        )
        for phase in element.phases:
            begin, end = self._shown(phase)
            self._shade(begin, end, {"facecolor": style.PHASE} | _SHADE, "phases")
            draw(phase.sheet, max(begin, low), min(end, high), linewidth=_BOLD, zorder=4)
            past = {"linewidth": _PAST, "linestyle": _DOTS, "zorder": 3, "gid": "extrapolated"}
            for first, last in ((begin, low), (high, end)):
                if first < last:
                    draw(phase.sheet, first, last, **past)
        wall = {"facecolor": "white", "edgecolor": style.FAINT, "hatch": "/////", "linewidth": 0}
        below, above = element.stopped
        for stop, inner, outer in ((below, low, self.left), (above, high, self.right)):
            if stop:
                self._shade(inner, outer, wall, "stop")
                x = inner * self.travel.factor
                self.ax.axvline(x, color=style.INK, linewidth=1.0, zorder=1.5)
        # Curves past the ends do not set the scale.
        least, most = heights.min(), heights.max()
        room = 0.2 * (most - least)
        self.ax.set_ylim(least - room, most + room)

    def _shown(self, phase: Phase) -> tuple[float, float]:
        return max(phase.low, self.left), min(phase.high, self.right)

    def _shade(self, begin: float, end: float, look: dict[str, Any], gid: str) -> None:
        ends = sorted((begin * self.travel.factor, end * self.travel.factor))
        self.ax.axvspan(*ends, **look, zorder=0, gid=gid)

    def _draw_jumps(self, number: int) -> None:
        """Draw arrows from the ends of a sheet to the landings at the same travel."""
        one = self.element.laws[number]
        ends = (one.begin, one.below, style.UNLOADING), (one.end, one.above, style.LOADING)
        for travel, leads, colour in ends:
            if leads is not None:
                x = travel * self.travel.factor
                forces = (self.element.force_at(travel, k) for k in (number, leads))
                start, end = (float(force) * self.force.factor for force in forces)
                look = {"color": colour, "linestyle": marks.SNAP_DASHES, "linewidth": 1.1}
                self.ax.plot([x, x], [start, end], **look, zorder=5, gid="jumps")
                marks.head(self.ax, (x, start), (x, end), colour)

    def _number_phases(self) -> None:
        """Write the digit of each phase at the top, one row lower if it overlaps the last one."""
        look: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "center"}
        row, reached = 0, -np.inf
        look |= {"xycoords": ("data", "axes fraction"), "zorder": 9, "gid": "digit"}
        look |= {"fontweight": "bold", "bbox": style.on_white() | {"facecolor": style.PHASE}}
        for digit, phase in enumerate(self.element.phases):
            begin, end = self._shown(phase)
            row = 1 - row if begin < reached else 0
            reached = max(reached, end)
            at = (begin + end) / 2 * self.travel.factor, 1.0
            self.ax.annotate(str(digit), at, (0.0, -7.0 - 9.0 * row), **look)


def _circle(colour: str) -> dict[str, Any]:
    return style.hollow(4.6, colour, markeredgewidth=1.2, clip_on=False)


def element_key(elements: Iterable[Element]) -> list[Artist]:
    """Legend entries for the lines and marks that occur."""
    shown = list(elements)
    bistable = any(len(element.phases) > 1 for element in shown)
    folds = any(len(element.laws) > 1 for element in shown)
    open_end = not all(stop for element in shown for stop in element.stopped)
    error_band = any(element.error_band for element in shown)
    friction = any(element.friction for element in shown)
    return legends.applicable(
        (True, legends.shade("phase", style.PHASE, **_SHADE)),
        (bistable, legends.mark("snap-through (loading)", **_circle(style.LOADING))),
        (bistable, legends.mark("snap-back (unloading)", **_circle(style.UNLOADING))),
        (folds, legends.line("snap", width=1.1, linestyle=marks.SNAP_DASHES)),
        (open_end, legends.line("extrapolated", _COLOUR, _PAST, linestyle=_DOTS)),
        (error_band, legends.shade("error band", _PALE, **_SHADE)),
        (friction, legends.line("friction", style.LOADING, _THIN)),
    )


Curve = Callable[[Cell, Floats], Floats]

_ANGLES = 181
# Width of a name, and distance between names and marks [mm].
_NAME, _BETWEEN = 35.0, 0.3
_END_0, _END_1, _PEAK = "<", ">", "D"
_GIDS = {_END_0: "end <", _END_1: "end >", _PEAK: "peak"}


@style.styled
def unit_cell_force(cells: Sequence[Cell | Element], *, ax: Axes | None = None) -> Figure:
    """F/(k r) of each cell against lever angle, with F0, F1 and θmax marked.

    k is the stiffness of the cell's stiffest band.

    Args:
        cells: any number; the legend shows the name of each, or else its anchor.
        ax: axes to draw into; a new figure of one column's width by default.

    Raises:
        ValueError: no cells, or an element among them: see `element_curve`.

    Source: Kamp et al. 2024, Fig. 1D.
    """
    return _curves(cells, Cell.force, 1, ax, "Force $F/(kr)$")


@style.styled
def unit_cell_energy(cells: Sequence[Cell | Element], *, ax: Axes | None = None) -> Figure:
    """E/(k r²) of each cell against lever angle, with θmax marked.

    Arguments and errors are those of `unit_cell_force`.

    Source: Kamp et al. 2024, Fig. 1E.
    """
    return _curves(cells, Cell.energy, 2, ax, "Energy $E/(kr^2)$")


def _curves(
    cells: Sequence[Cell | Element], law: Curve, power: int, ax: Axes | None, label: str
) -> Figure:
    """Curves of a law divided by k and this power of r; a force has its ends and zero marked."""
    if not cells:
        raise InputError("cells is empty: give one cell or more.")
    levers: list[Cell] = []
    for i, cell in enumerate(cells):
        if isinstance(cell, Element):
            raise InputError(
                f"cells[{i}] is an Element, which has no lever angle: draw it with element_curve."
            )
        levers.append(cell)

    def curve(cell: Cell, theta: Floats) -> Floats:
        return law(cell, theta) / (max(band.stiffness for band in cell.bands) * cell.lever**power)

    ends = law is Cell.force
    # Names are side by side if there is room; the marks have their own row.
    columns, rows = legends.grid_size(len(levers), sheet.page_width(style.COLUMN), _NAME, 2)
    top = 8.0 + 3.75 * rows
    own = ax is None
    figure, ax = sheet.canvas(ax, (style.COLUMN, 62.0 + top), (13.0, 10.0, 2.0, top))
    looks = list(zip(style.cell_colours(len(levers)), style.cell_dashes(len(levers)), strict=True))
    for cell, (colour, dashes) in zip(levers, looks, strict=True):
        theta = np.linspace(-cell.limit, cell.limit, _ANGLES)
        ax.plot(np.degrees(theta), curve(cell, theta), color=colour, linestyle=dashes)
        _mark(ax, cell, curve, colour, ends=ends)
    if ends:
        marks.zero_line(ax)
    ax.set(xlabel="Lever angle $\\theta$ [°]", ylabel=label)
    widest = math.degrees(max(cell.limit for cell in levers))
    ax.set_xlim(-1.08 * widest, 1.08 * widest)
    ax.set_xticks(np.linspace(-widest, widest, 7) if widest % 3 == 0 else [-widest, 0, widest])
    named = zip(_names(levers), looks, strict=True)
    handles = [legends.line(name, colour, linestyle=dash) for name, (colour, dash) in named]
    legends.above(ax, handles, columns, lift=_explain_marks(ax, ends=ends), handlelength=2.6)
    if own:
        sheet.keep_inside(ax)
    return figure


def _mark(ax: Axes, cell: Cell, curve: Curve, colour: str, *, ends: bool) -> None:
    """Mark the peak of a curve between the stops, and its two ends."""
    shown = [(-cell.limit, _END_0), (cell.limit, _END_1)] if ends else []
    if abs(cell.peak_angle) < cell.limit:
        shown.append((cell.peak_angle, _PEAK))
    for angle, mark in shown:
        at = np.array([angle])
        look = _look(mark, colour) | {"clip_on": False, "gid": _GIDS[mark]}
        ax.plot(np.degrees(at), curve(cell, at), mark, zorder=4, **look)


def _explain_marks(ax: Axes, *, ends: bool) -> float:
    """Add the legend of the marks and return its height above the axes [mm]."""
    symbols = {_END_0: "$F_0$", _END_1: "$F_1$", _PEAK: "$\\theta_\\mathrm{max}$"}
    shown = {mark: symbol for mark, symbol in symbols.items() if ends or mark == _PEAK}
    legends.above(ax, [legends.mark(w, m, **_look(m, style.INK)) for m, w in shown.items()])
    lower = ax.get_legend()
    assert lower is not None
    ax.add_artist(lower)
    # In mm, because the axes may shrink to make room for more rows.
    high = lower.get_window_extent().y1 - ax.get_window_extent().y1
    return 25.4 * high / sheet.sheet_of(ax).dpi + _BETWEEN


def _look(mark: str, colour: str) -> dict[str, Any]:
    if mark == _PEAK:
        return style.hollow(4.0, colour, color=colour)
    return {"markersize": 4.0, "color": colour}


def _names(cells: Sequence[Cell]) -> list[str]:
    letter = "q" if len({cell.bands[0].p for cell in cells}) == 1 else "d"
    names: list[str] = []
    for i, cell in enumerate(cells, 1):
        anchor = f"${letter}$ = {marks.mm_pair(getattr(cell.bands[0], letter))} mm"
        names.append(literal(cell.name) or (anchor if len(cell.bands) == 1 else f"cell {i}"))
    return names
