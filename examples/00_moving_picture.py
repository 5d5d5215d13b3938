"""The moving picture of the README, drawn anew: `python 00_moving_picture.py`.

A leg goes out and back, one anchor moves, and the same stroke takes its states in another order.
Then a robot: what its antenna touches moves an anchor, and the leg on the far side changes its
order, so that the robot turns. Everything shown is computed.
"""

import math
import sys
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle, Polygon
from PIL import Image
from PIL.Image import Image as Picture

import stepwell as sw
from stepwell.figures.cells.linkage import Drawing
from stepwell.figures.common.marks import plain
from stepwell.figures.common.sheet import blank, place
from stepwell.figures.common.style import (
    BLOCK,
    BLUE,
    FAINT,
    FIXED_BLOCK,
    GREEN,
    INK,
    ORANGE,
    PHASE,
    PURPLE,
    VERMILLION,
    YELLOW,
    pale,
    styled,
)
from stepwell.figures.common.write import write_gif
from stepwell.figures.motion.stroke_program import instants
from stepwell.figures.robots.parts import (
    antenna_line,
    bracket,
    draw_arena,
    in_world,
    leg_parts,
    rectangle,
)
from stepwell.mechanism.layout import ChainLayout
from stepwell.robot import Arena, Robot, Wall
from stepwell.robot.leg_cycles import states

# What moves in the first act, and the order of states before and after.
ANCHOR_BEFORE, ANCHOR_AFTER = (0.020, 0.0), (0.005, 0.0)
# The robot of the second act, its wall, and what of its walk is shown [s].
ROBOT, FROM, UNTIL = "robot-antennas", 0.0, 21.98

# What the leg does whose anchor the antenna moves, while it is far enough.
REVERSED = "00>01>11>10>00"

# One unit of the page is one pixel of a picture of this size.
WIDE, HIGH, SIDE = 800, 430, 214
FPS = 12.5
CYCLE, GLIDE, WALK = 3.1, 1.2, 5.0  # seconds of the picture
BIG, SMALL = 19.0, 14.5  # of text [pt], at 100 pixels an inch


def acts() -> tuple[sw.Chain, sw.Chain]:
    """The leg before and after its anchor has moved."""
    leg = sw.preset("paper-forward")
    assert leg.cells[1].bands[0].q == ANCHOR_BEFORE
    return leg, moved(leg, ANCHOR_AFTER)


def moved(leg: sw.Chain, q: tuple[float, float]) -> sw.Chain:
    """The leg with the outer cell's anchor at q [m]."""
    inner, outer = leg.levers
    return replace(leg, cells=(inner, outer.with_anchors(q=q)))


def arena() -> Arena:
    """A wall that the robot meets aslant."""
    slope = math.radians(80.0)
    x, y = 0.3 * math.cos(slope), 0.3 * math.sin(slope)
    return Arena((Wall((0.23 - x, -y), (0.23 + x, y)),))


class Square:
    """The states of two cells as corners of a square, with the way that they go.

    Inner travel runs to the right and outer travel upwards.
    """

    def __init__(self, ax: Any, left: float, bottom: float, side: float, name: str = ""):
        self.ax, self.corner, self.side = ax, np.array([left, bottom]), side
        self.size = 0.145 * side if side > 130 else 23.0
        look = {"fontsize": SMALL, "ha": "center"}
        if name:
            ax.text(left + side / 2, bottom + side / 2, name, va="center", **look)
        for state in ("00", "01", "10", "11"):
            for other in (state[0] + "1", "1" + state[1]):
                ends = np.array([self.at(state), self.at(other)])
                ax.plot(*ends.T, color=PHASE, linewidth=5.0, zorder=1)
        below = bottom - self.size - 14.0
        self.words = ax.text(left + side / 2, below, "", va="top", **look, fontweight="bold")

    def at(self, state: Any) -> Any:
        """Where a state, or where shares of both travels, are on the page."""
        share = [float(digit) for digit in state]
        return self.corner + self.side * np.array(share)

    def draw(self, shares: Any, near: float) -> list[Any]:
        """What there is to see after (n, 2) shares of travel, of which the last is now.

        A cell this near a stop, as a share of its travel, is there.
        """
        rests = [state for state in states(np.asarray(shares), near) if state]
        told = rests[:1] + [b for a, b in pairwise(rests) if a != b]
        way = np.array([self.at(share) for share in shares])
        look: dict[str, Any] = {"color": BLUE, "linewidth": 4.0, "zorder": 2}
        found: list[Any] = self.ax.plot(*way.T, **look)
        look = {"color": INK, "markersize": 9, "markeredgecolor": "white", "zorder": 2.5}
        found += self.ax.plot(*way[-1], "o", **look)
        look = {"ha": "center", "va": "center", "fontsize": SMALL, "fontweight": "bold"}
        for state in ("00", "01", "10", "11"):
            spot = self.at(state)
            here = np.hypot(*(spot - way[-1])) < 0.8 * self.size
            face = INK if here else pale(YELLOW, 0.35) if state in told else "white"
            ink = "white" if here else INK if state in told else FAINT
            disc = Circle(spot, self.size, facecolor=face, edgecolor=INK, zorder=3)
            found += [self.ax.add_patch(disc)]
            found += [self.ax.text(*spot, state, color=ink, zorder=5, **look)]
        self.words.set_text(">".join(told))
        return found


