"""What the antennas felt, and what it changed, over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from stepwell.figures.common import (
    INK,
    PAGE,
    blank,
    legends,
    literal,
    name_rows,
    page_width,
    pale,
    place,
    styled,
)
from stepwell.figures.runs.walk_axes import DASHED, refuse_empty
from stepwell.figures.runs.walk_reading import PRESSED, gait_colours, gait_words, intervals

if TYPE_CHECKING:
    from stepwell.simulation import Maze

_LEFT, _RIGHT, _TOP, _BOTTOM = 24.0, 4.0, 2.0, 9.0
_ANTENNA, _LANE, _GAP = 18.0, 4.6, 3.5
# What an entry of the key takes [mm].
_ENTRY = 50.0
_PRESSED = pale(PRESSED, 0.55)
MOST_OBSTACLES = 24


@styled
def maze_timeline(maze: Maze) -> Figure:
    """Antenna contacts, the gait of each leg cycle by cycle, and obstacles touched, over time.

    Args:
        maze: a way through any arena.

    Returns:
        A figure of two columns' width against time [s]: swing of each antenna [°], shaded while
        it is pressed; a strip for each leg in the colour of its gait; a strip for each obstacle
        that was touched, up to 24, in the order of the first touch.

    Raises:
        ValueError: a walk without samples.
    """
    walk = maze.walk
    refuse_empty(walk)
    touched = {name: time for name, time in maze.touched.items() if time is not None}
    order = sorted(touched, key=touched.__getitem__)[:MOST_OBSTACLES]
    antennas, legs = walk.robot.antennas, walk.robot.legs
    colours = gait_colours(walk)
    page = page_width(PAGE)
    entries = len(colours) + 2 * bool(antennas)
    columns, key_rows = legends.laid(entries, page - _LEFT, _ENTRY, 3)
    height = _TOP + len(antennas) * (_ANTENNA + _GAP) + len(legs) * _LANE + _BOTTOM
    height += (len(order) * _LANE + _GAP if order else 0.0) + 3.0 + 4.2 * key_rows
    figure = blank(page, height)
    wide = page - _LEFT - _RIGHT
    bottom = height - _TOP
    axes: list[Axes] = []
    for i, antenna in enumerate(antennas):
        bottom -= _ANTENNA
        axes.append(ax := place(figure, _LEFT, bottom, wide, _ANTENNA))
        _swing(ax, maze, i)
        ax.set_ylabel(f"{literal(antenna.name)}\nantenna [°]")
        bottom -= _GAP
    bottom -= len(legs) * _LANE
    axes.append(ax := place(figure, _LEFT, bottom, wide, len(legs) * _LANE))
    _gaits(ax, maze, colours)
    if order:
        bottom -= _GAP + len(order) * _LANE
        axes.append(ax := place(figure, _LEFT, bottom, wide, len(order) * _LANE))
        _touches(ax, maze, order)
    for ax in axes:
        ax.set_xlim(0.0, max(maze.duration, 1e-6))
        ax.spines[["top", "right"]].set_visible(False)
        ax.tick_params(labelbottom=False)
    axes[-1].tick_params(labelbottom=True)
    axes[-1].set_xlabel("Time [s]")
    handles: list[Artist] = [
        legends.shade(gait_words(gait) if gait else "no state reached", colour)
        for gait, colour in colours.items()
    ]
    if antennas:
        handles.append(legends.shade("antenna pressed", _PRESSED))
        handles.append(Line2D([], [], **DASHED, label="full swing"))
    if handles:
        legends.below(figure, handles, columns, _LEFT)
    return figure


def _swing(ax: Axes, maze: Maze, antenna: int) -> None:
    walk = maze.walk
    one = walk.robot.antennas[antenna]
    for contact in maze.contacts:
        if contact.antenna == one.name:
            ax.axvspan(contact.begin, contact.end, color=_PRESSED, linewidth=0, gid="contact")
    most = np.degrees(one.swing)
    ax.plot(walk.time, np.degrees(walk.antenna[:, antenna]), color=INK, linewidth=1.0, gid="swing")
    ax.axhline(most, **DASHED, zorder=1)
    ax.set_ylim(-0.05 * most, 1.12 * most)
    ax.set_yticks([0.0, 30.0, 60.0, 90.0, 120.0][: 1 + max(1, int(most // 30))])


def _gaits(ax: Axes, maze: Maze, colours: dict[str, str]) -> None:
    walk = maze.walk
    legs = walk.robot.legs
    starts = walk.starts
    for i, leg in enumerate(legs):
        gaits = np.array(walk.gaits[leg.name], dtype=object)
        for gait, colour in colours.items():
            spans = [(starts[k], starts[k + 1] - starts[k]) for k in np.flatnonzero(gaits == gait)]
            if spans:
                look = {"facecolors": colour, "linewidth": 0, "gid": f"{leg.name} {gait}"}
                ax.broken_barh(spans, (i - 0.4, 0.8), **look)
    for change in maze.changes:
        at = [leg.name for leg in legs].index(change.leg)
        ax.plot([change.time] * 2, [at - 0.4, at + 0.4], color=INK, linewidth=0.8, gid="change")
    name_rows(ax, [f"{literal(leg.name)} leg" for leg in legs])


def _touches(ax: Axes, maze: Maze, order: list[str]) -> None:
    from stepwell.simulation import TOUCHED

    walk, names = maze.walk, list(maze.touched)
    step = walk.settings.sample
    for i, name in enumerate(order):
        felt = walk.obstacle_force[:, names.index(name)] > TOUCHED
        spans = [(begin, end - begin + step) for begin, end in intervals(walk.time, felt)]
        ax.broken_barh(spans, (i - 0.3, 0.6), facecolors=INK, linewidth=0, gid=name)
    name_rows(ax, order)
