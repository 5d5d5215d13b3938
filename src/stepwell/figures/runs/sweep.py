"""What a robot does when its numbers are varied: gaits, advance and turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from stepwell.base import InputError
from stepwell.figures.common import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    PAGE,
    PATHWAY,
    PURPLE,
    VERMILLION,
    blank,
    literal,
    marks,
    pale,
    place,
    styled,
)
from stepwell.sequences import Pathway

if TYPE_CHECKING:
    from stepwell.simulation import Sweep

Array = NDArray[np.float64]
Colour = str | tuple[float, float, float]

MOST_KEYS = 8
_COLOURS = (BLUE, GREEN, VERMILLION, PURPLE, "#7A6A00", INK)
_REST, _STOPPED = "any other", "did not walk to the end"
_MINUS = "\N{MINUS SIGN}"
_LEFT, _RIGHT, _BOTTOM, _TOP = 16.0, 4.0, 12.0, 4.0
_LINE = 4.2  # a line of the key [mm]


@styled
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
    gaits = _gaits(found)
    colours = _coloured(gaits)
    values = {key: np.asarray(found.values[key], float) for key in keys}
    advance = np.array([trial.advance for trial in found.trials])
    turn = np.degrees([trial.turn for trial in found.trials])
    foot = _LINE * len(colours) + 4.0
    if len(keys) == 1:
        figure = _over_one(keys[0], values[keys[0]], advance, turn, gaits, colours, foot)
    elif len(keys) == 2:
        figure = _over_two(values, advance, turn, gaits, colours, foot)
    else:
        figure = _over_many(values, advance, gaits, colours, foot)
    handles = [
        Line2D(
            [], [], linestyle="none", marker="o", markersize=4.5, color=colour, label=literal(gait)
        )
        for gait, colour in colours.items()
    ]
    figure.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(_LEFT / PAGE, 2.0 / (figure.get_figheight() * 25.4)),
        labelspacing=0.35,
    )
    return figure


def _over_one(
    key: str,
    values: Array,
    advance: Array,
    turn: Array,
    gaits: list[str],
    colours: dict[str, Colour],
    foot: float,
) -> Figure:
    tall = 42.0
    figure = blank(PAGE, foot + _BOTTOM + 2 * tall + 5.0 + _TOP)
    wide = PAGE - _LEFT - _RIGHT
    lower = place(figure, _LEFT, foot + _BOTTOM, wide, tall)
    upper = place(figure, _LEFT, foot + _BOTTOM + tall + 5.0, wide, tall)
    for ax, what, name in (
        (upper, advance, "Displacement $d/u_\\mathrm{max}$"),
        (lower, turn, "Turn to the left [°]"),
    ):
        _points(ax, values, what, gaits, colours)
        ax.set_ylabel(name)
    _least(upper, 0.5)
    _least(lower, 2.0)
    upper.tick_params(labelbottom=False)
    upper.set_xlim(lower.get_xlim())
    lower.set_xlabel(literal(key))
    return figure


def _over_two(
    values: dict[str, Array],
    advance: Array,
    turn: Array,
    gaits: list[str],
    colours: dict[str, Colour],
    foot: float,
) -> Figure:
    across, up = values
    tall = 92.0
    figure = blank(PAGE, foot + _BOTTOM + tall + _TOP)
    wide = PAGE - _LEFT - _RIGHT
    ax = place(figure, _LEFT, foot + _BOTTOM, wide, tall)
    x, y = values[across], values[up]
    columns, rows = (max(2, len(np.unique(one))) for one in (x, y))
    # Discs that nearly touch on a grid; draws are spread like a grid of as many.
    if columns * rows > 4 * len(x):
        columns = rows = max(2, int(np.sqrt(len(x))) * 2)
    size = float(np.clip(min(wide / (columns + 1), tall / (rows + 1)) * 0.55, 1.0, 7.0))
    for gait, colour in colours.items():
        some = np.array([one == gait for one in gaits])
        ax.plot(x[some], y[some], "o", markersize=size * 72 / 25.4, color=colour,
                markeredgewidth=0, gid="robots")  # fmt: skip
    room = columns <= 10 and rows <= 14
    if room:
        for place_x, place_y, d, w in zip(x, y, advance, turn, strict=True):
            if np.isfinite(d):
                text = f"{_whole(d, 0.005):.2f}\n{_whole(w, 0.05):.1f}°".replace("-", _MINUS)
                ax.annotate(text, (place_x, place_y),
                            (size * 72 / 25.4 / 2 + 2, 0), textcoords="offset points", va="center",
                            fontsize=6.0, linespacing=1.0)  # fmt: skip
        ax.set_title("beside each robot: $d/u_\\mathrm{max}$ and turn to the left per cycle",
                     fontsize=7.0, loc="right", pad=2.0)  # fmt: skip
    ax.margins(x=0.5 / columns, y=0.5 / rows)
    ax.set_xlabel(literal(across))
    ax.set_ylabel(literal(up))
    return figure


def _over_many(
    values: dict[str, Array],
    advance: Array,
    gaits: list[str],
    colours: dict[str, Colour],
    foot: float,
) -> Figure:
    rows = -(-len(values) // 2)
    tall = 40.0
    step = tall + _BOTTOM + 3.0
    figure = blank(PAGE, foot + rows * step + _TOP)
    wide = (PAGE - 2 * _LEFT - _RIGHT) / 2
    for i, (key, numbers) in enumerate(values.items()):
        row, column = divmod(i, 2)
        bottom = foot + _BOTTOM + (rows - 1 - row) * step
        ax = place(figure, _LEFT + column * (wide + _LEFT), bottom, wide, tall)
        _points(ax, numbers, advance, gaits, colours)
        _least(ax, 0.5)
        ax.set_xlabel(literal(key), fontsize=7.0)
        ax.set_ylabel("$d/u_\\mathrm{max}$")
    return figure


def _points(ax: Axes, x: Array, y: Array, gaits: list[str], colours: dict[str, Colour]) -> None:
    marks.zero_line(ax)
    size = 4.5 if len(x) <= 100 else 2.5
    for gait, colour in colours.items():
        some = np.array([one == gait for one in gaits])
        ax.plot(x[some], y[some], "o", markersize=size, color=colour, zorder=3,
                markeredgewidth=0, gid="robots")  # fmt: skip
    low, high = float(x.min()), float(x.max())
    gap = 0.03 * (high - low or 1.0)
    ax.set_xlim(low - gap, high + gap)


def _least(ax: Axes, least: float) -> None:
    """Zero in sight, and no rounding errors blown up to the height of the axes."""
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -least), max(high, least))


def _whole(value: float, least: float) -> float:
    # Nothing is ever minus zero.
    return 0.0 if abs(value) < least else value


def _gaits(found: Sweep) -> list[str]:
    """The legs' gaits of each robot in a line; one where all are alike."""
    gaits: list[str] = []
    for trial in found.trials:
        if trial.stopped:
            gaits.append(_STOPPED)
            continue
        alike = dict.fromkeys(gait or "none" for gait in trial.gaits)
        gaits.append(", ".join(alike if len(alike) == 1 else trial.gaits))
    return gaits


def _coloured(gaits: list[str]) -> dict[str, Colour]:
    """A colour for each gait, the most frequent first; the rest share one.

    What has no colour of its own is renamed in the list.
    """
    often = sorted(set(gaits), key=lambda gait: (-gaits.count(gait), gait))
    # The pathways of two cells look as on a transition map.
    known = {one.value: PATHWAY[one.name] for one in Pathway if one is not Pathway.OTHER}
    known[_STOPPED] = FAINT
    spare = iter(_COLOURS)
    colours: dict[str, Colour] = {
        gait: colour
        for gait in often
        if (colour := known[gait] if gait in known else next(spare, "")) != ""
    }
    if len(often) > len(colours):
        gaits[:] = [gait if gait in colours else _REST for gait in gaits]
        colours[_REST] = pale(FAINT, 0.5)
    return colours