class Page:
    """A white page with a line of text on top, on which parts come and go."""

    def __init__(self):
        self.figure = blank(WIDE * 0.254, HIGH * 0.254)
        self.figure.set_dpi(100)
        self.canvas = FigureCanvasAgg(self.figure)
        self.ax = place(self.figure, 0.0, 0.0, WIDE * 0.254, HIGH * 0.254)
        plain(self.ax, (0.0, WIDE, 0.0, HIGH))
        look = {"fontsize": BIG, "va": "center", "fontweight": "bold", "zorder": 20}
        self.title = self.ax.text(24, HIGH - 34, "", **look)

    def shoot(self, passing: list[Any]) -> Picture:
        """The page as it is; what is passing is taken off again."""
        self.canvas.draw()
        seen = Image.fromarray(np.asarray(self.canvas.buffer_rgba())[..., :3].copy())
        for artist in passing:
            artist.remove()
        return seen


def first_act() -> Iterator[Picture]:
    """The leg, its anchor, and the leg again."""
    before, after = acts()
    page = Page()
    ax = page.ax
    both = [ChainLayout(chain).bounds([(0.0, 0.0), (0.02, 0.02)], 0.002) for chain in acts()]
    left, bottom = (min(box[k] for box in both) for k in (0, 1))
    right, top = (max(box[k] for box in both) for k in (2, 3))
    # Room for the wall at the left, and for the actuator's rod at the right.
    left -= 0.004
    scale = min((WIDE - SIDE - 76) / (right - left), (HIGH - 100) / (top - bottom))
    origin = 24 - left * scale, (HIGH - 30) / 2 - (top + bottom) / 2 * scale
    square = Square(ax, WIDE - SIDE + 30, 190, 140)
    middle = square.at("00")[0] + square.side / 2
    look = {"fontsize": SMALL, "va": "center"}
    ax.text(middle, 68, "one digit per cell:\n0 closed, 1 open", ha="center", **look)
    for x, name, colour in ((30, "inner cell", GREEN), (170, "outer cell", PURPLE)):
        ax.text(x, 40, name, color=colour, fontweight="bold", **look)

    def pull(chain: sw.Chain, said: str) -> Iterator[Picture]:
        path = chain.cycle().path
        full = np.array(chain.full_travels)
        drawing = Drawing(ax, ChainLayout(chain), origin, scale, 2.0)
        frames = instants(path, CYCLE, round(CYCLE * FPS))
        last = round(0.4 * FPS)
        frames += [frames[0]._replace(travels=np.zeros(2))] * last
        # Between two frames a state may come and go: what the path has passed counts too.
        way = np.cumsum(np.abs(np.diff(path.stroke, prepend=0.0))) * 1e3
        for k, frame in enumerate(frames):
            passed = path.travel[way < (frame.way - 1e-6 if k < len(frames) - last else np.inf)]
            shares = np.vstack([passed, frame.travels]) / full
            page.title.set_text(said)
            pose = drawing.move(frame.travels)
            passing = [*rod(pose.blocks[-1]), *square.draw(shares, 1e-3)]
            if frame.snap:
                box = {"boxstyle": "round,pad=0.25", "facecolor": YELLOW, "linewidth": 0}
                words = {
                    "fontsize": BIG,
                    "fontweight": "bold",
                    "ha": "center",
                    "va": "center",
                    "bbox": box,
                }
                passing.append(
                    ax.text(middle, square.at("11")[1] - square.side / 2, "snap", zorder=9, **words)
                )
            yield page.shoot(passing)
        for artist in drawing.artists:
            artist.remove()

    def rod(block: Any) -> list[Any]:
        x, y = origin[0] + block[2] * scale, origin[1] + (block[1] + block[3]) / 2 * scale
        end = WIDE - SIDE - 14
        found = ax.plot([x, end], [y, y], color=FIXED_BLOCK, linewidth=7, zorder=1.5)
        grip = rectangle((end - 10, y), 40, 40)
        found += [ax.add_patch(Polygon(grip, facecolor=INK, zorder=4))]
        found += [ax.text(end + 10, y + 30, "actuator", fontsize=SMALL, ha="right")]
        return found

    def glide() -> Iterator[Picture]:
        page.title.set_text("Move one anchor ...")
        count = round(GLIDE * FPS)
        share = np.clip(np.linspace(-0.25, 1.25, count), 0.0, 1.0)
        for part in share * share * (3.0 - 2.0 * share):
            q = np.array(ANCHOR_BEFORE) + part * np.subtract(ANCHOR_AFTER, ANCHOR_BEFORE)
            chain = moved(before, (float(q[0]), float(q[1])))
            drawing = Drawing(ax, ChainLayout(chain), origin, scale, 2.0)
            pose = drawing.move([0.0, 0.0])
            passing = [*rod(pose.blocks[-1]), *square.draw([(0.0, 0.0)], 1e-3), *drawing.artists]
            ends = [
                ChainLayout(one).pose([0.0, 0.0]).bands[1, 1] * scale + origin
                for one in (before, after)
            ]
            for x, y in ends:
                ring = Circle((x, y), 9, facecolor="none", edgecolor=VERMILLION, linewidth=2)
                passing.append(ax.add_patch(ring))
            (x, low), (_, high) = ends
            props = {"arrowstyle": "-|>", "color": VERMILLION, "linewidth": 3}
            props |= {"mutation_scale": 22, "connectionstyle": "arc3,rad=-0.35"}
            props |= {"shrinkA": 12, "shrinkB": 12}
            passing.append(ax.annotate("", (x, high), (x, low), arrowprops=props, zorder=9))
            words = {"fontsize": SMALL, "color": VERMILLION, "fontweight": "bold"}
            passing.append(ax.text(x + 58, (low + high) / 2, "15 mm", va="center", **words))
            yield page.shoot(passing)

    yield from pull(before, "One stroke: the springs set the sequence")
    yield from glide()
    yield from pull(after, "... and the same stroke gives another sequence")


