"""Recordings of unit cells, pairs and bands, with the fitted models."""

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D

from stepwell.base import Floats, InputError, grouped
from stepwell.figures.cells.cell_curves import element_curve, element_key
from stepwell.figures.common import legends, marks, sheet, style, words
from stepwell.figures.common.style import FAINT
from stepwell.lab import (
    BandTest,
    Calibration,
    CellTest,
    ChainTest,
    Choice,
    MeasuredElement,
    PairTest,
    Recording,
    half_cycles,
)

T = TypeVar("T")

_POINTS = 16
# Legend: height of one row with margins and of each further row, and width of an entry [mm].
_KEY, _ROW, _ENTRY = 8.0, 3.8, 33.0
# Colour and mark by number of bands.
_LOOKS = ((style.BLUE, "o"), (style.VERMILLION, "^"), (style.GREEN, "s"))
_MEASURED = 2.6
_MODEL: dict[str, Any] = {"color": style.INK, "linewidth": 0.8, "linestyle": (0, (4, 3))}


@style.styled
def measured_forces(tests: Sequence[CellTest]) -> Figure:
    """F/(k r) of measured unit cells against lever angle, with the model as a line.

    Full marks are measured, hollow marks are extrapolated to a stop; k is the stiffness of all
    bands of a cell. Two columns wide.

    Args:
        tests: one or more; tests of one configuration share a panel.

    Raises:
        ValueError: no tests.

    Source: after Kamp et al. 2024, Fig. 1D.
    """

    def curves(test: CellTest) -> tuple[Floats, Floats]:
        return test.plain.force / test.series.scale, test.model / test.series.scale

    return _cells(tests, curves, "Force $F/(kr)$")


@style.styled
def measured_energies(tests: Sequence[CellTest]) -> Figure:
    """E/(k r²) of measured unit cells from state 0 on against lever angle, the model as a line.

    Arguments and errors are those of `measured_forces`.

    Source: after Kamp et al. 2024, Fig. 1E.
    """

    def curves(test: CellTest) -> tuple[Floats, Floats]:
        energy, scale = test.cell.energy(test.plain.theta), test.series.scale * test.cell.lever
        return test.plain.energy / scale, (energy - energy[0]) / scale

    return _cells(tests, curves, "Energy $E/(kr^2)$")


@style.styled
def measured_pairs(tests: Sequence[PairTest | ChainTest]) -> Figure:
    """Actuator force of measured pairs or chains against stroke, with model and snaps.

    The measured mean has its baseline subtracted (blue loading, vermillion unloading) and is pale
    outside the range of comparison. Triangles mark the measured snaps, above, and the snaps of the
    model, below. Two columns wide.

    Args:
        tests: one or more, one panel each.

    Raises:
        ValueError: no tests.

    Source: after Kamp et al. 2024, Fig. 2D to 2G.
    """
    if not tests:
        raise InputError("tests is empty: give one pair or more.")
    occur = sorted({"unloading" if test.series.unloading else "loading" for test in tests})
    handles = [
        *(legends.line(f"measured, {way}", _WAYS[way], _MEASURED) for way in occur),
        Line2D([], [], **_MODEL, label="model"),
        *_triangles("snap, measured", occur),
        legends.mark("snap, model", "^", **style.hollow(4.0)),
    ]
    sizes = (2, 52.0, 15.0, 19.0, 17.0)
    return _panels(tests, _pair, sizes, handles, "Stroke $u$ [mm]", "Actuator force [N]")


_WAYS = {"loading": style.LOADING, "unloading": style.UNLOADING}


def _triangles(label: str, occur: Sequence[str]) -> list[Artist]:
    """Legend entries of the triangles of each direction that occurs."""
    both = len(occur) > 1
    names = {way: f"{label.partition(',')[0]}, {way}" if both else label for way in occur}
    return [legends.mark(names[way], "v", 4.0, color=_WAYS[way]) for way in occur]


