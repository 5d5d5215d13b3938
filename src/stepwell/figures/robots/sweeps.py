"""What a robot does when its numbers are varied: gaits, advance and turn."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stepwell.base import Floats, InputError, Quantity
from stepwell.figures.common import legends, marks, sheet, style
from stepwell.figures.common.words import literal, minus

if TYPE_CHECKING:
    from stepwell.simulation import Sweep

Colour = str | tuple[float, float, float]

MOST_KEYS = 8
_COLOURS = (style.BLUE, style.GREEN, style.VERMILLION, style.PURPLE, "#7A6A00", style.INK)
_REST, _STOPPED = "any other", "did not walk to the end"
_LEFT, _RIGHT, _BOTTOM, _TOP = 16.0, 4.0, 12.0, 4.0
# A unit at the end of a key, and tables of a path that have names or need none.
_UNIT = re.compile(
    r"_((?:mm|mN|mNm|mL|ms|kPa|deg|percent|g|N|s|m)(?:_(?:per|s|m|s2|m2|mm|mL|rad|deg|kPa))*)$"
)
_NAMED, _UNNAMED = {"leg", "cell", "antenna"}, {"chain", "band"}
_SYMBOLS = {"p", "q"}
# Keys that by themselves say little.
_WORDS = {"below": "depth", "limit": "angle limit", "link": "length of a link"}
_LINE = 4.2  # a line of the key [mm]


@style.styled
def sweep(found: Sweep) -> Figure:
    """Advance and turn of every robot of a sweep, coloured by the gaits of its legs.

    Args:
        found: a sweep over one key or more; past eight keys the first eight are shown.

    Returns:
        A figure of two columns' width. One key: advance and turn over it. Two: every robot at
        its values, advance and turn as numbers beside it where there is room. More: advance
        over each.

    Raises:
        ValueError: no robots, or nothing that is varied.
    """
    keys = list(found.values)[:MOST_KEYS]
    if not found.trials or not keys:
        raise InputError("the sweep is empty: give one robot or more, and one key or more.")
    shown = _read(found, keys)
    foot = _LINE * len(shown.colours) + 4.0
    layout = _over_one if len(keys) == 1 else _over_two if len(keys) == 2 else _over_many
    figure = layout(shown, foot)
    handles = [legends.mark(literal(gait), color=one) for gait, one in shown.colours.items()]
    legends.below(figure, handles, 1, _LEFT, labelspacing=0.35)
    return figure


class _Shown(NamedTuple):
    """Robots by number: what was varied, what came of it (n,), and the gaits with their colours."""

    values: dict[str, Floats]
    advance: Floats
    turn: Floats
    gaits: NDArray[np.str_]
    colours: dict[str, Colour]


def _over_one(shown: _Shown, foot: float) -> Figure:
    tall = 42.0
    ((key, values),) = shown.values.items()
    figure = sheet.blank(sheet.page_width(style.PAGE), foot + _BOTTOM + 2 * tall + 5.0 + _TOP)
    wide = sheet.page_width(style.PAGE) - _LEFT - _RIGHT
    lower = sheet.place(figure, _LEFT, foot + _BOTTOM, wide, tall)
    upper = sheet.place(figure, _LEFT, foot + _BOTTOM + tall + 5.0, wide, tall)
    _points(upper, values, shown.advance, shown, 0.5)
    _points(lower, values, shown.turn, shown, 2.0)
    upper.set(xlim=lower.get_xlim(), ylabel=r"Displacement $d/u_\mathrm{max}$")
    upper.tick_params(labelbottom=False)
    lower.set(xlabel=axis_words(key), ylabel="Turn to the left [°]")
    return figure


# Width and height of the numbers beside a disc [mm].
_NUMBERS = 9.0, 6.2


def _over_two(shown: _Shown, foot: float) -> Figure:
    tall = 92.0
    figure = sheet.blank(sheet.page_width(style.PAGE), foot + _BOTTOM + tall + _TOP)
    wide = sheet.page_width(style.PAGE) - _LEFT - _RIGHT
    ax = sheet.place(figure, _LEFT, foot + _BOTTOM, wide, tall)
    x, y = shown.values.values()
    columns, rows = (max(2, len(np.unique(one))) for one in (x, y))
    # Discs that nearly touch on a grid; draws are spread like a grid of as many.
    if columns * rows > 4 * len(x):
        columns = rows = max(2, int(np.sqrt(len(x))) * 2)
    size = float(np.clip(min(wide / (columns + 1), tall / (rows + 1)) * 0.55, 1.0, 7.0))
    # Two lines of numbers beside every disc, if they have room.
    roomy = wide / (columns + 1) > size + _NUMBERS[0] and tall / (rows + 1) > _NUMBERS[1]
    points = size * 72 / 25.4
    _discs(ax, x, y, shown, points)
    if roomy:
        look = {"textcoords": "offset points", "va": "center", "linespacing": 1.0}
        for at, d, w in zip(zip(x, y, strict=True), shown.advance, shown.turn, strict=True):
            if np.isfinite(d):
                text = minus(f"{_whole(d, 0.005):.2f}\n{_whole(w, 0.05):.1f}°")
                ax.annotate(text, at, (points / 2 + 2, 0), **look)
        title = r"beside each robot: $d/u_\mathrm{max}$ and turn to the left per cycle"
        ax.set_title(title, fontsize=7.0, loc="right", pad=2.0)
    ax.margins(x=0.5 / columns, y=0.5 / rows)
    if roomy:
        # The numbers beside the last disc stay inside.
        low = ax.get_xlim()[0]
        share = max(0.5 / (columns + 1), (size / 2 + _NUMBERS[0] + 1.0) / wide)
        ax.set_xlim(low, low + (float(np.max(x)) - low) / (1.0 - share))
    xlabel, ylabel = map(axis_words, shown.values)
    ax.set(xlabel=xlabel, ylabel=ylabel)
    return figure


def _over_many(shown: _Shown, foot: float) -> Figure:
    columns = 2 if sheet.page_width(style.PAGE) >= sheet.BESIDE else 1
    rows = -(-len(shown.values) // columns)
    tall = 40.0
    step = tall + _BOTTOM + 3.0
    figure = sheet.blank(sheet.page_width(style.PAGE), foot + rows * step + _TOP)
    wide = (sheet.page_width(style.PAGE) - columns * _LEFT - _RIGHT) / columns
    for i, (key, values) in enumerate(shown.values.items()):
        row, column = divmod(i, columns)
        bottom = foot + _BOTTOM + (rows - 1 - row) * step
        ax = sheet.place(figure, _LEFT + column * (wide + _LEFT), bottom, wide, tall)
        _points(ax, values, shown.advance, shown, 0.5)
        ax.set_xlabel(axis_words(key), fontsize=7.0)
        ax.set_ylabel(r"$d/u_\mathrm{max}$")
    return figure


def axis_words(key: str) -> str:
    """What an axis says of a key path, as in "$q_x$ of outer, left leg [mm]".

    Args:
        key: of a design file, such as "leg.left.chain.cell.outer.q_mm[0]".
    """
    *path, last = key.split(".")
    name, *numbers = last.replace("]", "").split("[")
    unit = _UNIT.search(name)
    word = name[: unit.start()] if unit else name
    if numbers:
        # The last number is a component, one before it counts.
        count = [str(int(n) + 1) for n in numbers[:-1]]
        axis = "xyz"[int(numbers[-1])]
        words = f"${word}_{axis}$" if word in _SYMBOLS else " ".join([word, *count, f"${axis}$"])
    else:
        words = f"${word}$" if word in _SYMBOLS else _WORDS.get(word, word)
    owners: list[str] = []
    tables = iter(path)
    for table in tables:
        one = next(tables, "") if table in _NAMED else ""
        kind = "" if table == "cell" and one != "*" else table
        if table not in _UNNAMED:
            owners.append(literal(f"{one.replace('*', 'every')} {kind}".strip()))
    said = words if "$" in words else literal(words.replace("_", " "))
    said += (" of " if owners else "") + ", ".join(reversed(owners))
    sign = Quantity("", unit[1].replace("_per_", "/").replace("_", " ")).sign if unit else ""
    told = said if said.startswith("$") else said[0].upper() + said[1:]
    return told + (f" [{sign.replace('s2', 's²')}]" if sign else "")


def _points(ax: Axes, x: Floats, y: Floats, shown: _Shown, least: float) -> None:
    marks.zero_line(ax)
    _discs(ax, x, y, shown, 4.5 if len(x) <= 100 else 2.5)
    low, high = float(x.min()), float(x.max())
    gap = 0.03 * (high - low or 1.0)
    ax.set_xlim(low - gap, high + gap)
    # Zero in sight, and no rounding errors blown up to the height of the axes.
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -least), max(high, least))


def _discs(ax: Axes, x: Floats, y: Floats, shown: _Shown, size: float) -> None:
    look = {"markersize": size, "markeredgewidth": 0, "zorder": 3, "gid": "robots"}
    for gait, colour in shown.colours.items():
        some = shown.gaits == gait
        ax.plot(x[some], y[some], "o", color=colour, **look)


def _whole(value: float, least: float) -> float:
    # Nothing is ever minus zero.
    return 0.0 if abs(value) < least else value


def _read(found: Sweep, keys: list[str]) -> _Shown:
    """What is shown of a sweep over these keys.

    Gaits are those of a robot's legs in a line, or one where all are alike. The most frequent have
    a colour of their own; the rest share one and a name.
    """
    gaits: list[str] = []
    for trial in found.trials:
        alike = dict.fromkeys(gait or "none" for gait in trial.gaits)
        words = ", ".join(alike if len(alike) == 1 else trial.gaits)
        gaits.append(_STOPPED if trial.stopped else words)
    often = sorted(set(gaits), key=lambda gait: (-gaits.count(gait), gait))
    known = style.PATHWAY | {_STOPPED: style.FAINT}
    spare = iter(_COLOURS)
    colours: dict[str, Colour] = {
        gait: colour
        for gait in often
        if (colour := known[gait] if gait in known else next(spare, "")) != ""
    }
    if len(often) > len(colours):
        gaits = [gait if gait in colours else _REST for gait in gaits]
        colours[_REST] = style.pale(style.FAINT, 0.5)
    return _Shown(
        {key: np.asarray(found.values[key], float) for key in keys},
        np.array([trial.advance for trial in found.trials]),
        np.degrees([trial.turn for trial in found.trials]),
        np.array(gaits),
        colours,
    )
