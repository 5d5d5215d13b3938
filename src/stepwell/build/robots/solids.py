"""Shapes of a robot's parts: meshes to draw, and convex hulls that collide with obstacles."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.build.contour import Contour
from stepwell.build.exports.solids import mesh_of
from stepwell.build.part import Part
from stepwell.build.plates import Fastener
from stepwell.build.robots.antennas import ROD
from stepwell.build.robots.making import Bought
from stepwell.build.robots.masses import body_mass, in_robot
from stepwell.build.robots.robot_layout import RobotLayout, turned
from stepwell.robot import PartRole, RobotParts, Shape, body_names

# Arcs of meshes to draw are at most this far from their chords [m]; sides of a drawn pin.
_SAGITTA, _SIDES = 5e-5, 12
# Heights of a block above the body plate that collide are those of its plates.
_ROLES = {"standoff": PartRole.SUPPORT, "screw": PartRole.PIN}


def robot_parts(layout: RobotLayout, material: str) -> RobotParts:
    """All shapes and masses of a layout, in the reference pose.

    Args:
        layout: of the robot.
        material: name of the build file.
    """
    names = body_names(layout.robot)
    shapes = [*_drawn(layout), *_colliding(layout)]
    masses = [body_mass(layout, name) for name in names]
    cords = {one.antenna: ((one.hub, one.start), (one.crank, one.end)) for one in layout.cords}
    return RobotParts(shapes, masses, material, _hinges(layout, names), cords)


def _hinges(layout: RobotLayout, names: Sequence[str]) -> dict[str, tuple[float, float, float]]:
    pose = layout.pose()
    z = layout.plan.heights.middle + layout.plan.thick / 2.0
    found = {}
    for name in names:
        if ".lever " in name or name.endswith(".crank"):
            x, y = layout.moved(name, pose).hinge
            found[name] = (x, y, z)
    return found


def _drawn(layout: RobotLayout) -> Iterator[Shape]:
    for part in layout.parts:
        vertices, faces = part_mesh(layout, part)
        yield Shape(
            layout.body[part.name], part.name, vertices, faces, PartRole(layout.roles[part.name])
        )
    for one in layout.fasteners:
        if one.use != "shim":
            vertices, faces = _cylinder(one)
            role = _ROLES.get(one.use, PartRole.PIN)
            yield Shape(str(one.block), f"{one.use} {one.name}", vertices, faces, role)
    for box in layout.boxes:
        vertices, faces = _box(box)
        yield Shape(box.body, box.name, vertices, faces, PartRole(box.role))


def part_mesh(layout: RobotLayout, part: Part, sagitta: float = _SAGITTA) -> tuple[Floats, Ints]:
    """Corners (n, 3) [m] and triangles (m, 3) of a part in the reference pose."""
    mesh, place = mesh_of(part, sagitta), layout.places[part.name]
    vertices = in_robot(mesh.corners + np.array([0.0, 0.0, part.base]), place)
    faces = mesh.triangles[:, ::-1] if place.upright else mesh.triangles
    return vertices, faces


def _cylinder(one: Fastener) -> tuple[Floats, Ints]:
    sides = 6 if one.use in ("nut", "standoff") else _SIDES
    angles = 2.0 * math.pi * np.arange(sides) / sides
    ring = one.diameter / 2.0 * np.column_stack([np.cos(angles), np.sin(angles)])
    return _prism(ring + np.array(one.centre), one.low, one.high, upright=one.upright)


def _prism(ring: Floats, low: float, high: float, *, upright: bool) -> tuple[Floats, Ints]:
    """A convex ring (n, 2), counter-clockwise, between two heights."""
    count = len(ring)
    flat = [np.column_stack([ring, np.full(count, height)]) for height in (low, high)]
    vertices = np.concatenate(flat)
    ahead = (np.arange(count) + 1) % count
    here = np.arange(count)
    sides = np.concatenate(
        [
            np.column_stack([here, ahead, ahead + count]),
            np.column_stack([here, ahead + count, here + count]),
        ]
    )
    fan = np.column_stack([np.zeros(count - 2, int), here[1:-1], here[2:]])
    faces = np.concatenate([sides, fan[:, ::-1], fan + count])
    if upright:
        return vertices[:, [0, 2, 1]], faces[:, ::-1]
    return vertices, faces


def _box(one: Bought) -> tuple[Floats, Ints]:
    (x0, y0, z0), (x1, y1, z1) = one.low, one.high
    ring = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    return _prism(ring, z0, z1, upright=False)


def _colliding(layout: RobotLayout) -> Iterator[Shape]:
    """Convex shapes: the body plate and its nose, carriage, blocks, rods, feet and supports."""
    plan, high = layout.plan, layout.plan.heights
    rear, front, half = plan.plate
    reach, narrow = plan.nose
    blocks = [(rear, -half, front, half)]
    if reach > front:
        blocks.append((front, -narrow, reach, narrow))
    for x0, y0, x1, y1 in blocks:
        ring = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        yield _hull("body", ring, (high.rail, high.rail + plan.thick), PartRole.BODY)
    for body in body_names(layout.robot):
        kind = body.rpartition(".")[2]
        if kind == "block" or body == "carriage":
            yield from _block(layout, body)
        elif kind == "foot":
            yield from _foot(layout, body)
    for one in layout.fasteners:
        if one.use == "head" and one.name.startswith("support"):
            vertices, faces = _cylinder(one)
            yield Shape("body", one.name, vertices, faces, PartRole.SUPPORT, collides=True)
    for antenna in plan.antennas:
        name = f"{antenna.antenna.name}.antenna"
        place = layout.places[f"{antenna.label}-antenna"]
        for ring in _segments(layout, antenna.index):
            at = np.array([turned(point, place.angle) for point in ring.tolist()])
            ends = (antenna.base, antenna.base + plan.thick)
            yield _hull(name, at + np.array((place.x, place.y)), ends, PartRole.ANTENNA)


def _hull(body: str, ring: Floats, ends: tuple[float, float], role: PartRole) -> Shape:
    vertices, faces = _prism(ring, *ends, upright=False)
    return Shape(body, "outline", vertices, faces, role, collides=True)


def _block(layout: RobotLayout, body: str) -> Iterator[Shape]:
    """The convex hull in plan of the flat parts of a body, through all their layers."""
    import shapely

    parts = [
        one
        for one in layout.parts
        if layout.body[one.name] == body and not layout.places[one.name].upright
    ]
    if body == "carriage":
        parts = [one for one in parts if one.name == "carriage-bar"]
    rings = []
    for part in parts:
        place = layout.places[part.name]
        rings.append(part.outline.ring(1e-4) + np.array((place.x, place.y)))
    hull: Any = shapely.MultiPoint(np.concatenate(rings)).convex_hull
    ring = shapely.get_coordinates(shapely.orient_polygons(hull).exterior)[:-1]
    ends = min(one.base for one in parts), max(one.top for one in parts)
    yield _hull(body, ring, ends, PartRole(layout.roles[parts[0].name]))


def _foot(layout: RobotLayout, body: str) -> Iterator[Shape]:
    parts = [one for one in layout.parts if layout.body[one.name] == body]
    place = layout.places[parts[0].name]
    ring = parts[0].outline.ring(1e-4) + np.array((place.x, place.y))
    ends = min(one.base for one in parts), max(one.top for one in parts)
    vertices, faces = _prism(ring, *ends, upright=True)
    yield Shape(body, "outline", vertices, faces, PartRole.FOOT, collides=True)


def _segments(layout: RobotLayout, number: int) -> Iterator[Floats]:
    """Straight pieces of a rod and its hook, in the frame of the part [m]."""
    one = layout.plan.antennas[number]
    antenna, wide = one.antenna, ROD
    tip = (antenna.length, 0.0)
    yield Contour.slot((0.0, 0.0), tip, wide).ring(1e-4)
    if antenna.hook > 0.0:
        bent = antenna.side * antenna.hook_angle
        end = (tip[0] + antenna.hook * math.cos(bent), antenna.hook * math.sin(bent))
        yield Contour.slot(tip, end, wide).ring(1e-4)
