"""A robot in its solid parts, from above and from the side."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, PathPatch, Rectangle
from matplotlib.path import Path

from stepwell.base import Floats
from stepwell.build import Contour, Part, RobotBuild, RobotLayout
from stepwell.figures.common import legends, marks, sheet, style
from stepwell.figures.common.words import literal
from stepwell.robot import PartRole

# Chords of drawn arcs are at most this far off [m].
_SAGITTA = 3e-5
_EDGE, _ABOVE, _BELOW, _GAP = 2.0, 6.0, 17.0, 4.0
# Length of the scale [mm].
_SCALE = 50.0
_COLOURS: dict[str, str] = {
    PartRole.BODY: style.FIXED_BLOCK,
    PartRole.SUPPORT: style.FIXED_BLOCK,
    PartRole.CARRIAGE: style.VERMILLION,
    PartRole.MIDDLE_BLOCK: style.BLUE,
    PartRole.OUTER_BLOCK: style.GREEN,
    PartRole.LEVER: style.INK,
    PartRole.LINK: style.PURPLE,
    PartRole.FOOT: style.INK,
    PartRole.ANTENNA: style.ORANGE,
    PartRole.CRANK: style.ORANGE,
    PartRole.ACTUATOR: style.BOUGHT,
    PartRole.BATTERY: style.BOUGHT,
    PartRole.PIN: style.FAINT,
}
_NAMED = (
    ("body", PartRole.BODY),
    ("carriage", PartRole.CARRIAGE),
    ("middle block", PartRole.MIDDLE_BLOCK),
    ("outer block", PartRole.OUTER_BLOCK),
    ("lever", PartRole.LEVER),
    ("link", PartRole.LINK),
    ("foot", PartRole.FOOT),
)
_PALE = 0.25
_BOUGHT: dict[str, Any] = {"edgecolor": style.FAINT, "linewidth": 0.6, "linestyle": ":"}
Pose = Mapping[tuple[str, int | str], float]


@style.styled
def robot_parts(build: RobotBuild) -> Figure:
    """The parts of a robot from above, at rest and at half the stroke, and from the side.

    At half the stroke the first leg is in state 10 and the second in 01, and one antenna is
    pressed. From the side the V of the first leg is drawn in states 00 and 11.

    Args:
        build: of the robot.
    """
    layout = build.layout
    first, second = (leg.name for leg in layout.robot.legs)
    swings = {one.name: one.swing for one in layout.robot.antennas[:1]}
    half = layout.pose({first: "10", second: "01"}, swings)
    panels = [
        ("Both legs 00", layout.pose(), False),
        (f"{literal(first)} 10, {literal(second)} 01", half, False),
        (f"{literal(first)} 00", layout.pose(), True),
        (f"{literal(first)} 11", layout.pose({first: "11", second: "11"}), True),
    ]
    width = sheet.page_width(style.PAGE)
    columns = 2 if width >= sheet.SIDE_BY_SIDE else 1
    wide = (width - _GAP * (columns - 1)) / columns
    boxes = [
        _box(layout, [pose for _, pose, one in panels if one is up], up=up) for up in (False, True)
    ]
    talls = [(wide - 2.0 * _EDGE) * (b[3] - b[2]) / (b[1] - b[0]) + 2.0 * _EDGE for b in boxes]
    top = 2 // columns * sum(tall + _ABOVE for tall in talls) + _BELOW
    figure = sheet.blank(width, top)
    for number, (name, pose, up) in enumerate(panels):
        column = number % columns
        if column == 0:
            top -= talls[up] + _ABOVE
        ax = sheet.place(figure, column * (wide + _GAP), top, wide, talls[up])
        marks.plain(ax, boxes[up])
        _draw(ax, layout, pose, up=up)
        if up and column == columns - 1:
            marks.scale_bar(ax, boxes[up][1] - 2.0, boxes[up][2] + 6.0, _SCALE)
        sheet.name_panel(ax, name if build.can_be_built else f"DRAFT: {name}", 0.8)
    found = _legend(bool(layout.robot.antennas))
    legends.below(figure, found, 4 if columns == 2 else 3, left=2.0, handlelength=1.0)
    return figure


def _legend(antennas: bool) -> list[Artist]:
    key: list[Artist] = [legends.shade(name, _shade(role)) for name, role in _NAMED]
    if antennas:
        key.append(legends.shade("antenna and crank", _shade(PartRole.ANTENNA)))
    key.append(legends.shade("actuator and battery", "none", **_BOUGHT))
    bands = zip(("inner", "outer"), style.cell_colours(2), strict=True)
    key += [legends.line(f"band of {name} cells", colour, 1.6) for name, colour in bands]
    return key


def _shade(role: str) -> style.Colour:
    return style.pale(_COLOURS[role], _PALE)


def _placed(layout: RobotLayout, part: Part, pose: Pose) -> PathPatch:
    frame = layout.frames_of(part, pose)
    rings = [part.outline, *part.openings]
    placed = [_ring(one, frame.x, frame.y, frame.angle) for one in rings]
    placed[1:] = [one[::-1] for one in placed[1:]]
    vertices = np.concatenate([np.vstack([ring, ring[:1]]) for ring in placed])
    codes = np.concatenate(
        [[Path.MOVETO, *[Path.LINETO] * (len(ring) - 1), Path.CLOSEPOLY] for ring in placed]
    )
    role = layout.roles[part.name]
    return PathPatch(
        Path(vertices, codes), facecolor=_shade(role), edgecolor=style.INK, linewidth=0.35
    )


def _ring(contour: Contour, x: float, y: float, angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return (contour.ring(_SAGITTA) @ np.array([[c, s], [-s, c]]) + np.array([x, y])) * style.MM


def _box(layout: RobotLayout, poses: Sequence[Pose], *, up: bool) -> sheet.Box:
    points = []
    for pose in poses:
        for part in layout.parts:
            if layout.places[part.name].upright is up:
                path = _placed(layout, part, pose).get_path()
                points.append(np.asarray(path.vertices))
    every = np.concatenate(points)
    (x0, y0), (x1, y1) = every.min(axis=0), every.max(axis=0)
    if up:
        flat = list(_flat_boxes(layout, poses[0]))
        x0, x1 = min(b[0] for b in flat), max(b[0] + b[2] for b in flat)
        y0 = min(y0, layout.plan.heights.floor * style.MM)
        y1 = max(y1, layout.plan.heights.bands * style.MM)
    return float(x0) - 3.0, float(x1) + 3.0, float(y0) - 2.0, float(y1) + 2.0


def _flat_boxes(
    layout: RobotLayout, pose: Pose
) -> Iterator[tuple[float, float, float, float, str]]:
    """From the side: left, low, width, height [mm] and role of each flat part of the first leg."""
    other = layout.plan.legs[1].label
    for part in layout.parts:
        if layout.places[part.name].upright or part.name.startswith(other):
            continue
        x, _ = np.asarray(_placed(layout, part, pose).get_path().vertices).T
        low, high = part.base * style.MM, part.top * style.MM
        yield float(x.min()), low, float(np.ptp(x)), high - low, layout.roles[part.name]


def _draw(ax: Axes, layout: RobotLayout, pose: Pose, *, up: bool) -> None:
    if up:
        _draw_side(ax, layout, pose)
        return
    for part in layout.parts:
        if not layout.places[part.name].upright:
            ax.add_patch(_placed(layout, part, pose))
    for box in layout.boxes:
        shift = layout.moved(box.body, pose).shift[0] * style.MM
        x, y = np.array(box.low[:2]) * style.MM + shift
        width, height = (np.array(box.high[:2]) - np.array(box.low[:2])) * style.MM
        place = (float(x), float(y))
        ax.add_patch(Rectangle(place, float(width), float(height), facecolor="none", **_BOUGHT))
    for band in layout.bands:
        both = tuple(zip(band.bodies, (band.p, band.q), strict=True))
        ends = np.array([_moved(layout, *one, pose) for one in both])
        colours = style.cell_colours(2)
        ax.plot(*(ends * style.MM).T, color=colours[band.cell % 2], linewidth=1.6, zorder=5)
    for cord in layout.cords:
        both = ((cord.hub, cord.start[:2]), (cord.crank, cord.end[:2]))
        ends = np.array([_moved(layout, *one, pose) for one in both])
        ax.plot(*(ends * style.MM).T, color=style.INK, linewidth=0.6, zorder=5)


def _moved(layout: RobotLayout, body: str, point: tuple[float, float], pose: Pose) -> Floats:
    moved = layout.moved(body, pose)
    c, s = np.cos(moved.turn[0]), np.sin(moved.turn[0])
    x, y = np.array(point) - np.array(moved.hinge)
    return np.array([c * x - s * y, s * x + c * y]) + np.array(moved.hinge) + moved.shift[0]


def _draw_side(ax: Axes, layout: RobotLayout, pose: Pose) -> None:
    other = layout.plan.legs[1].label
    for x, low, width, height, role in _flat_boxes(layout, pose):
        look = {"facecolor": _shade(role), "edgecolor": style.FAINT, "linewidth": 0.3}
        ax.add_patch(Rectangle((x, low), width, height, alpha=0.6, **look))
    for part in layout.parts:
        if layout.places[part.name].upright and not part.name.startswith(other):
            ax.add_patch(_placed(layout, part, pose))
    for one in layout.fasteners:
        if one.upright and not one.name.startswith(other):
            x, z = _moved(layout, str(one.block), one.centre, pose) * style.MM
            look = {"facecolor": "white", "edgecolor": style.INK, "linewidth": 0.4, "zorder": 4}
            ax.add_patch(Circle((float(x), float(z)), one.diameter * style.MM / 2.0, **look))
        elif one.use in ("standoff", "head") and not one.upright:
            x, half = one.centre[0] * style.MM, one.diameter * style.MM / 2.0
            low, high = one.low * style.MM, one.high * style.MM
            look = {"facecolor": _shade(PartRole.BODY), "edgecolor": style.FAINT, "linewidth": 0.3}
            ax.add_patch(Rectangle((x - half, low), 2.0 * half, high - low, zorder=0.5, **look))
    floor = layout.plan.heights.floor * style.MM
    ax.axhline(floor, color=style.INK, linewidth=1.0)