def second_act() -> Iterator[Picture]:
    """The robot meets a wall."""
    walk = sw.preset(ROBOT).maze(arena(), limit=UNTIL + 2.0).walk
    robot = walk.robot
    page = Page()
    ax = page.ax
    scale = 1.3e3
    origin = np.array([92.0, 150.0])
    world = ax.inset_axes((0.0, 0.0, (WIDE - SIDE) / WIDE, (HIGH - 66) / HIGH))
    shown = np.array([(0.0, 0.0), (WIDE - SIDE, HIGH - 66)]) - origin
    shown = shown / scale * 1e3
    plain(world, (shown[0, 0], shown[1, 0], shown[0, 1], shown[1, 1]))
    squares = [
        Square(ax, WIDE - SIDE + 51, bottom, 90, leg.name.split()[0])
        for bottom, leg in zip((262, 74), robot.legs, strict=True)
    ]
    speed = f"{(UNTIL - FROM) / WALK:.2g} times\nreal speed"
    ax.text(440, 14, speed, fontsize=SMALL, va="bottom", zorder=9)
    full = [np.array(leg.chain.full_travels) for leg in robot.legs]
    period = robot.drive.period
    times = np.linspace(FROM, UNTIL, round(WALK * FPS))
    pressed = walk.antenna.max(axis=1) > 0.05 * min(a.swing for a in robot.antennas)
    for time in times:
        now = int(np.searchsorted(walk.time, time))
        backward = time >= period * walk.gaits["left"].index(REVERSED)
        if not pressed[: now + 1].any():
            page.title.set_text("A robot: both legs step forward")
        elif not pressed[now]:
            page.title.set_text("... and, free again, walks on")
        elif backward:
            page.title.set_text("... which steps backward: the robot turns ...")
        else:
            page.title.set_text("An antenna moves an anchor of the left leg ...")
        felt = [bool(force > 1e-3) for force in walk.obstacle_force[now]]
        before = set(world.get_children())
        draw_arena(world, arena(), felt)
        draw_robot(world, robot, walk, now)
        passing = [artist for artist in world.get_children() if artist not in before]
        begin = int(np.searchsorted(walk.time, np.floor(time / period + 1e-9) * period))
        for k, square in enumerate(squares):
            passing += square.draw(walk.travel[begin : now + 1, k] / full[k], 0.2)
        yield page.shoot(passing)