def _cells(
    tests: Sequence[CellTest], curves: Callable[[CellTest], tuple[Floats, Floats]], label: str
) -> Figure:
    """Panels of the measured and the modelled values that `curves` returns for a test."""
    if not tests:
        raise InputError("tests is empty: give one unit cell or more.")
    groups = grouped(((test.series.code, test.series.unloading), test) for test in tests)

    def draw(ax: Axes, group: list[CellTest]) -> None:
        _cell(ax, group, [curves(test) for test in group])

    handles: list[Artist] = [legends.line("model")]
    for count in sorted({test.series.bands for test in tests}):
        colour, mark = _LOOKS[(count - 1) % len(_LOOKS)]
        name = f"{count} band{'s' * (count > 1)}"
        handles.append(legends.mark(name, mark, 3.2, color=colour))
    handles.append(legends.mark("extrapolated", **style.hollow(3.2)))
    sizes = (3, 50.0, 16.0, 18.5, 16.0)
    return _panels(list(groups.values()), draw, sizes, handles, "Lever angle $\\theta$ [°]", label)


def _panels(
    shown: Sequence[T],
    draw: Callable[[Axes, T], None],
    sizes: tuple[int, float, float, float, float],
    handles: Sequence[Artist],
    xlabel: str,
    ylabel: str,
) -> Figure:
    """Panels in rows under a legend. `sizes` are the panels per row, and in mm the height of a row,
    the left margin of a panel, and the difference of panel and axes in width and height.
    """
    most, tall, left, narrower, lower = sizes
    page = sheet.page_width(style.PAGE)
    columns = max(1, round(most * page / style.PAGE))
    wide = page / columns
    legend_columns, below = legends.grid_size(len(handles), page - left, _ENTRY)
    rows = math.ceil(len(shown) / columns)
    figure = sheet.blank(page, rows * tall + _KEY + _ROW * (below - 1))
    legends.on_top(figure, handles, left, 2.0, columns=legend_columns)
    corners = sheet.grid(len(shown), columns, (wide, tall), (left, 10.0))
    for k, (one, corner) in enumerate(zip(shown, corners, strict=True)):
        ax = sheet.place(figure, *corner, wide - narrower, tall - lower)
        draw(ax, one)
        if k + columns >= len(shown):
            ax.set_xlabel(xlabel)
        if k % columns == 0:
            ax.set_ylabel(ylabel)
    return figure


def _cell(ax: Axes, group: list[CellTest], curves: list[tuple[Floats, Floats]]) -> None:
    marks.zero_line(ax)
    for test, (values, _) in zip(group, curves, strict=True):
        colour, mark = _LOOKS[(test.series.bands - 1) % len(_LOOKS)]
        theta = np.degrees(test.plain.theta)
        at = np.linspace(0, len(theta) - 1, _POINTS).astype(int)
        seen = test.plain.inside[at]
        look = {"markersize": 3.2, "markeredgewidth": 0.8, "color": colour, "zorder": 4}
        for k, gid, face in ((at[seen], "measured", colour), (at[~seen], "extrapolated", "white")):
            ax.plot(theta[k], values[k], mark, **look, markerfacecolor=face, gid=gid)
    # In units of k r, the model does not depend on the number of bands.
    first = group[0]
    ax.plot(np.degrees(first.plain.theta), curves[0][1], color=style.INK, gid="model")
    widest = math.degrees(first.cell.limit)
    ax.set_xlim(-1.08 * widest, 1.08 * widest)
    ax.set_xticks([-widest, 0, widest])
    ax.margins(y=0.1)
    way = ", unloading" if first.series.unloading else ""
    place_of = marks.mm_pair(first.cell.bands[0].d)
    sheet.name_panel(ax, f"{words.literal(first.series.code)}{way}, $d$ = {place_of} mm")


def _pair(ax: Axes, test: PairTest | ChainTest) -> None:
    colour = style.UNLOADING if test.series.unloading else style.LOADING
    u = test.stroke * style.MM
    marks.zero_line(ax)
    # The measurement is wide, so that it stays visible under a coincident model.
    wide = {"linewidth": _MEASURED, "solid_capstyle": "butt"}
    ax.plot(u, test.force, color=style.pale(colour), **wide, gid="not judged")
    ax.plot(u, np.where(test.inside, test.force, np.nan), color=colour, **wide, gid="measured")
    ax.plot(u, test.model, **_MODEL, gid="model")
    low, high = ax.get_ylim()
    span = high - low
    ax.set_ylim(low - 0.12 * span, high + 0.12 * span)
    seen = [style.MM * snap for snaps in test.snaps for snap in snaps]
    wanted = [style.MM * snap for snap in test.snaps_predicted]
    above, below = [high + 0.06 * span] * len(seen), [low - 0.06 * span] * len(wanted)
    ax.plot(seen, above, "v", color=colour, markersize=4.0, zorder=5, gid="snaps")
    ax.plot(wanted, below, "^", **style.hollow(4.0), zorder=5, gid="snaps predicted")
    mechanism = test.series.name.removesuffix(", loading").removesuffix(", unloading")
    order = ": tie" if test.tie else ""
    if isinstance(test, PairTest) and not test.tie:
        order = f": {' then '.join(test.names(test.shown))}"
    sheet.name_panel(ax, words.literal(f"{mechanism}{order}"))


