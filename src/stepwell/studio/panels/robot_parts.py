"""Panel of a robot in its parts: solids once for a design, places of bodies along the stroke."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from stepwell.base import Floats, to_unit
from stepwell.build import RobotLayout, build
from stepwell.mechanism import layout as drawing
from stepwell.robot import Robot
from stepwell.statics import Path
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.motion import drawn
from stepwell.studio.panels.parts import material, materials

Angles = Mapping[tuple[str, int | str], Floats]


def answer_robot_parts(design: PageDesign, ask: Ask) -> View:
    """The solids of a robot's parts, and where they are at each sample of panel `evaluate`.

    V corners, T triangles, n samples, B bodies, K bands. `corners` (V, 3) [mm] are those at rest,
    `triangles` (T, 3) are counter-clockwise seen from outside, both in the order of `parts`.
    `moved` (n, B, 4) is the shift x, y, z [mm] of a body after a rotation [rad] about its hinge: in
    plan from x to y, and of an `upright` body from x to z. `ends` (n, K, 4) are the hooks x, y and
    x, y [mm] of a band in plan; `tension` (n, K) is a fraction of the greatest tension of any band,
    0 if slack. The motion is quasi-static without a floor: at each sample of the leg that is shown,
    the other leg is at the same stroke. Antennas are at rest.
    """
    robot, chain, build_file = design.robot, design.chain, material(ask)
    ask.close()
    made = build(robot, build_file)
    layout = made.layout
    shapes = [one for one in made.made.shapes if not one.collides]
    names = [one.body for one in made.made.masses]
    path = drawn(chain.cycle().path)
    angles = _angles(robot, path)
    first = np.cumsum([0, *(len(one.vertices) for one in shapes)])
    bodies, moved = _moved(layout, names, angles)
    header = {
        "parts": [
            {
                "name": one.part,
                "body": names.index(one.body),
                "role": one.colour.value,
                "corners": len(one.vertices),
                "triangles": len(one.faces),
            }
            for one in shapes
        ],
        "bodies": bodies,
        "bands": [
            {
                "name": f"band {one.number + 1} of {words}",
                "z_mm": to_unit((one.low + one.high) / 2.0, "mm"),
                "width_mm": to_unit(one.width, "mm"),
                "height_mm": to_unit(one.high - one.low, "mm"),
            }
            for one, use in zip(layout.bands, made.bands, strict=True)
            for words in [made.band_words(use)[0]]
        ],
        "mass_g": to_unit(made.mass, "g"),
        "materials": materials(),
    }
    vertices = np.concatenate([one.vertices for one in shapes])
    faces = [one.faces + start for one, start in zip(shapes, first[:-1], strict=True)]
    tables = {
        "corners": to_unit(vertices, "mm"),
        "moved": moved,
        "ends": _ends(layout, angles),
        "tension": _tensions(layout, angles),
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


def _moved(
    layout: RobotLayout, names: Sequence[str], angles: Angles
) -> tuple[list[dict[str, Any]], Floats]:
    """The hinges of all bodies, and their shifts and rotations (n, B, 4)."""
    bodies, rows = list[dict[str, Any]](), list[Floats]()
    for name in names:
        moved, upright = layout.motions.of(name, angles), layout.motions.upright(name)
        second = 2 if upright else 1
        hinge, row = np.zeros(3), np.zeros((len(moved.turn), 4))
        hinge[[0, second]], row[:, [0, second]] = moved.hinge, moved.shift
        bodies.append({"name": name, "upright": upright, "hinge_mm": to_unit(hinge, "mm").tolist()})
        row[:, :3] = to_unit(row[:, :3], "mm")
        row[:, 3] = moved.turn
        rows.append(row)
    return bodies, np.stack(rows, axis=1)


def _ends(layout: RobotLayout, angles: Angles) -> Floats:
    """Hooks of all bands (n, K, 4) [mm]."""
    ends = [
        [
            layout.motions.of(body, angles).of(point)
            for body, point in zip(band.bodies, (band.p, band.q), strict=True)
        ]
        for band in layout.bands
    ]
    return to_unit(np.stack([np.column_stack(both) for both in ends], axis=1), "mm")


def _tensions(layout: RobotLayout, angles: Angles) -> Floats:
    """Tensions of all bands (n, K) as fractions of the greatest of any [1]."""
    greatest = max(drawing.greatest_tension(layout.cell(band)) for band in layout.bands)
    columns = []
    for one in layout.bands:
        cell = layout.cell(one)
        band, theta = cell.bands[one.number], angles[one.leg, one.cell % 2]
        columns.append(np.abs(band.tension(band.length(theta, cell.lever))))
    return np.stack(columns, axis=1) / (greatest or 1.0)
