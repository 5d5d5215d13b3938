"""Tension tests of bands, what a fit makes of them, and recordings as they are."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from stepwell.figures.common import legends, marks, sheet
from stepwell.figures.common.marks import mm_pair
from stepwell.figures.common.style import (
    BLACK,
    BLUE,
    COLUMN,
    FAINT,
    GREEN,
    INK,
    MM,
    ORANGE,
    PAGE,
    PURPLE,
    VERMILLION,
    direction_colour,
    pale,
    styled,
)
from stepwell.figures.common.words import literal, minus
from stepwell.figures.measured import bands_words
from stepwell.lab import BandTest, Calibration, Choice, Recording


@styled
def recording(result: Recording) -> Figure:
    """Force against stroke of one recording, loading and unloading halves in their colours.

    Args:
        result: any recording.

    Returns:
        A figure of one column's width: force [N] against the stroke of the machine [mm].
    """
    figure, ax = sheet.canvas(None, (COLUMN, 62.0), (14.0, 10.0, 2.0, 10.0))
    shown: set[str] = set()
    for half in result.halves:
        way = result.direction_of(half)
        label = "_" if way in shown else way
        shown.add(way)
        colour = direction_colour(1 if way == "loading" else -1)
        ax.plot(
            result.stroke[half] * MM, result.force[half], color=colour, linewidth=1.0, label=label
        )
    ax.set(xlabel="Stroke of the machine [mm]", ylabel="Force [N]")
    legends.above(ax)
    figure.text(0.98, 0.965, literal(result.name), ha="right", va="top")
    return figure


# A colour and a dash for each law, so that either alone tells them apart.
_LOOKS = {
    "linear": (BLACK, (0, ())),
    "neo-Hookean": (ORANGE, (0, (5, 1.5))),
    "cubic": (BLUE, (0, (3, 1, 1, 1))),
    "Ogden": (VERMILLION, (0, (1, 1))),
    "Yeoh": (PURPLE, (0, (7, 2, 1, 2))),
}

_TALL = 76.0  # tests and laws, each with its surroundings [mm]
_READINGS = 40  # of a half, up to which each is drawn
_WINDOW: dict[str, Any] = {"color": FAINT, "linewidth": 0.7, "linestyle": (0, (2, 2))}


@styled
def band_laws(test: BandTest, choice: Choice) -> Figure:
    """Force against stroke of tension tests, and what each force law leaves inside the window.

    Args:
        test: the tension tests.
        choice: their force laws.

    Returns:
        A figure of a page's width. On the left every cycle, those used in green; on the right the
        residual [mN] of each law from the mean of the samples, the chosen one drawn wider.
    """
    page = sheet.page_width(PAGE)
    beside = page >= sheet.BESIDE
    figure = sheet.blank(page, _TALL if beside else 2 * _TALL)
    left = sheet.place(
        figure, 14.0, 11.0 + (not beside) * _TALL, 66.0 if beside else page - 18.0, 55.0
    )
    used = set(map(id, test.used))
    for loop in sorted(test.loops, key=lambda loop: id(loop) in used):
        mine = id(loop) in used
        for u, force in ((loop.stroke, loop.force), (loop.back_stroke, loop.back_force)):
            colour = GREEN if mine else pale(FAINT, 0.4)
            step = max(1, len(u) // 400)
            look = {"color": colour, "linewidth": 0.7, "markersize": 2.5}
            marker = "o" if len(u) <= _READINGS else ""
            left.plot(u[::step] * MM, force[::step], marker=marker, **look)
    for edge in test.window:
        left.axvline(edge * MM, **_WINDOW)
    left.set(xlabel="Stroke of the grips [mm]", ylabel="Tension [N]")
    handles = [legends.line("used", GREEN), legends.line("not used", pale(FAINT, 0.4))]
    legends.above(left, [*handles, Line2D([], [], **_WINDOW, label="window")])

    right = sheet.place(
        figure, 98.0 if beside else 14.0, 11.0, 78.0 if beside else page - 18.0, 55.0
    )
    marks.zero_line(right)
    curves = [test.curve(sample) for sample in test.samples]
    stroke = curves[0][0]
    force = np.mean([np.interp(stroke, u, f) for u, f in curves], axis=0)
    for candidate in choice.candidates:
        colour, dash = _LOOKS[candidate.law.name]
        residual = (force - candidate.fitted.tension(stroke)) * MM
        name, wide = (" (chosen)", 2.0) if candidate is choice.chosen else ("", 1.0)
        look = {"color": colour, "linestyle": dash, "linewidth": wide}
        right.plot(stroke * MM, residual, **look, label=candidate.law.name + name)
    right.set(xlabel="Stroke of the grips [mm]", ylabel="Measured less law [mN]")
    right.margins(y=0.1)
    legends.above(right, columns=3 if beside else 2, columnspacing=1.0, handlelength=2.4)
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
_COLOURS = BLUE, VERMILLION, GREEN, PURPLE
_RIGHT = 94.0  # where the map of correlations begins [mm]
_BAR = 23.0  # what its bar takes at the right where it stands below the errors [mm]


@styled
def calibration(result: Calibration) -> Figure:
    """Error of every geometry, fitted and left out, and the correlations of the parameters.

    Args:
        result: of `lab.calibrate`.

    Returns:
        A figure of a page's width. On the left RMSE in k r, hollow marks for the fit and full ones
        for the prediction from the other geometries; on the right a map of the correlations,
        with their values written in.
    """
    geometries = sorted({sample.geometry for sample in result.samples})
    page = sheet.page_width(PAGE)
    beside = page >= sheet.BESIDE
    columns = 2 if beside else 1
    head = 6.0 + 3.7 * len(result.kinds) * 2 / columns
    tall = 15.0 + head + 7.0 * max(len(geometries), len(result.parameters))
    side = min(66.0, tall - 11.0 - head) if beside else min(66.0, page - 12.0 - _BAR)
    below = 0.0 if beside else side + 14.0
    figure = sheet.blank(page, tall + below)
    left = sheet.place(
        figure, 24.0, 11.0 + below, 52.0 if beside else page - 30.0, tall - 11.0 - head
    )
    for n, (bands, pair) in enumerate(result.kinds):
        colour, mark = _COLOURS[n % len(_COLOURS)], _MARKS[n % len(_MARKS)]
        at = [
            k
            for k, sample in enumerate(result.samples)
            if (sample.bands, sample.in_pair) == (bands, pair)
        ]
        off = 0.16 * (n - (len(result.kinds) - 1) / 2)
        rows = [geometries.index(result.samples[k].geometry) + off for k in at]
        name = f"{'pairs' if pair else 'cells'}, {bands_words(bands)}"
        style = {"linestyle": "none", "marker": mark, "markersize": 4.0, "color": colour}
        fit, left_out = np.array(result.fit_error)[at], np.array(result.left_out_error)[at]
        left.plot(fit, rows, markerfacecolor="white", label=f"{name}, fit", **style)
        left.plot(left_out, rows, label=f"{name}, left out", **style)
    left.set_yticks(range(len(geometries)), [*map(mm_pair, geometries)])
    left.set(xlabel="RMSE [$kr$]", ylabel="$d = q - p$ [mm]")
    left.set_xlim(left=0.0)
    left.grid(axis="y", color=FAINT, linewidth=0.3)
    left.invert_yaxis()
    legends.above(left, columns=columns, columnspacing=1.0)

    names = [_symbol(p.name) for p in result.parameters]
    start = _RIGHT if beside else 12.0
    bottom = 11.0 + (tall - 11.0 - head - side) / 2 if beside else 9.0
    right = sheet.place(figure, start, bottom, side, side)
    image = right.imshow(result.correlations, vmin=-1, vmax=1, cmap="PuOr")
    for (i, j), value in np.ndenumerate(result.correlations):
        if j < i:
            dark = abs(value) > 0.6
            look: dict[str, Any] = {
                "ha": "center",
                "va": "center",
                "color": "white" if dark else INK,
            }
            size = min(7.0, (1.15 if beside else 1.0) * side / len(names))
            right.text(j, i, _hundredths(float(value)), fontsize=size, **look, gid="correlation")
    right.set_xticks(range(len(names)), names)
    right.set_yticks(range(len(names)), names)
    right.tick_params(length=0)
    bar = sheet.place(figure, start + side + 3.0, bottom, 2.5, side)
    figure.colorbar(image, cax=bar)
    bar.set_ylabel("Correlation [1]")
    return figure


def _hundredths(value: float) -> str:
    """A correlation with its sign, without the zero before the point: it has to be short."""
    # Nothing is ever minus zero.
    told = f"{round(value, 2) + 0.0:.2f}".replace("1.00", "1")
    return minus(told.replace("0.", ".", 1) if abs(value) < 0.995 else told)


def _symbol(name: str) -> str:
    if name.startswith("stiffness_"):
        count, _, pair = name.removeprefix("stiffness_").partition("_")
        return f"$k_{{{count}}}{chr(39) * bool(pair)}$"
    return _SYMBOLS[name]
