"""Positions of a robot's parts in its body frame, and an arena from above."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon
from numpy.typing import NDArray

from stepwell.base import Floats, InputError
from stepwell.figures.common import marks, style
from stepwell.figures.common.sheet import Point
from stepwell.mechanism import Element
from stepwell.robot import Antenna, Arena, Leg, Patch, Plate, Robot, Slope, Wall

OBSTACLE, TOUCHED = style.FIXED_BLOCK, style.INK
STEP, GROOVE, OTHER_FRICTION = (0.80, 0.70, 0.55), (0.45, 0.45, 0.47), (0.72, 0.82, 0.90)
PLATE = (0.62, 0.74, 0.58)
_ARROW = 0.1  # length of the arrow that points uphill [m]
_ASIDE = 0.2  # distance of the arrow from the start, to the right [m]


def draw_arena(ax: Axes, arena: Arena, touched: Sequence[bool]) -> None:
    """Draw ground, goal and obstacles, walls first, touched ones darker, into axes in mm."""
    for patch in arena.patches:
        shape = Polygon(_rectangle(patch) * style.MM, linewidth=0, zorder=0.2, gid="patch")
        shape.set_facecolor(patch_colour(patch)[1])
        ax.add_patch(shape)
    for plate in arena.plates:
        shape = Polygon(_plate(plate) * style.MM, linewidth=0.5, zorder=0.4, gid="plate")
        shape.set(facecolor=PLATE, edgecolor=style.INK)
        ax.add_patch(shape)
    if arena.slope is not None:
        tail, tip = (point * style.MM for point in _uphill(arena))
        ax.plot(*np.array([tail, tip]).T, color=style.INK, linewidth=1.0, gid="uphill")
        marks.head(ax, tail.tolist(), tip.tolist(), style.INK, size=12.0)
    walls = [Polygon(_wall(wall) * style.MM) for wall in arena.walls]
    rounds = [_disc(one.at, one.radius) for one in arena.cylinders]
    for shape, felt in zip([*walls, *rounds], touched, strict=True):
        shape.set(facecolor=TOUCHED if felt else OBSTACLE, edgecolor=style.INK, linewidth=0.5)
        shape.set(zorder=3, gid="touched obstacle" if felt else "obstacle")
        ax.add_patch(shape)
    if arena.goal is not None:
        disc = _disc(arena.goal.at, arena.goal.radius)
        disc.set(facecolor=style.pale(style.GREEN, 0.85), edgecolor=style.GREEN, linewidth=0.8)
        disc.set(linestyle=(0, (3, 2)), zorder=0.5, gid="goal")
        ax.add_patch(disc)


def _disc(at: Sequence[float], radius: float) -> Circle:
    return Circle((at[0] * style.MM, at[1] * style.MM), radius * style.MM)


def outlines(arena: Arena) -> list[Floats]:
    """Points (n, 2) that enclose every obstacle, plate and the goal [m]; patches may be endless."""
    discs = [(one.at, one.radius) for one in arena.cylinders]
    if arena.goal is not None:
        discs.append((arena.goal.at, arena.goal.radius))
    corners = np.array([(-1.0, -1.0), (1.0, 1.0)])
    shapes = [*map(_wall, arena.walls), *map(_plate, arena.plates)]
    shapes += [_uphill(arena)] * (arena.slope is not None)
    return [*shapes, *(np.array(at) + radius * corners for at, radius in discs)]


def patch_colour(patch: Patch) -> tuple[str, tuple[float, float, float]]:
    """What a patch is, in words, and its colour."""
    if patch.level == 0:
        return "other friction", OTHER_FRICTION
    return ("step", STEP) if patch.level > 0 else ("groove", GROOVE)


def _rectangle(patch: Patch) -> Floats:
    """(4, 2) corners [m]."""
    (left, low), (right, high) = patch.low, patch.high
    return np.array([(left, low), (right, low), (right, high), (left, high)])


def _plate(plate: Plate) -> Floats:
    """(4, 2) corners at the start [m]."""
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / 2 * plate.size
    return in_world(corners, *plate.at, plate.heading)


def _uphill(arena: Arena) -> Floats:
    """(2, 2) ends of the arrow that points uphill [m], beside the start."""
    slope, side = arena.slope or Slope(0.0), arena.heading - math.pi / 2
    tail = np.array(arena.start) + _ASIDE * np.array([math.cos(side), math.sin(side)])
    up = slope.uphill if slope.angle >= 0 else slope.uphill + math.pi
    return np.array([tail, tail + _ARROW * np.array([math.cos(up), math.sin(up)])])


def _wall(wall: Wall) -> Floats:
    """(4, 2) corners [m]."""
    a, b = np.array(wall.start), np.array(wall.end)
    across = np.array([a[1] - b[1], b[0] - a[0]]) / wall.length * wall.thickness / 2
    return np.array([a + across, b + across, b - across, a - across])


@dataclass(frozen=True, slots=True)
class LegParts:
    """The parts of one leg at given travels, in metres; x forward, y left, z up from the pivots."""

    blocks: Floats  # (cells, 2) middle of each moving block, inner first
    levers: Floats  # (cells, 2, 2) ends of each lever, the inner one first
    bands: Floats  # (bands, 2, 2) ends of each band, p then q, cell by cell
    owner: NDArray[np.intp]  # (bands,) the cell that each band belongs to
    pivots: Floats  # (2,) x of the two pivots of the V, the outermost block's last
    tip: Point  # (x, z) of the foot's lowest point


def leg_parts(robot: Robot, leg: Leg, travels: Sequence[float] | Floats) -> LegParts:
    """Parts of a leg at these travels (cells,) [m]."""
    cells, half_span = leg.chain.cells, robot.foot.span / 2
    full = np.array([cell.full_travel for cell in cells])
    s = np.clip(np.asarray(travels, float), 0.0, full)
    # Blocks before the V are clear of each other at all travels.
    ahead = [robot.blocks.length + full[k] / 2 for k in range(1, len(cells) - 1)]
    clear = [float(sum(ahead[i:])) for i in range(len(cells) - 1)]
    x = [leg.at[0] + half_span + clear[i] - s[: i + 1].sum() for i in range(len(cells) - 1)]
    x.append(leg.at[0] - half_span - s.sum())
    inner = np.array([leg.at[0] + half_span + clear[0] - full[0] / 2, leg.at[1]])
    levers: list[Floats] = []
    bands: list[Floats] = []
    owner: list[int] = []
    for i, cell in enumerate(cells):
        if isinstance(cell, Element):
            raise InputError(f"leg {leg.name!r}: cell {i + 1} is an Element, which has no levers.")
        theta = float(cell.angle(s[i]))
        along = np.array([-math.sin(theta), leg.side * math.cos(theta)])
        outer = inner + cell.lever * along
        levers.append(np.array([inner, outer]))
        for band in cell.bands:
            bands.append(np.array([inner + in_body(leg, band.p), outer + in_body(leg, band.q)]))
            owner.append(i)
        inner = np.array([x[i], outer[1]])
    tip = (x[-2] - half_span - s[-1] / 2, -float(robot.foot.depth(s[-1])))
    blocks = np.array([(at, leg.at[1]) for at in x])
    return LegParts(
        blocks, np.array(levers), np.array(bands), np.array(owner), np.array(x[-2:]), tip
    )


def at_ends(robot: Robot, leg: Leg) -> tuple[LegParts, LegParts]:
    """Parts of a leg with every cell at 0, and with every cell at 1."""
    full = leg.chain.full_travels
    return leg_parts(robot, leg, [0.0] * len(full)), leg_parts(robot, leg, full)


def in_body(leg: Leg, anchor: Sequence[float]) -> Floats:
    """(x, y) of an offset in a cell's frame [m]: along the chain is backwards."""
    return np.array([-anchor[1], leg.side * anchor[0]])