@style.styled
def recording(result: Recording) -> Figure:
    """Force [N] against the stroke of the testing machine [mm] of one recording.

    Loading and unloading halves have their colours. One column wide.
    """
    figure, ax = sheet.canvas(None, (style.COLUMN, 62.0), (14.0, 10.0, 2.0, 10.0))
    ways: dict[str, Line2D] = {}
    for half in result.halves:
        way = result.direction_of(half)
        look = {"color": style.direction_colour(1 if way == "loading" else -1), "linewidth": 1.0}
        (line,) = ax.plot(result.stroke[half] * style.MM, result.force[half], label=way, **look)
        ways.setdefault(way, line)
    ax.set(xlabel="Stroke of the testing machine [mm]", ylabel="Force [N]")
    legends.above(ax, ways.values())
    figure.text(0.98, 0.965, words.literal(result.name), ha="right", va="top")
    return figure


_MOST_PANELS, _MOST_POINTS = 12, 4000
_POINTS_OF_HALF = 120  # of a measured element; more would hide its curve


@style.styled
def recordings(results: Sequence[Recording]) -> Figure:
    """Force against stroke of the first 12 recordings, a panel each, with the jumps of the force.

    Loading and unloading halves have their colours. Two columns wide.

    Raises:
        ValueError: no recordings.
    """
    if not results:
        raise InputError("results is empty: give one recording or more.")

    def draw(ax: Axes, result: Recording) -> None:
        marks.zero_line(ax)
        for half, cycle in zip(result.halves, half_cycles(result), strict=True):
            colour = style.direction_colour(1 if cycle.direction == "loading" else -1)
            step = max(1, (half.stop - half.start) // _MOST_POINTS)
            u, force = result.stroke[half][::step] * style.MM, result.force[half][::step]
            ax.plot(u, force, color=colour, linewidth=0.8)
            at = np.array([snap.stroke for snap in cycle.snaps])
            order = np.argsort(u)
            there = np.interp(at * style.MM, u[order], force[order])
            ax.plot(at * style.MM, there, "v", color=colour, markersize=4.0, gid="jumps")
        sheet.name_panel(ax, words.literal(result.name))

    occur = sorted({result.direction_of(half) for result in results for half in result.halves})
    handles: list[Artist] = [legends.line(way, _WAYS[way]) for way in occur]
    handles += _triangles("jump", occur)
    sizes = (3 if len(results) > 2 else 2, 50.0, 16.0, 18.5, 16.0)
    return _panels(results[:_MOST_PANELS], draw, sizes, handles, "Stroke [mm]", "Force [N]")


@style.styled
def measured_element(result: MeasuredElement) -> Figure:
    """Force against travel of a measured element: its points over the curve, phases numbered.

    Points of loading and unloading have their colours; of a half, at most 120 are drawn. One
    column wide.
    """
    ways = [way for way in _WAYS if len(getattr(result, way))]
    measure = result.element.measure
    factors = words.travel(measure).factor, words.force(measure).factor
    key = element_key([result.element])
    head = 2.5 + 4.0 * -(-(len(key) + len(ways)) // 2)
    figure, ax = sheet.canvas(None, (style.COLUMN, 64.0 + head), (14.0, 10.0, 2.0, head))
    element_curve(result.element, ax=ax)
    for way in ways:
        rows = getattr(result, way)[:: 1 + len(getattr(result, way)) // _POINTS_OF_HALF]
        look = {"color": _WAYS[way], "markersize": 1.8, "markeredgewidth": 0.0, "zorder": 4.5}
        key += ax.plot(*(rows * factors).T, "o", **look, label=f"measured, {way}")
    legends.above(ax, key, 2, left=3.0)
    return figure


# A colour and a dash for each law; either is unique.
_BAND_LOOKS = {
    "linear": (style.BLACK, (0, ())),
    "neo-Hookean": (style.ORANGE, (0, (5, 1.5))),
    "cubic": (style.BLUE, (0, (3, 1, 1, 1))),
    "Ogden": (style.VERMILLION, (0, (1, 1))),
    "Yeoh": (style.PURPLE, (0, (7, 2, 1, 2))),
}

_TALL = 76.0  # height of each panel with margins [mm]
_READINGS = 40  # largest number of readings of a half drawn as marks
_WINDOW: dict[str, Any] = {"color": FAINT, "linewidth": 0.7, "linestyle": (0, (2, 2))}


@style.styled
def band_laws(test: BandTest, choice: Choice) -> Figure:
    """Force against stroke of tension tests, and the residual of each force law in the fit window.

    The left panel shows every cycle, used cycles in green. The right panel shows the residual [mN]
    of each law from the mean of the samples, the chosen law drawn wider. Two columns wide.
    """
    page = sheet.page_width(style.PAGE)
    side_by_side = page >= sheet.SIDE_BY_SIDE
    figure = sheet.blank(page, _TALL if side_by_side else 2 * _TALL)
    boxes = [(14.0, 11.0, 66.0, 55.0), (98.0, 11.0, 78.0, 55.0)]
    if not side_by_side:
        boxes = [(14.0, low, page - 18.0, 55.0) for low in (11.0 + _TALL, 11.0)]
    left, right = (sheet.place(figure, *box) for box in boxes)
    used = set(map(id, test.used))
    for loop in sorted(test.loops, key=lambda loop: id(loop) in used):
        mine = id(loop) in used
        colour = style.GREEN if mine else style.pale(FAINT, 0.4)
        for u, force in ((loop.stroke, loop.force), (loop.back_stroke, loop.back_force)):
            look = {"color": colour, "linewidth": 0.7, "markersize": 2.5}
            look["marker"] = "o" if len(u) <= _READINGS else ""
            step = max(1, len(u) // 400)
            left.plot(u[::step] * style.MM, force[::step], **look)
    for edge in test.window:
        left.axvline(edge * style.MM, **_WINDOW)
    left.set(xlabel="Stroke of the grips [mm]", ylabel="Tension [N]")
    handles = [legends.line("used", style.GREEN), legends.line("not used", style.pale(FAINT, 0.4))]
    legends.above(left, [*handles, Line2D([], [], **_WINDOW, label="fit window")])
    marks.zero_line(right)
    curves = [test.curve(sample) for sample in test.samples]
    stroke = curves[0][0]
    force = np.mean([np.interp(stroke, u, f) for u, f in curves], axis=0)
    for candidate in choice.candidates:
        colour, dash = _BAND_LOOKS[candidate.law.name]
        residual = (force - candidate.fitted.tension(stroke)) * style.MM
        name, wide = (" (chosen)", 2.0) if candidate is choice.chosen else ("", 1.0)
        look = {"color": colour, "linestyle": dash, "linewidth": wide}
        right.plot(stroke * style.MM, residual, **look, label=candidate.law.name + name)
    right.set(xlabel="Stroke of the grips [mm]", ylabel="Residual (measured - law) [mN]")
    right.margins(y=0.1)
    legends.above(right, columns=3 if side_by_side else 2, columnspacing=1.0, handlelength=2.4)
    return figure


_SYMBOLS = {
    "rest_length": "$\\ell_0$",
    "quadratic": "$a_2$",
    "cubic": "$a_3$",
    "loss": "$h$",
    "loss_length": "$c$",
    "friction": "$f$",
    "joints": "$\\mu$",
    "travel": "$\\lambda$",
    "start_loading": "$u_+$",
    "start_unloading": "$u_-$",
}
_MARKS = "o^sDv"
_COLOURS = style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE
_RIGHT = 94.0  # left edge of the map of correlations [mm]
_BAR = 23.0  # width of its colour bar at the right if the map is below the errors [mm]


@style.styled
def calibration(result: Calibration) -> Figure:
    """Error of every geometry, fitted and left out, and the correlations of the parameters.

    The left panel shows the RMSE in units of k r: hollow marks for the fit, full marks for the
    prediction from the other geometries. The right panel is a map of the correlations with their
    values. Two columns wide.
    """
    geometries = sorted({sample.geometry for sample in result.samples})
    page = sheet.page_width(style.PAGE)
    side_by_side = page >= sheet.SIDE_BY_SIDE
    columns = 2 if side_by_side else 1
    head = 6.0 + 3.7 * len(result.kinds) * 2 / columns
    high = 4.0 + 7.0 * max(len(geometries), len(result.parameters))
    if side_by_side:
        side, wide, start, below, letters = min(66.0, high), 52.0, _RIGHT, 0.0, 1.15
        bottom = 11.0 + (high - side) / 2
    else:
        side = min(66.0, page - 12.0 - _BAR)
        wide, start, below, bottom, letters = page - 30.0, 12.0, side + 14.0, 9.0, 1.0
    figure = sheet.blank(page, 11.0 + high + head + below)
    left = sheet.place(figure, 24.0, 11.0 + below, wide, high)
    _draw_errors(left, result, geometries)
    legends.above(left, columns=columns, columnspacing=1.0)
    right = sheet.place(figure, start, bottom, side, side)
    image = _draw_correlations(right, result, letters * side)
    bar = sheet.place(figure, start + side + 3.0, bottom, 2.5, side)
    figure.colorbar(image, cax=bar)
    bar.set_ylabel("Correlation [1]")
    return figure


def _draw_errors(ax: Axes, result: Calibration, geometries: Sequence[tuple[float, float]]) -> None:
    """Draw a row per geometry: hollow marks for the fit, full marks for the prediction."""
    for n, (bands, pair) in enumerate(result.kinds):
        colour, mark = _COLOURS[n % len(_COLOURS)], _MARKS[n % len(_MARKS)]
        kinds = [(sample.bands, sample.in_pair) for sample in result.samples]
        at = [k for k, kind in enumerate(kinds) if kind == (bands, pair)]
        off = 0.16 * (n - (len(result.kinds) - 1) / 2)
        rows = [geometries.index(result.samples[k].geometry) + off for k in at]
        name = f"{'pairs' if pair else 'cells'}, {bands} band{'s' * (bands > 1)}"
        style = {"linestyle": "none", "marker": mark, "markersize": 4.0, "color": colour}
        fit, left_out = np.array(result.fit_error)[at], np.array(result.left_out_error)[at]
        ax.plot(fit, rows, markerfacecolor="white", label=f"{name}, fit", **style)
        ax.plot(left_out, rows, label=f"{name}, left out", **style)
    ax.set_yticks(range(len(geometries)), [*map(marks.mm_pair, geometries)])
    ax.set(xlabel="RMSE [$kr$]", ylabel="$d = q - p$ [mm]")
    ax.set_xlim(left=0.0)
    ax.grid(axis="y", color=FAINT, linewidth=0.3)
    ax.invert_yaxis()


def _draw_correlations(ax: Axes, result: Calibration, letters: float) -> AxesImage:
    """Draw the correlations as colours, with values below the diagonal. `letters` is the sum of the
    font sizes in a row.
    """
    names = [_symbol(p.name) for p in result.parameters]
    image = ax.imshow(result.correlations, vmin=-1, vmax=1, cmap="PuOr")
    look = {"ha": "center", "va": "center", "fontsize": min(7.0, letters / len(names))}
    for (i, j), value in np.ndenumerate(result.correlations):
        if j < i:
            colour = "white" if abs(value) > 0.6 else style.INK
            ax.text(j, i, _hundredths(float(value)), color=colour, gid="correlation", **look)
    ax.set_xticks(range(len(names)), names)
    ax.set_yticks(range(len(names)), names)
    ax.tick_params(length=0)
    return image


def _hundredths(value: float) -> str:
    """A correlation with its sign, without the zero before the point, to be short."""
    # Nothing is ever minus zero.
    text = f"{round(value, 2) + 0.0:.2f}".replace("1.00", "1")
    return words.minus(text.replace("0.", ".", 1) if abs(value) < 0.995 else text)


def _symbol(name: str) -> str:
    if name.startswith("stiffness_"):
        count, _, pair = name.removeprefix("stiffness_").partition("_")
        return f"$k_{{{count}}}{chr(39) * bool(pair)}$"
    return _SYMBOLS[name]