def draw_robot(ax: Any, robot: Robot, walk: Any, now: int) -> None:
    """The robot from above at a sample of its walk, in mm."""
    swings = walk.antenna[now]
    for antenna, swing in zip(walk.robot.antennas, swings, strict=True):
        cell = robot.leg(antenna.leg).chain.levers[0]
        p = np.array(cell.bands[0].p) + np.array(antenna.moves) * swing / antenna.swing
        robot = robot.with_anchors(antenna.leg, antenna.cell, p=tuple(p))

    def on(points: Any) -> Any:
        return in_world(np.asarray(points), walk.x[now], walk.y[now], walk.yaw[now]) * 1e3

    body = on(rectangle((0.0, 0.0), robot.body.length, robot.body.width))
    ax.add_patch(Polygon(body, facecolor=pale(BLOCK, 0.3), edgecolor=INK, linewidth=1.2, zorder=1))
    for antenna in robot.antennas:
        ax.plot(*on(bracket(robot, antenna)).T, color=FAINT, linewidth=1.5, zorder=1)
    for k, leg in enumerate(robot.legs):
        parts = leg_parts(robot, leg, walk.travel[now, k])
        for middle in parts.blocks:
            block = on(rectangle(middle, robot.blocks.length, robot.blocks.width))
            ax.add_patch(Polygon(block, facecolor=BLOCK, edgecolor=INK, linewidth=1.0, zorder=3))
        for lever in parts.levers:
            ax.plot(*on(lever).T, color=INK, linewidth=2.4, zorder=3.3)
        for band, colour in zip(parts.bands, (GREEN, PURPLE), strict=True):
            look = {"marker": "o", "markersize": 4.5, "zorder": 3.5}
            ax.plot(*on(band).T, color=colour, linewidth=3.4, **look)
        moved_by = walk.antenna[now, [a.leg for a in robot.antennas].index(leg.name)]
        if moved_by > 0.05:
            x, y = on(parts.bands[0])[0]
            ax.add_patch(Circle((x, y), 9, fill=False, edgecolor=VERMILLION, lw=2.4, zorder=7))
        foot = on([(parts.tip[0], leg.at[1])])[0]
        # A foot that carries something is on the floor.
        down = walk.foot_force[now, k] > 0.02
        look = {"color": BLUE if down else "white", "markeredgecolor": BLUE, "zorder": 4.4}
        ax.plot(*foot, "o", markersize=9, markeredgewidth=1.6, **look)
    for antenna, swing in zip(robot.antennas, swings, strict=True):
        line = on(antenna_line(antenna, swing))
        ax.plot(*line.T, color=ORANGE, linewidth=3.2, zorder=5)
        ax.plot(*line[0], "o", color=ORANGE, markersize=6, zorder=6)


@styled
def draw(file: Path) -> None:
    """Write the moving picture."""
    pictures = [*first_act(), *second_act()]
    # Thin lines keep their colours only if the palette is told of them.
    colours = (GREEN, PURPLE, ORANGE, VERMILLION, BLUE, YELLOW, INK)
    swatch = Image.new("RGB", (len(colours), 1))
    swatch.putdata([tuple(round(255 * part) for part in to_rgb(one)) for one in colours])
    swatch = swatch.resize((WIDE, HIGH), Image.Resampling.NEAREST)
    lasting = [round(100 / FPS)] * len(pictures)
    lasting[-1] = 100
    write_gif(file, iter(pictures), [swatch, *pictures[:: len(pictures) // 9]], lasting)


if __name__ == "__main__":
    pages = Path(__file__).resolve().parents[1] / "docs" / "img"
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else pages / "stepwell.gif")
