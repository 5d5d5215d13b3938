"""Tension tests of bands: the loading curves, the force laws, and what they leave."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from stepwell.figures.common import (
    BESIDE,
    BLACK,
    BLUE,
    FAINT,
    GREEN,
    MM,
    ORANGE,
    PAGE,
    PURPLE,
    VERMILLION,
    blank,
    legends,
    marks,
    page_width,
    pale,
    place,
    styled,
)
from stepwell.lab import BandTest, Choice

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
    page = page_width(PAGE)
    beside = page >= BESIDE
    figure = blank(page, _TALL if beside else 2 * _TALL)
    left = place(figure, 14.0, 11.0 + (not beside) * _TALL, 66.0 if beside else page - 18.0, 55.0)
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

    right = place(figure, 98.0 if beside else 14.0, 11.0, 78.0 if beside else page - 18.0, 55.0)
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
