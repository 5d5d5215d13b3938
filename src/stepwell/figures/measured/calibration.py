"""A calibration: how well each geometry is fitted and predicted, and which numbers are tied."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from stepwell.figures.common import (
    BLUE,
    FAINT,
    INK,
    PAGE,
    VERMILLION,
    blank,
    legends,
    minus,
    mm_pair,
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
}
_MARKS = "o^sDv"
_RIGHT = 96.0  # where the map of correlations begins [mm]


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
    tall = 24.0 + 7.0 * max(len(geometries), len(result.parameters))
    figure = blank(PAGE, tall)
    left = place(figure, 24.0, 11.0, 56.0, tall - 20.0)
    for n, bands in enumerate(result.counts):
        colour, mark = (BLUE, VERMILLION)[n % 2], _MARKS[n % len(_MARKS)]
        at = [k for k, sample in enumerate(result.samples) if sample.bands == bands]
        off = 0.12 * (n - (len(result.counts) - 1) / 2)
        rows = [geometries.index(result.samples[k].geometry) + off for k in at]
        name = bands_words(bands)
        style = {"linestyle": "none", "marker": mark, "markersize": 4.0, "color": colour}
        fit, left_out = np.array(result.fit_error)[at], np.array(result.left_out_error)[at]
        left.plot(fit, rows, markerfacecolor="white", label=f"{name}, fit", **style)
        left.plot(left_out, rows, label=f"{name}, left out", **style)
    left.set_yticks(range(len(geometries)), [*map(mm_pair, geometries)])
    left.set(xlabel="RMSE [$kr$]", ylabel="$d = q - p$ [mm]")
    left.set_xlim(left=0.0)
    left.grid(axis="y", color=FAINT, linewidth=0.3)
    left.invert_yaxis()
    legends.above(left, columns=2, columnspacing=1.0)

    names = [_symbol(p.name) for p in result.parameters]
    side = min(66.0, tall - 24.0)
    right = place(figure, _RIGHT, 11.0 + (tall - 20.0 - side) / 2, side, side)
    image = right.imshow(result.correlations, vmin=-1, vmax=1, cmap="PuOr")
    for (i, j), value in np.ndenumerate(result.correlations):
        if j < i:
            dark = abs(value) > 0.6
            look: dict[str, Any] = {
                "ha": "center",
                "va": "center",
                "color": "white" if dark else INK,
            }
            right.text(j, i, _hundredths(float(value)), **look, gid="correlation")
    right.set_xticks(range(len(names)), names)
    right.set_yticks(range(len(names)), names)
    right.tick_params(length=0)
    bar = place(figure, _RIGHT + side + 3.0, 11.0 + (tall - 20.0 - side) / 2, 2.5, side)
    figure.colorbar(image, cax=bar)
    bar.set_ylabel("Correlation [1]")
    return figure


def _hundredths(value: float) -> str:
    """A correlation with its sign, without the zero before the point: it has to be short."""
    # Nothing is ever minus zero.
    told = f"{round(value, 2) + 0.0:.2f}".replace("1.00", "1")
    return minus(told.replace("0.", ".", 1) if abs(value) < 0.995 else told)


def _symbol(name: str) -> str:
    stem, _, count = name.rpartition("_")
    return f"$k_{{{count}}}$" if stem == "stiffness" else _SYMBOLS[name]
