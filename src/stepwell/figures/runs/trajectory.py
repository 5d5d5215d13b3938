"""Where a robot walked, and how far each cycle took and turned it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from stepwell.base import InputError
from stepwell.figures.common import (
    BLUE,
    FAINT,
    INK,
    MM,
    ORANGE,
    PAGE,
    blank,
    literal,
    marks,
    place,
    round_length,
    styled,
)
from stepwell.figures.robots import frame, in_world
from stepwell.figures.runs.gait import refuse_empty

if TYPE_CHECKING:
    from stepwell.simulation import Walk

Array = NDArray[np.float64]

_WIDE, _BAR, _GAP = 66.0, 35.0, 15.0
_LEFT, _ABOVE, _BELOW, _KEY = 14.0, 6.0, 10.0, 6.0
_LEAST_TURN = 20.0  # that a panel of turns has room for [°]


def trajectory(walk: Walk) -> Figure:
    """The path of the body from above, and displacement and rotation cycle by cycle.

    Args:
        walk: any walk.

    Returns:
        A figure of two columns' width: path [mm] with a tick to the heading at the start of every
        cycle, d/u_max along and across that heading, turn to the left [°].

    Raises:
        ValueError: a walk without samples.

    Source: Kamp et al. 2024, Figs. 3C to 3E.
    """
    return trajectories({walk.robot.title: walk})


@styled
def trajectories(walks: Mapping[str, Walk]) -> Figure:
    """The paths of several walks at one scale, each with its displacement and rotation a cycle.

    Args:
        walks: by the name to write above each.

    Returns:
        A figure of two columns' width, a row for each walk; see `trajectory`.

    Raises:
        ValueError: nothing to show, or a walk without samples.

    Source: Kamp et al. 2024, Figs. 3C to 3E.
    """
    if not walks:
        raise InputError("walks is empty: give one walk or more, by name.")
    for walk in walks.values():
        refuse_empty(walk)
    boxes = [_extent(walk) for walk in walks.values()]
    widest = max(box[1] - box[0] for box in boxes)
    # A tenth of the width more, so that ticks stand clear of the frame.
    scale = min(_WIDE / (1.1 * widest), 60.0 / max(box[3] - box[2] for box in boxes))
    tall = [max(30.0, (box[3] - box[2]) * scale + 4.0) for box in boxes]
    named = 0.0 if list(walks) == [""] else 5.0
    height = sum(tall) + len(tall) * (_ABOVE + named + _BELOW) + _KEY
    figure = blank(PAGE, height)
    rows: list[tuple[Axes, Axes, Axes]] = []
    bottom = height - _KEY
    for (name, walk), box, high in zip(walks.items(), boxes, tall, strict=True):
        bottom -= _ABOVE + named + high
        path = place(figure, _LEFT, bottom, _WIDE, high)
        _path(path, walk, box, scale, high)
        moved = place(figure, _LEFT + _WIDE + _GAP, bottom, _BAR, high)
        turned = place(figure, _LEFT + _WIDE + 2 * _GAP + _BAR, bottom, _BAR - 3.0, high)
        _bars(moved, turned, walk)
        rows.append((path, moved, turned))
        if name:
            figure.text(
                _LEFT / PAGE,
                (bottom + high + 1.8) / height,
                literal(name),
                weight="bold",
                va="bottom",
            )
        if walk.stopped:
            moved.text(
                0.0, 1.03, "stopped early", transform=moved.transAxes, va="bottom", gid="stopped"
            )
        bottom -= _BELOW
    for column in (1, 2):
        most = max(row[column].get_ylim()[1] for row in rows)
        for row in rows:
            row[column].set_ylim(-most, most)
    _key(figure, height)
    return figure


def _places(walk: Walk) -> Array:
    """Samples at the start of every cycle and the end of the last; both ends without one."""
    last = len(walk.time) - 1
    at = np.minimum(np.searchsorted(walk.time, walk.starts - 1e-9), last)
    return at if len(at) else np.unique([0, last])


def _outline(walk: Walk, sample: int) -> list[Array]:
    where = (walk.x[sample], walk.y[sample], walk.yaw[sample])
    return [in_world(line, *where) * MM for line in frame(walk.robot)]


def _extent(walk: Walk) -> tuple[float, float, float, float]:
    ends = [line for sample in (0, -1) for line in _outline(walk, sample)]
    points = np.concatenate([*ends, np.column_stack([walk.x, walk.y]) * MM])
    (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
    return float(left), float(right), float(bottom), float(top)


def _path(
    ax: Axes, walk: Walk, box: tuple[float, float, float, float], scale: float, high: float
) -> None:
    x, y = walk.x * MM, walk.y * MM
    for sample, colour in ((0, FAINT), (len(x) - 1, INK)):
        for line in _outline(walk, sample):
            ax.plot(*line.T, color=colour, linewidth=0.7, zorder=2, gid="robot")
    ax.plot(x, y, color=BLUE, linewidth=1.6, zorder=4.5, gid="path")
    length = max(0.35 * walk.robot.body.length * MM, 2.0 / scale)
    for sample in _places(walk):
        tip = length * np.array([math.cos(walk.yaw[sample]), math.sin(walk.yaw[sample])])
        # Across the path for who walks straight on, along it would not be seen.
        side = 0.15 * np.array([-tip[1], tip[0]])
        start = np.array([x[sample], y[sample]])
        ax.plot(*np.array([start - side, start + side]).T, color=INK, linewidth=0.6, zorder=4)
        ax.plot(
            *np.array([start, start + tip]).T, color=INK, linewidth=0.6, zorder=4, gid="heading"
        )
    ax.plot(
        x[:1],
        y[:1],
        "o",
        markersize=4.5,
        markerfacecolor="white",
        markeredgecolor=INK,
        zorder=5,
        gid="start",
    )
    ax.plot(x[-1:], y[-1:], "o", markersize=4.5, color=INK, zorder=5, gid="end")
    middle = (box[0] + box[1]) / 2, (box[2] + box[3]) / 2
    ax.set_xlim(middle[0] - _WIDE / scale / 2, middle[0] + _WIDE / scale / 2)
    ax.set_ylim(middle[1] - high / scale / 2, middle[1] + high / scale / 2)
    step = round_length(min(high, _WIDE / 2) / scale / 1.5)
    for axis in (ax.xaxis, ax.yaxis):
        low, top = axis.get_view_interval()
        axis.set_ticks(np.arange(math.ceil(low / step), math.floor(top / step) + 1) * step)
    ax.set_aspect("equal", adjustable="box")
    ax.set_xlabel("$x$ [mm]")
    ax.set_ylabel("$y$ [mm]")
    ax.yaxis.set_label_coords(-9.8 / _WIDE, 0.5)


def _bars(moved: Axes, turned: Axes, walk: Walk) -> None:
    starts = walk.starts
    first = round(starts[0] / walk.robot.drive.period) if len(starts) else 0
    number = first + 1 + np.arange(walk.cycles)
    moved.bar(number, walk.advance, width=0.7, color=BLUE, zorder=2, gid="advance")
    moved.plot(
        number,
        walk.sideways,
        "D",
        markersize=3.0,
        color=ORANGE,
        zorder=3,
        markeredgecolor=INK,
        markeredgewidth=0.4,
        gid="sideways",
    )
    turned.bar(number, np.degrees(walk.turn), width=0.7, color=BLUE, zorder=2, gid="turn")
    moved.set_ylabel("Displacement $d/u_\\mathrm{max}$")
    turned.set_ylabel("Turn to the left [°]")
    # Both ways alike, so that left and right, forward and backward are seen at a glance.
    for ax, least in ((moved, 1.1), (turned, _LEAST_TURN)):
        marks.zero_line(ax)
        most = max(least, *(abs(limit) for limit in ax.get_ylim()))
        ax.set_ylim(-most, most)
        ax.set_xlim(first + 0.4, first + max(walk.cycles, 1) + 0.6)
        ax.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1, nbins=8))
        ax.yaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10]))
        ax.yaxis.set_label_coords(-9.5 / _BAR, 0.5)
        ax.set_xlabel("Cycle")
        if not walk.cycles:
            ax.set_xticks([])
            ax.text(
                0.5,
                0.5,
                "no whole cycle",
                transform=ax.transAxes,
                ha="center",
                va="center",
                bbox={"boxstyle": "square,pad=0.2", "facecolor": "white", "linewidth": 0},
            )


def _key(figure: Figure, height: float) -> None:
    handles = [
        Line2D([], [], color=BLUE, label="path of the body"),
        Line2D(
            [],
            [],
            linestyle="none",
            marker="o",
            markersize=4.5,
            markerfacecolor="white",
            markeredgecolor=INK,
            label="start",
        ),
        Line2D([], [], linestyle="none", marker="o", markersize=4.5, color=INK, label="end"),
        Line2D(
            [],
            [],
            linestyle="none",
            marker="|",
            markersize=6.0,
            color=INK,
            markeredgewidth=0.8,
            label="heading at each cycle",
        ),
        Patch(facecolor=BLUE, label="along the heading"),
        Line2D(
            [],
            [],
            linestyle="none",
            marker="D",
            markersize=3.0,
            color=ORANGE,
            markeredgecolor=INK,
            markeredgewidth=0.4,
            label="to its left",
        ),
    ]
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(_LEFT / PAGE, 1 - 1.5 / height),
        ncols=len(handles),
    )