def antenna_line(antenna: Antenna, swing: float = 0.0) -> Floats:
    """(2 or 3, 2) pivot, end of the rod and, if it has one, end of the hook [m]."""
    angle = abs(antenna.angle) + swing
    points = [np.array(antenna.pivot)]
    turns = ((antenna.length, angle), (antenna.hook, angle + antenna.hook_angle))
    for length, way in turns[: 1 + (antenna.hook > 0)]:
        along = np.array([math.cos(way), antenna.side * math.sin(way)])
        points.append(points[-1] + length * along)
    return np.array(points)


def bracket(robot: Robot, antenna: Antenna) -> Floats:
    """(2, 2) from the body to an antenna's hinge [m]; the model has no bracket."""
    half = robot.body.length / 2, robot.body.width / 2
    corner = [float(np.clip(antenna.pivot[k], -half[k], half[k])) for k in (0, 1)]
    return np.array([corner, antenna.pivot])


def anchor_moves(robot: Robot, antenna: Antenna) -> Floats:
    """(2, 2) positions of the anchor p moved by an antenna, at rest and at full swing [m]."""
    leg = robot.leg(antenna.leg)
    rest, _ = at_ends(robot, leg)
    at = rest.bands[rest.owner == leg.cell_index(antenna.cell)][0, 0]
    return np.array([at, at + in_body(leg, antenna.moves)])


def frame(robot: Robot, antenna_swings: Sequence[float] = ()) -> list[Floats]:
    """The outline from above as lines [m]: body, moving blocks of every leg at 0, antennas last, at
    these swings [rad] or at rest.
    """
    swings = antenna_swings or [0.0] * len(robot.antennas)
    lines = [rectangle((0.0, 0.0), robot.body.length, robot.body.width)]
    for leg in robot.legs:
        at_0, at_1 = at_ends(robot, leg)
        front, back = at_0.blocks[0, 0], at_1.blocks[-1, 0]
        length = front - back + robot.blocks.length
        lines.append(rectangle(((front + back) / 2, leg.at[1]), length, robot.blocks.width))
    pairs = zip(robot.antennas, swings, strict=True)
    return [*lines, *(antenna_line(antenna, swing) for antenna, swing in pairs)]


def rectangle(middle: Sequence[float] | Floats, length: float, width: float) -> Floats:
    """(5, 2) a closed rectangle, `length` along x and `width` along y."""
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]) / 2
    return np.asarray(middle, float) + corners * (length, width)


def in_world(points: Floats, x: float, y: float, yaw: float) -> Floats:
    """(n, 2) points of the body's frame [m] where the body is at (x, y) [m] and yaw [rad]."""
    c, s = math.cos(yaw), math.sin(yaw)
    return points @ np.array([[c, s], [-s, c]]) + (x, y)
