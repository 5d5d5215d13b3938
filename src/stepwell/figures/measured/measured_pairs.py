"""Measured two-cell mechanisms beside their model: force against stroke, snaps marked."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from stepwell.base import InputError
from stepwell.figures.common import (
    FAINT,
    INK,
    LOADING,
    PAGE,
    UNLOADING,
    blank,
    literal,
    marks,
    name_panel,
    pale,
    place,
    styled,
)
from stepwell.lab import PairTest

_COLUMNS = 2


@styled
def measured_pairs(tests: Sequence[PairTest]) -> Figure:
    """Actuator force of measured pairs against stroke, the model as a line, snaps marked.

    Args:
        tests: one or more, a panel each.

    Returns:
        A figure of a page's width: the measured mean with its baseline subtracted (blue loading,
        vermillion unloading), faint where it is not judged; triangles where runs snap, above the
        axis, and where the model does, below.

    Raises:
        ValueError: nothing to show.

    Source: after Kamp et al. 2024, Fig. 2D to 2G.
    """
    if not tests:
        raise InputError("tests is empty: give one pair or more.")
    rows = math.ceil(len(tests) / _COLUMNS)
    wide, tall, key = PAGE / _COLUMNS, 52.0, 8.0
    height = rows * tall + key
    figure = blank(PAGE, height)
    for k, test in enumerate(tests):
        row, column = divmod(k, _COLUMNS)
        bottom = (rows - 1 - row) * tall + 10.0
        ax = place(figure, column * wide + 15.0, bottom, wide - 19.0, tall - 17.0)
        _panel(ax, test)
        if row == rows - 1 or k + _COLUMNS >= len(tests):
            ax.set_xlabel("Stroke $u$ [mm]")
        if column == 0:
            ax.set_ylabel("Actuator force [N]")
    ways = list(dict.fromkeys(test.series.unloading for test in tests))
    _legend(figure, ways, height)
    return figure


def _panel(ax: Axes, test: PairTest) -> None:
    colour = UNLOADING if test.series.unloading else LOADING
    u = test.stroke * 1e3
    marks.zero_line(ax)
    ax.plot(u, test.force, color=pale(colour), linewidth=1.0, gid="not judged")
    ax.plot(u, np.where(test.inside, test.force, np.nan), color=colour, gid="measured")
    ax.plot(u, test.model, color=INK, linewidth=0.9, linestyle=(0, (4, 2)), gid="model")
    low, high = ax.get_ylim()
    span = high - low
    ax.set_ylim(low - 0.12 * span, high + 0.12 * span)
    low, high = ax.get_ylim()
    seen = [1e3 * snap for snaps in test.snaps for snap in snaps]
    wanted = [1e3 * snap for snap in test.snaps_predicted]
    style = {"linestyle": "none", "markersize": 4.0, "zorder": 5}
    ax.plot(seen, [high - 0.06 * span] * len(seen), "v", color=colour, gid="snaps", **style)
    ax.plot(
        wanted,
        [low + 0.06 * span] * len(wanted),
        "^",
        color=INK,
        markerfacecolor="white",
        gid="snaps predicted",
        **style,
    )
    mechanism = test.series.name.removesuffix(", loading").removesuffix(", unloading")
    order = "tie" if test.tie else " then ".join(test.series.chain.names[c] for c in test.shown)
    name_panel(ax, literal(f"{mechanism}: {order}"))


def _legend(figure: Figure, ways: list[bool], height: float) -> None:
    handles: list[Line2D | Patch] = []
    for unloading in ways:
        name = "measured, unloading" if unloading else "measured, loading"
        colour = UNLOADING if unloading else LOADING
        handles.append(Line2D([], [], color=colour, label=name))
    handles.append(Line2D([], [], color=INK, linewidth=0.9, linestyle=(0, (4, 2)), label="model"))
    none = {"linestyle": "none", "markersize": 4.0}
    handles.append(Line2D([], [], marker="v", color=FAINT, label="run snaps", **none))
    handles.append(
        Line2D([], [], marker="^", color=INK, markerfacecolor="white", label="model snaps", **none)
    )
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(15.0 / PAGE, 1.0 - 2.0 / height),
        ncols=len(handles),
    )
