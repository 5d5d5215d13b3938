"""Results of studies: each column over its most influential parameter, and all influences."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from stepwell.base import Floats, InputError, Quantity
from stepwell.figures.common import legends, sheet, style
from stepwell.figures.common.style import Colour
from stepwell.figures.common.words import literal, minus, shortened
from stepwell.figures.strips import HEAD, MISSING, ROW, draw_strip, rows_of

if TYPE_CHECKING:
    from stepwell.studies import DecidingNumbers, Influence, Study


_ROW, _HEAD, _FOOT, _RIGHT = 5.2, 10.0, 8.0, 3.0
_LETTER, _MOST = 1.55, 46  # width of a letter of a name [mm], largest number of letters
_WIDEST = 26.0  # widest column [mm]
_FRACTIONS, _SIGNS = "First-order fraction of the variance;", "+ or -: rising or falling trend"
_SENTENCE = 100.0
# White text is more legible than dark text from this fraction on.
_DARK = 0.9


@style.styled
def influences(
    decided: Sequence[DecidingNumbers], names: Mapping[str, str] | None = None
) -> Figure:
    """First-order influence of each parameter on each result of a study.

    Fractions of the variance are shades and numbers, with the sign of the trend; fractions that
    chance could explain are left out. Rows are sorted by their largest fraction. Two columns wide.

    Args:
        decided: the influences that `studies.decided` returns.
        names: names of rows and columns; by default those of the study.

    Raises:
        ValueError: `decided` is empty.
    """
    if not decided:
        raise InputError("decided is empty: influences need a study of 50 designs or more.")
    known = names or {}
    fractions = [{each.name: each for each in one.sure} for one in decided]
    rows = sorted((each.name for each in decided[0].influences), key=partial(_largest, fractions))
    row_names = [shortened(known.get(name, name), _MOST) for name in rows]
    left = 3.0 + _LETTER * max(map(len, row_names))
    tall = _ROW * len(rows)
    page = sheet.page_width(style.PAGE)
    # The explanation takes two lines under narrow columns.
    apart = "\n" if page - left < _SENTENCE else " "
    foot = _FOOT + 3.0 * (apart == "\n")
    figure = sheet.blank(page, _HEAD + tall + foot)
    wide = min(page - left - _RIGHT, _WIDEST * len(decided))
    ax = sheet.place(figure, left, foot, wide, tall)
    ax.set_xlim(-0.5, len(decided) - 0.5)
    style.name_rows(ax, [literal(name) for name in row_names])
    ax.tick_params(axis="x", length=0, labeltop=True, labelbottom=False, pad=1.0)
    names_of = (known.get(one.column, one.column.replace("_", " ")) for one in decided)
    letters = max(6, min(16, int(wide / len(decided) / _LETTER)))
    heads = [shortened(name, letters, 2) for name in names_of]
    ax.set_xticks(range(len(decided)), [literal(head) for head in heads])
    ax.spines[:].set_visible(False)
    for k, own in enumerate(fractions):
        for i, name in enumerate(rows):
            _draw_fraction(ax, k, i, own.get(name))
    sheet.text_at(figure, left, 3.0, minus(f"{_FRACTIONS}{apart}{_SIGNS}"))
    return figure


def _largest(fractions: Sequence[Mapping[str, Influence]], name: str) -> float:
    return -max((own[name].fraction for own in fractions if name in own), default=0.0)


def _draw_fraction(ax: Axes, x: int, y: int, one: Influence | None) -> None:
    """Draw a box, shaded and with the fraction if the parameter has an influence."""
    face = style.pale(style.FAINT, 0.9)
    if one is not None:
        face = style.pale(style.BLUE, 1.0 - one.fraction)
        sign = "" if abs(one.trend) < 0.1 else " +" if one.trend > 0 else " -"
        colour = "white" if one.fraction > _DARK else style.INK
        percent = f"{100 * one.fraction:.0f} %" if one.fraction >= 0.005 else "< 1 %"
        look: dict[str, Any] = {"ha": "center", "va": "center_baseline", "gid": "share"}
        ax.text(x, y, minus(percent + sign), color=colour, **look)
    edge = {"edgecolor": "white", "linewidth": 1.5, "zorder": 0}
    ax.add_patch(Rectangle((x - 0.5, y - 0.5), 1.0, 1.0, facecolor=face, **edge))


# Largest numbers of panels, of points in a panel, and of classes of a bar chart.
_PANELS, _POINTS, _BARS = 8, 3000, 20
_LEFT, _PANEL_RIGHT, _BOTTOM, _TOP, _TALL, _KEY = 19.0, 5.0, 12.0, 4.0, 38.0, 4.2
_EDGE, _LOW = 5.0, 20.0  # at the sides of a strip; height of the lowest panel
# Least width of a page with two panels side by side [mm].
_TWO = 120.0
# Up to this number of different whole numbers, a column is drawn like one of words.
_COUNTS = 6
_NAME = 44
_SHADES = "cividis"


class _Column(NamedTuple):
    """A column to plot: its name with the unit, and its values in that unit, or words."""

    name: str
    values: np.ndarray[Any, Any]
    words: bool


@style.styled
def outcomes(
    study: Study, names: Mapping[str, str] | None = None, columns: Sequence[str] = ()
) -> Figure:
    """Each result over its most influential parameter, or over the plane of two parameters.

    With one varied parameter, words are a strip with a row for each outcome. Its boundaries are
    lines if known in closed form, otherwise grey intervals between two designs. With two varied
    parameters every panel is their plane, coloured by the result. Otherwise numbers are points
    with their means, and words are fractions. Two columns wide.

    Args:
        study: a study with at least one finished chunk.
        names: names of columns; by default those of the study.
        columns: the results to plot; by default all that differ.

    Raises:
        ValueError: no chunk is finished, no parameter varies, or a result that does not differ.
    """
    from stepwell.studies import decided

    varied, results = _varied_and_found(study, names or {})
    results = _selected(results, columns)
    deciding = {one.column: one.influences[0].name for one in decided(study)}
    strips = _strips(study, varied, results)
    shown = [one for one in results.items() if one[0] not in strips][:_PANELS]
    colours = {one.name: _colours(one.values) for _, one in shown if one.words}
    foot = sum(_KEY * (len(each) + 1) for each in colours.values()) + 2.0 * bool(colours)
    page = sheet.page_width(style.PAGE)
    across = 2 if page >= _TWO else 1
    rows = -(-len(shown) // across)
    high = foot + sum(_BOTTOM + one.tall for one in strips.values())
    # On a narrow page, panels are lower.
    room = (style.PAGE_HEIGHT - high) / max(1, rows) - _BOTTOM - _TOP
    panel = min(_TALL, max(_LOW, room))
    high += rows * (_BOTTOM + panel + _TOP)
    figure = sheet.blank(page, high)
    for one in strips.values():
        high -= one.tall
        ax = sheet.place(figure, _EDGE, high, page - 2 * _EDGE, one.tall - HEAD)
        one.draw(ax)
        ax.set_xlabel(literal(shortened(next(iter(varied.values())).name, _NAME)))
        high -= _BOTTOM
    pitch = page / across, _BOTTOM + panel + _TOP
    corners = sheet.grid(len(shown), across, pitch, (_LEFT, foot + _BOTTOM))
    for (name, one), corner in zip(shown, corners, strict=True):
        ax = sheet.place(figure, *corner, pitch[0] - _LEFT - _PANEL_RIGHT, panel)
        own = colours.get(one.name, {})
        if len(varied) == 2:
            x, y = varied.values()
            _plane(ax, x, y, one, own)
        else:
            _over(ax, varied[deciding.get(name, next(iter(study.varied)))], one, own)
        sheet.keep_inside(ax)
    _draw_legend(figure, colours)
    return figure


def _draw_legend(figure: Figure, colours: Mapping[str, Mapping[str, Colour]]) -> None:
    """Draw the words of each column with their colours below the panels."""
    handles: list[Any] = []
    for name, words in colours.items():
        handles.append(legends.mark(literal(name), "", 0.0))
        handles += [legends.mark(literal(shortened(w, 90)), "s", color=c) for w, c in words.items()]
    if handles:
        legends.below(figure, handles, 1, _LEFT, labelspacing=0.35)


class _StripPlan(NamedTuple):
    """A strip to draw, and its height [mm] with its title."""

    tall: float
    draw: Callable[[Axes], None]


def _strips(
    study: Study, varied: Mapping[str, _Column], results: Mapping[str, _Column]
) -> dict[str, _StripPlan]:
    """The strips of the columns of words, if only one parameter is varied."""
    from stepwell.studies import intervals

    runs = intervals(study)
    strips: dict[str, _StripPlan] = {}
    for name in (name for name in results if any(run.column == name for run in runs)):
        one, (by,) = results[name], varied.values()
        own = [run for run in runs if run.column == name]
        known = np.isfinite(by.values)
        designs = {
            word or MISSING: by.values[known & (one.values == word)] for word in {*one.values}
        }
        designs = {word: values for word, values in designs.items() if len(values)}
        tall = HEAD + ROW * len(rows_of(own, designs.get(MISSING, np.empty(0))))
        colours = _colours(one.values)
        draw = partial(draw_strip, title=one.name, runs=own, colours=colours, designs=designs)
        strips[name] = _StripPlan(tall, draw)
    return strips


def _varied_and_found(
    study: Study, names: Mapping[str, str]
) -> tuple[dict[str, _Column], dict[str, _Column]]:
    """The numbers that vary, and the results that differ."""
    from stepwell.studies import SCREEN_COLUMNS

    chunks = study.done_chunks()
    columns = {name: _column(study, name, chunks, names) for name in study.columns}
    varied = {name: columns[name] for name in study.varied}
    if not varied or not len(next(iter(varied.values())).values):
        raise InputError("the study is empty: compute at least one design, with one parameter.")
    aside = {*study.varied, *SCREEN_COLUMNS, "problem"}
    results = {name: one for name, one in columns.items() if name not in aside and _differs(one)}
    if not results:
        raise InputError("all designs have the same results: vary a parameter with an influence.")
    return varied, results


def _selected(results: dict[str, _Column], columns: Sequence[str]) -> dict[str, _Column]:
    """The results of these names; all if there are none."""
    for unknown in [name for name in columns if name not in results]:
        raise InputError(f"{unknown!r}: not a result that differs: use {', '.join(results)}.")
    return {name: results[name] for name in columns or results}


def _column(study: Study, name: str, chunks: Sequence[int], names: Mapping[str, str]) -> _Column:
    unit, factor = study.display_unit(name)
    values = study.values(name, chunks)
    sign = Quantity("", unit).sign
    head = names.get(name) or (f"{name} [{sign}]" if sign else name)
    if name not in study.varied and name not in names:
        head = head[:1].upper() + head[1:].replace("_", " ")
    if study.columns[name] == "text":
        words = np.array([*map(str, values)], object)
        if study.work.screen:
            # Only designs drawn at random are a sample; a screen's choice is not.
            words[study.values("lot", chunks) != 1] = ""
        return _Column(head, words, True)
    # Over one parameter, counts are a curve.
    if len(study.varied) > 1 and name not in study.varied and not sign and _few_counts(values):
        return _Column(head, np.array([f"{one:.0f}" for one in values], object), True)
    return _Column(head, values * factor, False)


def _few_counts(values: Floats) -> bool:
    # Whether values are few whole numbers, such as numbers of snaps.
    levels = np.unique(values)
    return len(levels) <= _COUNTS and bool(np.all(np.isfinite(levels)) and np.all(levels % 1 == 0))


def _differs(one: _Column) -> bool:
    if one.words:
        return len({*one.values} - {""}) > 1
    values = one.values[np.isfinite(one.values)]
    return len(values) > 1 and np.ptp(values) > 1e-12 * np.max(np.abs(values))


def _colours(words: np.ndarray[Any, Any]) -> dict[str, Colour]:
    often = Counter(filter(None, words)).most_common()
    return style.word_colours([word for word, _ in often], style.PATHWAY)


def _over(ax: Axes, by: _Column, one: _Column, colours: Mapping[str, Colour]) -> None:
    """Draw a result over one parameter."""
    ax.set_xlabel(literal(shortened(by.name, _NAME)))
    if one.words:
        _fractions(ax, by.values, one, colours)
        return
    ax.set_ylabel(literal(shortened(one.name, 24)))
    known = np.isfinite(by.values) & np.isfinite(one.values)
    x, y = by.values[known], one.values[known]
    some = np.unique(np.linspace(0, len(x) - 1, min(len(x), _POINTS)).astype(int))
    many = len(some) > 60
    look = {
        "color": style.pale(style.BLUE, 0.5) if many else style.BLUE,
        "markeredgewidth": 0,
        "gid": "designs",
    }
    look |= {"markersize": 1.6 if many else 3.2, "rasterized": len(some) > 300}
    ax.plot(x[some], y[some], "o", **look)
    # Counts have whole ticks.
    ax.locator_params(axis="y", integer=bool(np.all(y % 1 == 0)))
    ax.ticklabel_format(axis="y", scilimits=(-3, 4))
    if many:
        _, of = _classes(x)
        counts = np.bincount(of)
        means = [(np.bincount(of, v) / np.maximum(counts, 1))[counts > 0] for v in (x, y)]
        ax.plot(*means, color=style.INK, linewidth=1.1, gid="means")


def _classes(x: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Class limits and the class of each design: classes of equal size, or one per value if there
    are few values.
    """
    levels = np.unique(x)
    if len(levels) <= _BARS:
        between = (levels[1:] + levels[:-1]) / 2
        reach = (levels[1] - levels[0]) / 2 if len(levels) > 1 else 0.5
        ends = np.array([levels[0] - reach, *between, levels[-1] + reach])
    else:
        count = min(_BARS, max(2, len(x) // 25))
        ends = np.unique(np.quantile(x, np.linspace(0.0, 1.0, count + 1)))
    return ends, np.clip(np.searchsorted(ends, x, "right") - 1, 0, len(ends) - 2)


def _fractions(ax: Axes, x: Floats, one: _Column, colours: Mapping[str, Colour]) -> None:
    """Draw the fractions of a result's words in each class of a parameter as stacked bars."""
    present = (one.values != "") & np.isfinite(x)
    words = one.values[present]
    ends, of = _classes(x[present])
    counts = np.bincount(of, minlength=len(ends) - 1)
    foot = np.zeros(len(ends) - 1)
    known = np.array([word if word in colours else style.REST for word in words], object)
    for word, colour in colours.items():
        times = np.bincount(of[known == word], minlength=len(ends) - 1)
        fraction = 100.0 * times / np.maximum(counts, 1)
        look = {"color": colour, "edgecolor": colour, "linewidth": 0.3, "gid": "shares"}
        ax.bar(ends[:-1], fraction, np.diff(ends), foot, align="edge", **look)
        foot += fraction
    ax.set(xlim=(ends[0], ends[-1]), ylim=(0.0, 100.0))
    ax.set_ylabel(f"{literal(shortened(one.name, 16))}: designs [%]")


def _plane(ax: Axes, x: _Column, y: _Column, one: _Column, colours: Mapping[str, Colour]) -> None:
    """Draw a result in the plane of two parameters."""
    ax.set(xlabel=literal(shortened(x.name, _NAME)), ylabel=literal(shortened(y.name, 24)))
    columns, rows = (max(2, len(np.unique(axis.values))) for axis in (x, y))
    grid = columns * rows <= 4 * len(x.values)
    if not grid:
        columns = rows = max(2, int(np.sqrt(len(x.values)) * 1.5))
    box = ax.get_window_extent()
    size = 72.0 / ax.figure.dpi * min(box.width / (columns + 0.5), box.height / (rows + 0.5))
    look: dict[str, Any] = {"marker": "s" if grid else "o", "linewidths": 0, "gid": "designs"}
    look["s"] = float(np.clip(0.9 * size, 1.5, 14.0)) ** 2
    if one.words:
        for word, colour in colours.items():
            rest = word == style.REST
            some = [w == word or (rest and w and w not in colours) for w in one.values]
            ax.scatter(x.values[some], y.values[some], color=colour, **look)
    else:
        known = np.isfinite(one.values)
        at = x.values[known], y.values[known]
        points = ax.scatter(*at, c=one.values[known], cmap=_SHADES, **look)
        bar = ax.figure.colorbar(points, ax=ax, pad=0.02, aspect=14)  # pyright: ignore[reportAttributeAccessIssue]
        bar.set_label(literal(shortened(one.name, 24)))
        bar.outline.set_visible(False)
    ax.margins(x=0.6 / columns, y=0.6 / rows)
