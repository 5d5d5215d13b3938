"""Path of a robot through an arena from above, and its antenna contacts over time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from stepwell.base import Floats
from stepwell.figures.common import legends, marks, sheet, style, words
from stepwell.figures.robots import parts, walks
from stepwell.robot import Arena

if TYPE_CHECKING:
    from stepwell.simulation import Maze, Walk


_TALLEST, _TITLE, _KEY = 170.0, 7.0, 9.2
# Height of a line and width of a letter of the title; entry and row of the legend [mm].
_LINE, _LETTER, _ENTRY, _ROW = 3.6, 2.0, 35.0, 3.8
_HALO = style.pale(walks.PRESSED, 0.25)
_START = style.hollow(5.0)
_LARGEST = 0.25  # mm of the page per mm of the arena
# A robot is drawn again after this fraction of its length, because drawings must not overlap.
_APART = 0.4


@style.styled
def maze(maze: Maze) -> Figure:
    """The arena from above with the path of the robot, coloured by its motion.

    To scale: walls and cylinders, darker if touched; the path, with the stretches on which an
    antenna was pressed; the robot at its start, its end and in antenna contacts; start, goal and
    outcome. Two columns wide.

    Raises:
        ValueError: a walk without samples.

    Source: Kamp et al. 2024, Fig. 4D.
    """
    walk, arena = maze.walk, maze.arena
    walks.refuse_empty(walk)
    moments = _moments(maze)
    box = _extent(maze, moments)
    page = sheet.page_width(style.PAGE)
    scale = min(_LARGEST, (page - 4.0) / (box[1] - box[0]), _TALLEST / (box[3] - box[2]))
    wide, high = (box[1] - box[0]) * scale, (box[3] - box[2]) * scale
    title = f"{arena.title}: " if arena.title else ""
    headline = words.wrapped(f"{title}{maze.ending}", int(page / _LETTER))
    handles = _key(maze)
    columns, rows = legends.grid_size(len(handles), page, _ENTRY, 5)
    key = _KEY + _ROW * (rows - 1)
    height = high + _TITLE + _LINE * (len(headline) - 1) + key
    figure = sheet.blank(page, height)
    ax = sheet.place(figure, (page - wide) / 2, key, wide, high)
    marks.plain(ax, box)

    parts.draw_arena(ax, arena, [time is not None for time in maze.touched.values()])
    _path(ax, walk)
    ends = [np.searchsorted(walk.time, [one.begin, one.end]).tolist() for one in maze.contacts]
    look: dict[str, Any] = {"color": _HALO, "linewidth": 5.5, "zorder": 5}
    _along(ax, walk, ends, gid="pressed", solid_capstyle="butt", **look)
    for sample in moments:
        _robot(ax, maze, sample)
    xy = np.column_stack([walk.x, walk.y]) * style.MM
    start, end = xy[0], xy[-1]
    ax.plot(*start, "o", **_START, zorder=8, gid="start")
    ax.plot(*end, "o", markersize=5.0, color=style.INK, zorder=8, gid="end")
    bar = marks.round_length((box[1] - box[0]) / 4)
    marks.scale_bar(ax, box[1] - 2.0 / scale, box[2] + 1.5 / scale, bar)
    labels = [legends.Label(start, "start"), legends.Label(end, "end")]
    if arena.goal is not None:
        x, y = (value * style.MM for value in arena.goal.at)
        labels.append(legends.Label((x, y), "goal", style.GREEN))
    bars = [text.get_window_extent() for text in ax.texts if text.get_text()]
    for text in legends.place_labels(ax, labels, keep_clear=bars):
        text.set_bbox(style.on_white(alpha=0.75))
    look = {"ha": "center", "va": "top", "fontsize": 8, "weight": "bold"}
    for k, line in enumerate(headline):
        sheet.text_at(figure, page / 2, height - 1.5 - _LINE * k, words.literal(line), **look)
    legends.below(figure, handles, columns)
    return figure


def _extent(maze: Maze, moments: list[int]) -> sheet.Box:
    """left, right, bottom, top of all that is drawn [mm], with room for the scale bar below."""
    walk = maze.walk
    points = [np.column_stack([walk.x, walk.y]), *parts.outlines(maze.arena)]
    for sample in moments:
        lines = parts.frame(walk.robot, walk.antenna[sample].tolist())
        points += [_placed(line, walk, sample) for line in lines]
    every = np.concatenate(points) * style.MM
    wide = float(np.ptp(every, axis=0).max())
    return marks.limits(every, (0.02 * wide, 0.02 * wide, 0.07 * wide, 0.02 * wide))


def _path(ax: Axes, walk: Walk) -> None:
    """The path in the colours of the robot's motion."""
    kinds = walks.motions(walk)
    last = len(walk.time) - 1
    # Stretches before and after the whole cycles have no gait.
    cuts = [0, *walks.cycle_samples(walk).tolist(), last]
    named = ["", *kinds, ""] if kinds else [""]
    spans = list(zip(named, pairwise(cuts), strict=True))
    for kind in dict.fromkeys(named):
        ends = [span for one, span in spans if one == kind and span[1] > span[0]]
        look = {"color": walks.MOTION.get(kind, style.FAINT), "linewidth": 1.7, "zorder": 6}
        _along(ax, walk, ends, gid=f"path {kind or 'of no whole cycle'}", **look)
    # Few points, so that an arrow head shows the path and not a single step.
    few = np.linspace(0, last, max(2, min(60, last // 100))).astype(int)
    x, y = walk.x[few] * style.MM, walk.y[few] * style.MM
    for share in (0.2, 0.4, 0.6, 0.8):
        marks.heading(ax, x, y, style.INK, at=share, size=13.0)


def _along(ax: Axes, walk: Walk, spans: Iterable[Sequence[int]], **look: Any) -> None:
    """The path between these first and last samples, as one line with gaps."""
    gap = np.full((1, 2), np.nan)
    xy = np.column_stack([walk.x, walk.y]) * style.MM
    pieces = [part for first, last in spans for part in (xy[first : last + 1], gap)]
    if pieces:
        ax.plot(*np.concatenate(pieces).T, **look)


def _moments(maze: Maze) -> list[int]:
    """Samples at which the robot is drawn: both ends, and antenna contacts that do not overlap."""
    walk = maze.walk
    last = len(walk.time) - 1
    middles = [(one.begin + one.end) / 2 for one in maze.contacts]
    samples = [0, last]
    for sample in np.searchsorted(walk.time, middles).tolist():
        here = np.array([walk.x[sample], walk.y[sample]])
        others = np.array([(walk.x[k], walk.y[k]) for k in samples])
        if np.hypot(*(others - here).T).min() > _APART * walk.robot.body.length:
            samples.append(sample)
    return samples


def _robot(ax: Axes, maze: Maze, sample: int) -> None:
    walk = maze.walk
    lines = parts.frame(walk.robot, walk.antenna[sample].tolist())
    bodies = len(lines) - len(walk.robot.antennas)
    grey: dict[str, Any] = {"facecolor": style.pale(style.BLOCK, 0.3), "edgecolor": style.INK}
    grey |= {"linewidth": 0.6, "alpha": 0.8, "zorder": 4, "gid": "robot"}
    for line in lines[:bodies]:
        ax.add_patch(Polygon(_placed(line, walk, sample) * style.MM, **grey))
    time = walk.time[sample]
    held = {one.antenna for one in maze.contacts if one.begin <= time <= one.end}
    for antenna, line in zip(walk.robot.antennas, lines[bodies:], strict=True):
        held_by = _placed(parts.bracket(walk.robot, antenna), walk, sample) * style.MM
        ax.plot(*held_by.T, color=style.FAINT, linewidth=0.5, zorder=3.9)
        colour, width = (walks.PRESSED, 2.0) if antenna.name in held else (style.INK, 0.8)
        look = {"color": colour, "linewidth": width, "gid": f"antenna {antenna.name}"}
        ax.plot(*(_placed(line, walk, sample) * style.MM).T, **look, zorder=5.5)


def _placed(line: Floats, walk: Walk, sample: int) -> Floats:
    return parts.in_world(line, walk.x[sample], walk.y[sample], walk.yaw[sample])


def _key(maze: Maze) -> list[Artist]:
    """Legend entries for the colours and marks that occur."""
    kinds, touched, arena = walks.motions(maze.walk), maze.touched.values(), maze.arena
    ground = dict(map(parts.patch_colour, arena.patches))
    edge = {"edgecolor": style.INK, "linewidth": 0.5}
    return legends.applicable(
        *((kind in kinds, legends.line(kind, one, 1.7)) for kind, one in walks.MOTION.items()),
        (maze.contacts, legends.line("antenna pressed", _HALO, 5.5)),
        ({*touched} - {None}, legends.shade("touched obstacle", parts.TOUCHED)),
        (None in touched, legends.shade("obstacle not touched", parts.OBSTACLE, **edge)),
        *((True, legends.shade(what, colour)) for what, colour in ground.items()),
        (arena.plates, legends.shade("loose plate, at the start", parts.PLATE, **edge)),
        (arena.slope, legends.mark(_slope_words(arena), marker=">", size=4.5)),
        (True, legends.mark("start", **_START)),
        (True, legends.mark("end", size=5.0)),
    )


def _slope_words(arena: Arena) -> str:
    return "" if arena.slope is None else f"uphill, {abs(np.degrees(arena.slope.angle)):.3g}°"


_LEFT, _RIGHT, _TOP, _BOTTOM = 24.0, 4.0, 2.0, 9.0
_ANTENNA, _LANE, _GAP = 18.0, 4.6, 3.5
# Width of a legend entry [mm].
_TIMELINE_ENTRY = 50.0
_PRESSED = style.pale(walks.PRESSED, 0.55)
MOST_OBSTACLES = 24


@style.styled
def maze_timeline(maze: Maze) -> Figure:
    """Antenna contacts, the gait of each leg cycle by cycle, and obstacles touched, over time [s].

    Panels show the swing of each antenna [°], shaded while it is pressed; a strip for each leg in
    the colour of its gait; a strip for each touched obstacle, up to 24, in the order of first
    contact. Two columns wide.

    Raises:
        ValueError: a walk without samples.
    """
    walk = maze.walk
    walks.refuse_empty(walk)
    touched = {name: time for name, time in maze.touched.items() if time is not None}
    order = sorted(touched, key=touched.__getitem__)[:MOST_OBSTACLES]
    antennas, legs = walk.robot.antennas, walk.robot.legs
    colours = walks.gait_colours(walk)
    page = sheet.page_width(style.PAGE)
    entries = len(colours) + 2 * bool(antennas)
    columns, key_rows = legends.grid_size(entries, page - _LEFT, _TIMELINE_ENTRY, 3)
    tall = [_ANTENNA] * len(antennas) + [len(legs) * _LANE, len(order) * _LANE][: 1 + bool(order)]
    bottom = 3.0 + 4.2 * key_rows + _BOTTOM
    figure = sheet.blank(page, bottom + sum(tall) + _GAP * (len(tall) - 1) + _TOP)
    axes = sheet.stack(figure, (_LEFT, bottom), page - _LEFT - _RIGHT, tall, _GAP)
    for i, (ax, antenna) in enumerate(zip(axes, antennas, strict=False)):
        _swing(ax, maze, i)
        ax.set_ylabel(f"{words.literal(antenna.name)}\nantenna [°]")
    _gaits(axes[len(antennas)], maze, colours)
    if order:
        _touches(axes[-1], maze, order)
    for ax in axes:
        ax.set_xlim(0.0, max(maze.duration, 1e-6))
        ax.spines[["top", "right"]].set_visible(False)
        ax.tick_params(labelbottom=False)
    axes[-1].tick_params(labelbottom=True)
    axes[-1].set_xlabel("Time [s]")
    handles = [
        legends.shade(walks.gait_words(gait) if gait else "no state reached", colour)
        for gait, colour in colours.items()
    ]
    handles += legends.applicable(
        (antennas, legends.shade("antenna pressed", _PRESSED)),
        (antennas, Line2D([], [], **walks.DASHED, label="full swing")),
    )
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
    look = {"color": style.INK, "linewidth": 1.0, "gid": "swing"}
    ax.plot(walk.time, np.degrees(walk.antenna[:, antenna]), **look)
    ax.axhline(most, **walks.DASHED, zorder=1)
    ax.set_ylim(-0.05 * most, 1.12 * most)
    ax.set_yticks([0.0, 30.0, 60.0, 90.0, 120.0][: 1 + max(1, int(most // 30))])


def _gaits(ax: Axes, maze: Maze, colours: dict[str, str]) -> None:
    walk, starts = maze.walk, maze.walk.starts
    legs = [leg.name for leg in walk.robot.legs]
    for i, leg in enumerate(legs):
        gaits = np.array(walk.gaits[leg], dtype=object)
        for gait, colour in colours.items():
            spans = [(starts[k], starts[k + 1] - starts[k]) for k in np.flatnonzero(gaits == gait)]
            if spans:
                look = {"facecolors": colour, "linewidth": 0, "gid": f"{leg} {gait}"}
                ax.broken_barh(spans, (i - 0.4, 0.8), **look)
    for change in maze.changes:
        at = legs.index(change.leg)
        ends = [change.time] * 2, [at - 0.4, at + 0.4]
        ax.plot(*ends, color=style.INK, linewidth=0.8, gid="change")
    style.name_rows(ax, [f"{words.literal(leg)} leg" for leg in legs])


def _touches(ax: Axes, maze: Maze, order: list[str]) -> None:
    from stepwell.simulation import TOUCHED

    walk, names = maze.walk, list(maze.touched)
    step = walk.settings.sample
    for i, name in enumerate(order):
        felt = walk.obstacle_force[:, names.index(name)] > TOUCHED
        spans = [(begin, end - begin + step) for begin, end in walks.intervals(walk.time, felt)]
        ax.broken_barh(spans, (i - 0.3, 0.6), facecolors=style.INK, linewidth=0, gid=name)
    style.name_rows(ax, order)
