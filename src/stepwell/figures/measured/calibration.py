"""A calibration: how well each geometry is fitted and predicted, and which numbers are tied."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from stepwell.figures.common import (
    BESIDE,
    BLUE,
    FAINT,
    GREEN,
    INK,
    PAGE,
    PURPLE,
    VERMILLION,
    blank,
    legends,
    minus,
    mm_pair,
    page_width,
    place,
    styled,
)
from stepwell.figures.measured.measured import bands_words
from stepwell.lab import Calibration

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
    page = page_width(PAGE)
    beside = page >= BESIDE
    columns = 2 if beside else 1
    head = 6.0 + 3.7 * len(result.kinds) * 2 / columns
    tall = 15.0 + head + 7.0 * max(len(geometries), len(result.parameters))
    side = min(66.0, tall - 11.0 - head) if beside else min(66.0, page - 12.0 - _BAR)
    below = 0.0 if beside else side + 14.0
    figure = blank(page, tall + below)
    left = place(figure, 24.0, 11.0 + below, 52.0 if beside else page - 30.0, tall - 11.0 - head)
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
    right = place(figure, start, bottom, side, side)
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
    bar = place(figure, start + side + 3.0, bottom, 2.5, side)
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
