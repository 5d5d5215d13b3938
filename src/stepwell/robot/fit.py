"""Geometric checks of a robot before it walks, and checks for sizes in a wrong unit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import to_unit
from stepwell.mechanism import Slip, SlipError, sizes
from stepwell.robot.shapes import part_problems

if TYPE_CHECKING:
    from stepwell.robot.arena import Arena
    from stepwell.robot.robot import Robot


# Strokes that differ by less than this [m] count as equal.
SAME = 1e-7


def problems(robot: Robot) -> list[str]:
    """Every reason why this robot cannot be built or cannot stand, one line each."""
    checks = (_legs, _reach, _strokes, _standing, _antennas, part_problems)
    return [problem for check in checks for problem in check(robot)]


def _legs(robot: Robot) -> Iterator[str]:
    if len(robot.legs) < 2:
        yield f"legs: {len(robot.legs)} given: a robot has 2 or more."
    names = [leg.name for leg in robot.legs]
    for name in {name for name in names if names.count(name) > 1}:
        yield f"legs: two have the name {name!r}: give each leg its own name."
    for a, b in combinations(robot.legs, 2):
        apart = abs(a.at[1] - b.at[1])
        # From a leg's first moving block to its last, fully open.
        length = robot.foot.span + a.chain.full_stroke + robot.blocks.length
        if apart < robot.blocks.width and abs(a.at[0] - b.at[0]) < length:
            yield (
                f"legs {a.name!r} and {b.name!r} collide: their feet are "
                f"{to_unit(apart, 'mm'):.6g} mm apart sideways and their blocks "
                f"{to_unit(robot.blocks.width, 'mm'):.6g} mm wide; move one of them sideways."
            )
    for leg in robot.legs:
        for point in robot.body.supports:
            near, back = robot.foot.radius, leg.at[0] - leg.chain.full_stroke
            if abs(point[1] - leg.at[1]) < near and back - near < point[0] < leg.at[0] + near:
                yield (
                    f"leg {leg.name!r}: its foot runs into the support at "
                    f"({to_unit(point[0], 'mm'):.6g}, {to_unit(point[1], 'mm'):.6g}) mm; move "
                    f"either sideways by {to_unit(near, 'mm'):.6g} mm."
                )


def _reach(robot: Robot) -> Iterator[str]:
    for leg in robot.legs:
        widest = robot.foot.span + leg.chain.cells[-1].full_travel
        if widest >= 2 * robot.foot.link:
            yield (
                f"leg {leg.name!r}: its pivots open to {to_unit(widest, 'mm'):.6g} mm and two "
                f"links of {to_unit(robot.foot.link, 'mm'):.6g} mm reach "
                f"{to_unit(2.0 * robot.foot.link, 'mm'):.6g} mm; use longer links, a smaller span "
                "or a shorter lever."
            )
        elif robot.foot.below >= robot.foot.depth(0.0) - robot.foot.depth(widest - robot.foot.span):
            yield (
                f"leg {leg.name!r}: foot.below = {to_unit(robot.foot.below, 'mm'):.6g} mm is a "
                f"preload depth that its last cell cannot lift; reduce it."
            )
    if robot.pivot_height <= 0:
        yield (
            f"foot.below = {to_unit(robot.foot.below, 'mm'):.6g} mm: puts the supports above the "
            f"pivots; must be < {to_unit(float(robot.foot.depth(0.0)), 'mm'):.6g} mm."
        )


def _strokes(robot: Robot) -> Iterator[str]:
    strokes = {leg.name: leg.chain.full_stroke for leg in robot.legs}
    if not strokes:
        return
    least = min(strokes.values())
    if max(strokes.values()) - least > SAME:
        each = ", ".join(f"{name!r} {to_unit(own, 'mm'):.6g} mm" for name, own in strokes.items())
        yield f"legs share one actuator but not one full stroke: {each}; make them equal."
    if robot.drive.amplitude > least + SAME:
        yield (
            f"drive.amplitude = {to_unit(robot.drive.amplitude, 'mm'):.6g} mm: must be <= "
            f"{to_unit(least, 'mm'):.6g} mm, the full stroke of the legs' chains; a longer one "
            "pushes against their stops."
        )


def _standing(robot: Robot) -> Iterator[str]:
    supports = list(robot.body.supports)
    for x, y in supports:
        if supports.count((x, y)) > 1:
            at = f"({to_unit(x, 'mm'):.6g}, {to_unit(y, 'mm'):.6g}) mm"
            yield f"body.supports: {at} is given twice; remove or move one."
            return
    x, y, _ = robot.body.centre
    # Distance from there to the edge of the hull of the supports, negative outside.
    angles = np.linspace(0.0, 2.0 * math.pi, 721)
    gap = float(
        (np.subtract(supports, (x, y)) @ [np.cos(angles), np.sin(angles)]).max(axis=0).min()
    )
    if gap <= 0:
        yield (
            f"body.centre = ({to_unit(x, 'mm'):.6g}, {to_unit(y, 'mm'):.6g}) mm "
            f"lies {to_unit(-gap, 'mm'):.3g} mm outside its supports, so the robot falls over when "
            f"the feet lift; move the mass or a support."
        )


def _antennas(robot: Robot) -> Iterator[str]:
    names = [leg.name for leg in robot.legs]
    moved: list[tuple[str, str]] = []
    for antenna in robot.antennas:
        if antenna.leg not in names:
            allowed = ", ".join(map(repr, names))
            yield f"antenna {antenna.name!r}: leg = {antenna.leg!r}: must be one of {allowed}."
            continue
        leg = robot.leg(antenna.leg)
        # Names of the leg and of the cell whose anchor it moves.
        moved.append((leg.name, f"{antenna.cell!r}, which is no cell,"))
        try:
            cell = leg.cell_index(antenna.cell)
            moved[-1] = leg.name, leg.chain.names[cell]
            if len(leg.chain.levers[cell].bands) > 1:
                yield (
                    f"antenna {antenna.name!r}: its cell has several bands: an antenna moves the "
                    f"anchor of one; split the cell's bands or give it one."
                )
            else:
                leg.with_moved_anchor(cell, antenna.moves)
        except ValueError as error:
            yield f"antenna {antenna.name!r}: {error}"
    for name, cell in {each for each in moved if moved.count(each) > 1}:
        yield f"antennas: two move the anchor of {cell} of leg {name!r}: give it one."


# Weights over the force of the bands of a leg: of the body, and of parts that a leg moves.
_BODY, _PART = (1 / 50, 50.0), (1 / 2000, 10.0)
# Distance of the farthest point of an arena, and thickness of its obstacles [m].
FARTHEST = 0.010, 100.0
THICKNESS = 5e-4, 10.0


def refuse_slips(value: Robot | Arena, slips: Iterable[Slip]) -> None:
    """Refuse sizes that are probably in another unit; copies by `replace` are not checked again."""
    if not (value.unusual or value._asked) and (suspects := tuple(slips)):
        raise SlipError(suspects, "If it is meant so, pass unusual=True.")
    object.__setattr__(value, "_asked", True)


def of_robot(robot: Robot) -> Iterator[Slip]:
    """All numbers of a robot, without its chains, that are probably in another unit."""
    # Lengths are compared with the longest stroke of a leg, as those of a cell with its lever.
    size = max((leg.chain.full_stroke for leg in robot.legs), default=0.0)
    cells = [cell for leg in robot.legs for cell in leg.chain.levers]
    own = max((sizes.own_force(cell, cell.lever) for cell in cells), default=0.0)
    if not size or not own:
        return
    yield from _lengths("drive", robot.drive, ("amplitude",), size)
    yield from _lengths("foot", robot.foot, ("link", "span"), size)
    yield from sizes.far("foot.below", robot.foot.below, size)
    yield from _lengths("body", robot.body, ("length", "width"), size)
    yield from _lengths("blocks", robot.blocks, ("length", "width"), size)
    farthest = max(robot.body.supports, key=lambda point: math.hypot(*point), default=(0.0, 0.0))
    yield from _of_stroke("body.supports", farthest, size)
    for part in ("body", "foot", "blocks"):
        yield from _mass(f"{part}.mass", getattr(robot, part).mass, own)
    if robot.blocks.outer is not None:
        yield from _mass("blocks.outer", robot.blocks.outer, own)
    yield from sizes.force("floor.drag", robot.floor.drag, own)
    for i, leg in enumerate(robot.legs):
        yield from _of_stroke(f"leg[{i}].at", leg.at, size)
    for i, antenna in enumerate(robot.antennas):
        where = f"antenna[{i}]"
        yield from _lengths(where, antenna, ("pivot", "length", "moves"), size)
        yield from _mass(f"{where}.mass", antenna.mass, own)
        for name in ("angle", "swing", "hook_angle"):
            turned = math.degrees(angle := getattr(antenna, name))
            if 0 < abs(angle) < sizes.LEAST_LIMIT:
                likely = turned if abs(turned) <= math.pi else None
                yield Slip(f"{where}.{name}", angle, likely, "rad", f"is {turned:.4g}°")


def _lengths(where: str, part: object, names: tuple[str, ...], size: float) -> Iterator[Slip]:
    for name in names:
        yield from _of_stroke(f"{where}.{name}", getattr(part, name), size)


def _of_stroke(name: str, value: sizes.Size, size: float) -> Iterator[Slip]:
    why = f"is far off the stroke of its legs, {to_unit(size, 'mm'):.4g} mm"
    for slip in sizes.length(name, value, size):
        yield slip._replace(why=why)


def _mass(name: str, mass: float, own: float) -> Iterator[Slip]:
    low, high = (share * own / 9.81 for share in (_BODY if name == "body.mass" else _PART))
    if not low <= mass <= high:
        why = f"is far off what bands of about {own:.3g} N move"
        yield Slip(name, mass, sizes.meant(mass, low, high), "kg", why)


def of_arena(arena: Arena) -> Iterator[Slip]:
    """All numbers of an arena that are probably in another unit."""
    points = [arena.start, *(end for wall in arena.walls for end in (wall.start, wall.end))]
    points += [one.at for one in (*arena.cylinders, *arena.plates)]
    points += [corner for patch in arena.patches for corner in (patch.start, patch.end)]
    points += [arena.goal.at] if arena.goal else []
    farthest = max(points, key=lambda point: math.hypot(*point))
    low, high = FARTHEST
    reaches = [reach for point in points if (reach := math.hypot(*point))]
    # The mean on a logarithmic scale: one far goal or wall among near ones is no slip.
    usual = math.exp(np.mean(np.log(np.maximum(reaches, low)))) if reaches else low
    if reaches and (max(reaches) < low or usual > high):
        why = f"arenas reach from {to_unit(low, 'mm'):g} mm to {high:g} m"
        yield Slip("the farthest point", farthest, sizes.meant(farthest, low, high), "m", why)
    low, high = THICKNESS
    thick = [(f"wall[{i}].thickness", wall.thickness) for i, wall in enumerate(arena.walls)]
    thick += [(f"cylinder[{i}].radius", one.radius) for i, one in enumerate(arena.cylinders)]
    for name, value in thick:
        if not low <= value <= high:
            why = f"obstacles are from {to_unit(low, 'mm'):g} mm to {high:g} m thick"
            yield Slip(name, value, sizes.meant(value, low, high), "m", why)
