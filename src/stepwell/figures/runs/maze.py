"""A robot's way through an arena, seen from above."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from stepwell.base import Floats
from stepwell.figures.common import (
    BLOCK,
    FAINT,
    GREEN,
    INK,
    MM,
    PAGE,
    Label,
    beside,
    blank,
    hollow,
    legends,
    limits,
    literal,
    marks,
    on_white,
    pale,
    place,
    plain,
    round_length,
    scale_bar,
    styled,
    text_at,
)
from stepwell.figures.robots import (
    OBSTACLE,
    TOUCHED,
    bracket,
    draw_arena,
    frame,
    in_world,
    outlines,
)
from stepwell.figures.runs.walk_axes import refuse_empty
from stepwell.figures.runs.walk_reading import MOTION, PRESSED, cycle_samples, motions

if TYPE_CHECKING:
    from stepwell.simulation import Maze, Walk


_TALLEST, _WIDEST, _TITLE, _KEY = 170.0, PAGE - 4.0, 7.0, 13.0
_HALO = pale(PRESSED, 0.25)
_START = hollow(5.0)
_LARGEST = 0.25  # mm of the page per mm of the arena
# A robot is drawn again where it has gone this share of its length, or nothing could be seen.
_APART = 0.4


@styled
def maze(maze: Maze) -> Figure:
    """The arena from above with the path that the robot took, coloured by how it moved.

    Args:
        maze: a way through any arena.

    Returns:
        A figure of two columns' width or less, to the scale of its bar: walls and cylinders,
        darker where touched; the path; the robot at its start, its end and in the middle of
        presses of its antennas; where antennas were pressed; start, goal and outcome.

    Raises:
        ValueError: a walk without samples.

    Source: Kamp et al. 2024, Fig. 4D.
    """
    walk, arena = maze.walk, maze.arena
    refuse_empty(walk)
    moments = _moments(maze)
    box = _extent(maze, moments)
    scale = min(_LARGEST, _WIDEST / (box[1] - box[0]), _TALLEST / (box[3] - box[2]))
    wide, high = (box[1] - box[0]) * scale, (box[3] - box[2]) * scale
    height = high + _TITLE + _KEY
    figure = blank(PAGE, height)
    ax = place(figure, (PAGE - wide) / 2, _KEY, wide, high)
    plain(ax, box)

    draw_arena(ax, arena, [time is not None for time in maze.touched.values()])
    used = _path(ax, walk)
    pressed = _presses(ax, maze)
    for sample in moments:
        _robot(ax, maze, sample)
    start, end = (np.array([walk.x[k], walk.y[k]]) * MM for k in (0, -1))
    ax.plot(*start, "o", **_START, zorder=8, gid="start")
    ax.plot(*end, "o", markersize=5.0, color=INK, zorder=8, gid="end")
    bar = round_length((box[1] - box[0]) / 4)
    scale_bar(ax, box[1] - 2.0 / scale, box[2] + 1.5 / scale, bar)
    labels = [Label(start[0], start[1], "start"), Label(end[0], end[1], "end")]
    if arena.goal is not None:
        x, y = (value * MM for value in arena.goal.at)
        labels.append(Label(x, y, "goal", GREEN))
    bars = [text.get_window_extent() for text in ax.texts if text.get_text()]
    for text in beside(ax, labels, keep_clear=bars):
        text.set_bbox(on_white(alpha=0.75))
    title = f"{literal(arena.title)}: " if arena.title else ""
    says = f"{title}{maze.outcome} after {maze.duration:.0f} s"
    look = {"ha": "center", "va": "top", "fontsize": 8, "weight": "bold"}
    text_at(figure, PAGE / 2, height - 1.5, says, **look)
    _key(figure, maze, used, pressed)
    return figure


def _extent(maze: Maze, moments: list[int]) -> tuple[float, float, float, float]:
    """left, right, bottom, top of all that is drawn [mm], with room for the scale bar below."""
    walk = maze.walk
    points = [np.column_stack([walk.x, walk.y]), *outlines(maze.arena)]
    for sample in moments:
        lines = frame(walk.robot, walk.antenna[sample].tolist())
        points += [_placed(line, walk, sample) for line in lines]
    every = np.concatenate(points) * MM
    wide = float(np.ptp(every, axis=0).max())
    return limits(every, (0.02 * wide, 0.02 * wide, 0.07 * wide, 0.02 * wide))


def _path(ax: Axes, walk: Walk) -> list[str]:
    """The path in the colours of the robot's motion; which of them occur."""
    kinds = motions(walk)
    last = len(walk.time) - 1
    # What was no whole cycle has no gait.
    cuts = [0, *cycle_samples(walk).tolist(), last]
    named = ["", *kinds, ""] if kinds else [""]
    spans: dict[str, list[tuple[int, int]]] = {kind: [] for kind in named}
    for kind, begin, end in zip(named, cuts[:-1], cuts[1:], strict=True):
        if end > begin:
            spans[kind].append((begin, end))
    for kind, ends in spans.items():
        look = {"color": MOTION.get(kind, FAINT), "linewidth": 1.7, "zorder": 6}
        _along(ax, walk, ends, gid=f"path {kind or 'of no whole cycle'}", **look)
    # Few enough places that an arrow head shows the way and not a single step.
    few = np.linspace(0, last, max(2, min(60, last // 100))).astype(int)
    for share in (0.2, 0.4, 0.6, 0.8):
        x, y = walk.x[few] * MM, walk.y[few] * MM
        marks.heading(ax, x, y, INK, at=share, size=13.0)
    return [kind for kind in MOTION if kind in kinds]


def _presses(ax: Axes, maze: Maze) -> bool:
    """Along the path, where an antenna was pressed; whether one ever was."""
    walk = maze.walk
    ends = [
        (int(np.searchsorted(walk.time, one.begin)), int(np.searchsorted(walk.time, one.end)))
        for one in maze.contacts
    ]
    look = {"color": _HALO, "linewidth": 5.5, "zorder": 5, "solid_capstyle": "butt"}
    _along(ax, walk, ends, gid="pressed", **look)
    return bool(ends)


def _along(ax: Axes, walk: Walk, spans: Iterable[tuple[int, int]], **look: Any) -> None:
    """The path between these first and last samples, as one line with gaps."""
    gap = np.full((1, 2), np.nan)
    xy = np.column_stack([walk.x, walk.y]) * MM
    pieces = [part for first, last in spans for part in (xy[first : last + 1], gap)]
    if pieces:
        ax.plot(*np.concatenate(pieces).T, **look)


def _moments(maze: Maze) -> list[int]:
    """Samples at which to draw the robot: both ends, and presses where they can be told apart."""
    walk = maze.walk
    last = len(walk.time) - 1
    middles = [(one.begin + one.end) / 2 for one in maze.contacts]
    found = [0, last]
    for sample in np.searchsorted(walk.time, middles).tolist():
        here = np.array([walk.x[sample], walk.y[sample]])
        others = np.array([(walk.x[k], walk.y[k]) for k in found])
        if np.hypot(*(others - here).T).min() > _APART * walk.robot.body.length:
            found.append(sample)
    return found


def _robot(ax: Axes, maze: Maze, sample: int) -> None:
    walk = maze.walk
    lines = frame(walk.robot, walk.antenna[sample].tolist())
    bodies = len(lines) - len(walk.robot.antennas)
    for line in lines[:bodies]:
        shape = _placed(line, walk, sample) * MM
        grey = {"facecolor": pale(BLOCK, 0.3), "edgecolor": INK, "linewidth": 0.6, "alpha": 0.8}
        ax.add_patch(Polygon(shape, **grey, zorder=4, gid="robot"))
    time = walk.time[sample]
    held = {one.antenna for one in maze.contacts if one.begin <= time <= one.end}
    for antenna, line in zip(walk.robot.antennas, lines[bodies:], strict=True):
        held_by = _placed(bracket(walk.robot, antenna), walk, sample) * MM
        ax.plot(*held_by.T, color=FAINT, linewidth=0.5, zorder=3.9)
        colour, width = (PRESSED, 2.0) if antenna.name in held else (INK, 0.8)
        look = {"color": colour, "linewidth": width, "gid": f"antenna {antenna.name}"}
        ax.plot(*(_placed(line, walk, sample) * MM).T, **look, zorder=5.5)


def _placed(line: Floats, walk: Walk, sample: int) -> Floats:
    return in_world(line, walk.x[sample], walk.y[sample], walk.yaw[sample])


def _key(figure: Figure, maze: Maze, used: list[str], pressed: bool) -> None:
    handles: list[Artist] = [legends.line(kind, MOTION[kind], 1.7) for kind in used]
    if pressed:
        handles.append(legends.line("antenna pressed", _HALO, 5.5))
    touched = maze.touched.values()
    if any(time is not None for time in touched):
        handles.append(legends.shade("touched obstacle", TOUCHED))
    if any(time is None for time in touched):
        look = {"edgecolor": INK, "linewidth": 0.5}
        handles.append(legends.shade("obstacle not touched", OBSTACLE, **look))
    handles += [legends.mark("start", **_START), legends.mark("end", size=5.0)]
    legends.below(figure, handles, 5)
