"""Panel of a robot in its parts: solids once for a design, places of bodies along the stroke."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from stepwell.base import Floats, to_unit
from stepwell.build import RobotBuild, RobotLayout, build
from stepwell.mechanism import layout as drawing
from stepwell.robot import Robot, Shape
from stepwell.statics import Path
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.motion import drawn
from stepwell.studio.panels.parts import material, materials

Angles = Mapping[tuple[str, int | str], Floats]


def answer_robot_parts(design: PageDesign, ask: Ask) -> View:
    """The solids of a robot's parts, and where they are at each sample of panel `evaluate`.

    V corners, T triangles, n samples, B bodies, K bands. `corners` (V, 3) [mm] are those at rest,
    `triangles` (T, 3) are counter-clockwise seen from outside, both in the order of `parts`.
    `moved` (s, n, B, 4) is the shift x, y, z [mm] of a body after a rotation [rad] about its hinge:
    in plan from x to y, and of an `upright` body from x to z. Bands and cords lie between points of
    two bodies, `at_mm` at rest; `tension` (s, n, K) of bands is a fraction of the greatest tension
    of any band, 0 if slack. s is 1, or 2 for a robot with antennas: first at rest, then with all of
    them pressed; the `antenna` of a body decides which holds. The motion is quasi-static without a
    floor: at each sample of the leg that is shown, with its antenna at rest, all others are at the
    same stroke.
    """
    robot, chain, build_file = design.robot, design.chain, material(ask)
    ask.close()
    made = build(robot, build_file)
    layout = made.layout
    shapes = [one for one in made.made.shapes if not one.collides]
    names = [one.body for one in made.made.masses]
    path = drawn(chain.cycle().path)
    swings = {one.name: one.swing for one in robot.antennas if one.connected}
    robots, poses = [robot], [_angles(robot, path)]
    if swings:
        robots.append(robot.pressed(swings))
        swung = {("antenna", name): np.array([swing]) for name, swing in swings.items()}
        poses.append({**_angles(robots[1], path), **swung})
    first = np.cumsum([0, *(len(one.vertices) for one in shapes)])
    header = {
        "parts": _parts(shapes, names),
        "bodies": _bodies(layout, names),
        "bands": _bands(made, names),
        "cords": _cords(layout, names),
        "antennas": list(swings),
        "mass_g": to_unit(made.mass, "g"),
        "materials": materials(),
    }
    vertices = np.concatenate([one.vertices for one in shapes])
    faces = [one.faces + start for one, start in zip(shapes, first[:-1], strict=True)]
    tables = {
        "corners": to_unit(vertices, "mm"),
        "moved": np.stack([moved(layout, names, angles) for angles in poses]),
        "tension": _tensions(layout, robots, poses),
    }
    blocks = {name: table.astype(np.float32) for name, table in tables.items()}
    return View(
        header,
        {
            **blocks,
            "triangles": np.concatenate(faces),
            "drive": to_unit(path.drive, "mm"),
            "direction": path.direction,
        },
    )


def _parts(shapes: Sequence[Shape], bodies: Sequence[str]) -> list[dict[str, Any]]:
    return [
        {
            "name": one.part,
            "body": bodies.index(one.body),
            "role": one.colour.value,
            "corners": len(one.vertices),
            "triangles": len(one.faces),
        }
        for one in shapes
    ]


def _bands(made: RobotBuild, bodies: Sequence[str]) -> list[dict[str, Any]]:
    return [
        {
            "name": f"band {one.number + 1} of {made.band_words(use)[0]}",
            "bodies": [bodies.index(body) for body in one.bodies],
            "at_mm": [_mm((*end, (one.low + one.high) / 2.0)) for end in (one.p, one.q)],
            "width_mm": to_unit(one.width, "mm"),
            "height_mm": to_unit(one.high - one.low, "mm"),
        }
        for one, use in zip(made.layout.bands, made.bands, strict=True)
    ]


def _cords(layout: RobotLayout, bodies: Sequence[str]) -> list[dict[str, Any]]:
    return [
        {
            "name": f"cord of {one.antenna}",
            "bodies": [bodies.index(body) for body in (one.hub, one.crank)],
            "at_mm": [_mm(end) for end in (one.start, one.end)],
            "width_mm": to_unit(one.diameter, "mm"),
        }
        for one in layout.cords
    ]


def _mm(place: Sequence[float]) -> list[float]:
    return [to_unit(one, "mm") for one in place]


def _angles(robot: Robot, shown: Path) -> Angles:
    """Angles (n,) of all cells [rad], of every leg at the stroke and in the half of each sample."""
    found: dict[tuple[str, int | str], Floats] = {}
    for leg in robot.legs:
        same = leg.chain == shown.chain
        own = shown if same else drawn(leg.chain.cycle().path)
        for i, cell in enumerate(leg.chain.levers):
            travel = own.travel[:, i]
            found[leg.name, i] = cell.angle(travel if same else _at(shown, own, travel))
    return found


def _at(shown: Path, own: Path, travel: Floats) -> Floats:
    """A travel along `own` at the strokes of `shown`, loading and unloading apart."""
    found = np.empty(len(shown.drive))
    for way in (1, -1):
        here, rows = shown.direction == way, own.direction == way
        found[here] = np.interp(shown.drive[here], own.drive[rows][::way], travel[rows][::way])
    return found


def _bodies(layout: RobotLayout, names: Sequence[str]) -> list[dict[str, Any]]:
    """The hinge of each body, and the name of the antenna that it depends on; "" for none."""
    antennas = layout.plan.antennas
    of_leg = {one.leg.leg.name: one.antenna.name for one in antennas}
    bodies = list[dict[str, Any]]()
    for name in names:
        owner, kind = layout.motions.split(name)
        upright = layout.motions.upright(name)
        x, second = layout.motions.of(name, {}).hinge
        hinge = (x, 0.0, second) if upright else (x, second, 0.0)
        antenna = owner if kind in ("antenna", "crank") else of_leg.get(owner, "")
        bodies.append(
            {"name": name, "upright": upright, "hinge_mm": _mm(hinge), "antenna": antenna}
        )
    return bodies


def moved(layout: RobotLayout, names: Sequence[str], angles: Angles) -> Floats:
    """Shifts x, y, z [mm] and rotations [rad] (n, B, 4) of bodies about their hinges."""
    found = layout.motions.table(names, angles)
    found[:, :, :3] = to_unit(found[:, :, :3], "mm")
    return found


def _tensions(layout: RobotLayout, robots: Sequence[Robot], poses: Sequence[Angles]) -> Floats:
    """Tensions of all bands (s, n, K) as fractions of the greatest of any [1]."""
    greatest, rows = 0.0, list[Floats]()
    for robot, angles in zip(robots, poses, strict=True):
        columns = list[Floats]()
        for one in layout.bands:
            cell = robot.leg(one.leg).chain.levers[one.cell % 2]
            band, theta = cell.bands[one.number], angles[one.leg, one.cell % 2]
            columns.append(np.abs(band.tension(band.length(theta, cell.lever))))
            greatest = max(greatest, drawing.greatest_tension(cell))
        rows.append(np.stack(columns, axis=1))
    return np.stack(rows) / (greatest or 1.0)
