"""A robot's walk from above as one SVG that plays by itself."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from stepwell.base import Floats, write_atomic
from stepwell.figures.common.style import (
    BLOCK,
    BLUE,
    FAINT,
    FIXED_BLOCK,
    INK,
    ORANGE,
    PHASE,
    cell_colours,
)
from stepwell.figures.motion.moving import MotionRound, short
from stepwell.figures.robots.parts import antenna_line, bracket, in_world, leg_parts, rectangle
from stepwell.robot import Robot
from stepwell.simulation import Walk

# Width of the picture and the least and greatest share of it that is its height [px].
_WIDE, _ROOM, _LEAST, _MOST = 480.0, 18.0, 0.55, 0.75
_FRAMES = 14  # of every cycle
_SECONDS = 9.0
_FONT = 'font-family="sans-serif" font-size="13"'


class _Seen(NamedTuple):
    """Where everything is at one instant, on the floor [m]: lines and outlines, (n, 2) each."""

    body: Floats
    brackets: Floats
    bars: Floats
    blocks: Floats
    levers: Floats
    bands: Floats
    feet: Floats
    antennas: tuple[Floats, ...]


def moving_robot(walk: Walk, file: Path) -> None:
    """Write a walk as an SVG that plays over and over, from the start of its first cycle on."""
    write_atomic(file, _Picture(walk).text)


class _Picture:
    def __init__(self, walk: Walk):
        self.walk = walk
        period = walk.robot.drive.period
        last = float(walk.time[-1])
        times = np.linspace(0.0, last, round(_FRAMES * last / period) + 1)
        nows = [int(np.searchsorted(walk.time, time)) for time in times]
        self.seen = [_seen(walk, min(now, len(walk.time) - 1)) for now in nows]
        self.trail = np.column_stack([walk.x, walk.y])[nows[0] :: 10]
        self.round = MotionRound(_SECONDS)
        self.faster = last / _SECONDS
        everywhere = [np.concatenate([one.body, one.blocks, one.bands]) for one in self.seen]
        everywhere += [line for one in self.seen for line in one.antennas]
        points = np.concatenate(everywhere)
        low, high = points.min(axis=0), points.max(axis=0)
        middle, size = (low + high) / 2, high - low
        room = np.array([_WIDE - 2 * _ROOM, _MOST * _WIDE - 2 * _ROOM - 20.0])
        self.scale = float((room / size).min())
        self.high = float(np.clip(size[1] * self.scale + 2 * _ROOM + 20.0, _LEAST * _WIDE, np.inf))
        self.origin = np.array([_WIDE / 2, (self.high - 20.0) / 2]) - middle * self.scale * (1, -1)

    @property
    def text(self) -> str:
        """The whole file."""
        title = escape(self.walk.robot.title)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDE:g} {self.high:.0f}" '
            f'role="img" aria-label="{title}"><title>{title}</title>'
            f'<rect width="100%" height="100%" rx="8" fill="white"/>{self._floor()}{self._parts()}'
            f"{self._words()}</svg>\n"
        )

    def _floor(self) -> str:
        """A grid of 50 mm, the walls, and the way of the body."""
        step = 0.05 * self.scale
        first = self.origin % step
        lines = [f"M{short(x)} 0V{short(self.high)}" for x in np.arange(first[0], _WIDE, step)]
        lines += [f"M0 {short(y)}H{_WIDE:g}" for y in np.arange(first[1], self.high, step)]
        drawn = f'<path d="{"".join(lines)}" stroke="#eceff2" fill="none"/>'
        for wall in self.walk.arena.walls if self.walk.arena is not None else ():
            (x0, y0), (x1, y1) = self._page(np.array([wall.start, wall.end]))
            drawn += (
                f'<path d="M{short(x0)} {short(y0)}L{short(x1)} {short(y1)}" '
                f'stroke="{FIXED_BLOCK}" stroke-width="{short(wall.thickness * self.scale)}"/>'
            )
        way = "L".join(f"{short(x)} {short(y)}" for x, y in self._page(self.trail))
        look = f'stroke="{BLUE}" stroke-opacity="0.45" stroke-width="2" stroke-dasharray="2 4"'
        return f'{drawn}<path d="M{way}" fill="none" {look}/>'

    def _parts(self) -> str:
        robot = self.walk.robot
        drawn = [
            self._outlines(lambda seen: seen.body, PHASE),
            self._lines(lambda seen: seen.brackets, FAINT, 1.2),
            self._lines(lambda seen: seen.bars, FIXED_BLOCK, 3.0),
            self._outlines(lambda seen: seen.blocks, BLOCK),
            self._lines(lambda seen: seen.levers, INK, 2.0),
        ]
        owner = np.concatenate([_owner(robot, k) for k in range(len(robot.legs))])
        for cell, colour in enumerate(cell_colours(int(owner.max()) + 1)):
            ends = np.repeat(owner == cell, 2)
            drawn.append(self._lines(lambda seen, ends=ends: seen.bands[ends], colour, 3.0))
        for k in range(len(robot.legs)):
            at = self._page(np.array([seen.feet[k] for seen in self.seen]))
            look = f'stroke="{BLUE}" stroke-width="8" stroke-linecap="round"'
            drawn.append(self.round.path(at, "M{} {}h0", look))
        for k in range(len(robot.antennas)):
            at = self._page(np.array([seen.antennas[k] for seen in self.seen]))
            shape = "M{} {}" + "L{} {}" * (at.shape[1] - 1)
            look = f'fill="none" stroke="{ORANGE}" stroke-width="3" stroke-linejoin="round"'
            drawn.append(self.round.path(at.reshape(len(at), -1), shape, look))
        return "".join(drawn)

    def _lines(self, of: Callable[[_Seen], Floats], colour: str, width: float) -> str:
        """Lines, two points each."""
        at = self._page(np.array([of(seen) for seen in self.seen])).reshape(len(self.seen), -1)
        look = f'stroke="{colour}" stroke-width="{width:g}" stroke-linecap="round"'
        return self.round.path(at, "M{} {}L{} {}" * (at.shape[1] // 4), look)

    def _outlines(self, of: Callable[[_Seen], Floats], fill: str) -> str:
        """Outlines, four points each."""
        at = self._page(np.array([of(seen) for seen in self.seen])).reshape(len(self.seen), -1)
        shape = "M{} {}L{} {}L{} {}L{} {}Z" * (at.shape[1] // 8)
        return self.round.path(at, shape, f'fill="{fill}" stroke="{INK}" stroke-width="0.8"')

    def _words(self) -> str:
        """How long 50 mm are, and how much faster than it is the robot is shown."""
        y, long = self.high - 10.0, 0.05 * self.scale
        right = _WIDE - _ROOM
        return (
            f'<path d="M{_ROOM:g} {y - 4:.1f}h{short(long)}" stroke="{INK}" stroke-width="2"/>'
            f'<text x="{short(_ROOM + long + 7)}" y="{y:.1f}" {_FONT} fill="{INK}">50 mm</text>'
            f'<text x="{right:g}" y="{y:.1f}" {_FONT} text-anchor="end" fill="{INK}">'
            f"{self.faster:.2g} times real speed</text>"
        )

    def _page(self, points: Floats) -> Floats:
        """Points on the floor [m] on the picture [px], y down."""
        return self.origin + points * self.scale * (1.0, -1.0)


def _seen(walk: Walk, now: int) -> _Seen:
    robot = walk.robot
    swings = walk.antenna[now]
    for antenna, swing in zip(walk.robot.antennas, swings, strict=True):
        if antenna.connected:
            leg = robot.leg(antenna.leg)
            cell: Any = leg.chain.cells[leg.cell_index(antenna.cell)]
            share = float(swing) / antenna.swing
            p = np.array(cell.bands[0].p) + np.array(antenna.moves) * share
            robot = robot.with_anchors(antenna.leg, antenna.cell, p=(float(p[0]), float(p[1])))
    legs = [
        # Where legs have fewer cells than others, the rest of a row is not theirs.
        leg_parts(robot, leg, walk.travel[now, k, : len(leg.chain)])
        for k, leg in enumerate(robot.legs)
    ]
    blocks = [
        rectangle(middle, robot.blocks.length, robot.blocks.width)[:4]
        for parts in legs
        for middle in parts.blocks
    ]
    feet = [(parts.tip[0], leg.at[1]) for parts, leg in zip(legs, robot.legs, strict=True)]
    # What joins the outermost blocks, what holds the innermost, and the links over each foot.
    bars = [
        np.array([legs[j].blocks[-1], legs[i].blocks[-1]])
        for i, one in enumerate(robot.legs)
        for j, other in enumerate(robot.legs[:i])
        if one.at[0] == other.at[0] or one.at[1] == other.at[1]
    ]
    for parts, leg in zip(legs, robot.legs, strict=True):
        x, y = parts.levers[0, 0]
        bars.append(np.array([(x, leg.side * min(abs(y), robot.body.width / 2)), (x, y)]))
        bars.append(np.array([(at, leg.at[1]) for at in parts.pivots]))
    brackets = [bracket(robot, antenna) for antenna in robot.antennas]

    def on(points: Any) -> Floats:
        flat = np.asarray(points, float).reshape(-1, 2)
        return in_world(flat, float(walk.x[now]), float(walk.y[now]), float(walk.yaw[now]))

    pairs = zip(robot.antennas, swings, strict=True)
    return _Seen(
        on(rectangle((0.0, 0.0), robot.body.length, robot.body.width)[:4]),
        on(brackets),
        on(bars),
        on(blocks),
        on([lever for parts in legs for lever in parts.levers]),
        on([band for parts in legs for band in parts.bands]),
        on(feet),
        tuple(on(antenna_line(antenna, float(swing))) for antenna, swing in pairs),
    )


def _owner(robot: Robot, leg: int) -> Any:
    return leg_parts(robot, robot.legs[leg], robot.legs[leg].chain.full_travels).owner
