"""Slips of unit in a robot and in an arena: sizes far off its legs' stroke, its bands, a room."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from stepwell.mechanism import Slip, SlipError, sizes

if TYPE_CHECKING:
    from stepwell.robot.parts.arena import Arena
    from stepwell.robot.parts.robot import Robot

# Weights over what the bands of a leg pull with: of the body, and of parts that a leg moves.
_BODY, _PART = (1 / 50, 50.0), (1 / 2000, 10.0)
# How far an arena goes, and how thick what stands in it is [m].
FARTHEST = 0.010, 100.0
THICKNESS = 5e-4, 10.0


def refuse_slips(value: Robot | Arena, slips: Iterable[Slip]) -> None:
    """Refuse sizes in another unit, once: what `replace` makes of a value is not asked again."""
    if not (value.unusual or value._asked):
        found = tuple(slips)
        if found:
            raise SlipError(found, "If it is meant so, say unusual=True.")
    object.__setattr__(value, "_asked", True)


def of_robot(robot: Robot) -> Iterator[Slip]:
    """All numbers of a robot that are probably in another unit; of its chains, their cells tell."""
    # Lengths are beside the longest stroke of a leg, as those of a cell are beside its lever.
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
    yield from sizes.force("floor.drag", robot.floor.drag, own)
    for i, leg in enumerate(robot.legs):
        yield from _of_stroke(f"leg[{i}].at", leg.at, size)
    for i, antenna in enumerate(robot.antennas):
        where = f"antenna[{i}]"
        yield from _lengths(where, antenna, ("pivot", "length", "moves"), size)
        yield from _mass(f"{where}.mass", antenna.mass, own)
        for name in ("angle", "swing", "hook_angle"):
            angle = getattr(antenna, name)
            turned = math.degrees(angle)
            if 0 < abs(angle) < sizes.LEAST_LIMIT:
                likely = turned if abs(turned) <= math.pi else None
                yield Slip(f"{where}.{name}", angle, likely, "rad", f"is {turned:.4g}°")


def _lengths(where: str, part: object, names: tuple[str, ...], size: float) -> Iterator[Slip]:
    for name in names:
        yield from _of_stroke(f"{where}.{name}", getattr(part, name), size)


def _of_stroke(name: str, value: sizes.Size, size: float) -> Iterator[Slip]:
    why = f"is far off the stroke of its legs, {size * 1e3:.4g} mm"
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
    points += [one.at for one in arena.cylinders]
    points += [arena.goal.at] if arena.goal else []
    farthest = max(points, key=lambda point: math.hypot(*point))
    low, high = FARTHEST
    reach = math.hypot(*farthest)
    if reach and not low <= reach <= high:
        why = f"arenas reach from {low * 1e3:g} mm to {high:g} m"
        yield Slip("the farthest point", farthest, sizes.meant(farthest, low, high), "m", why)
    low, high = THICKNESS
    thick = [(f"wall[{i}].thickness", wall.thickness) for i, wall in enumerate(arena.walls)]
    thick += [(f"cylinder[{i}].radius", one.radius) for i, one in enumerate(arena.cylinders)]
    for name, value in thick:
        if not low <= value <= high:
            why = f"what stands in an arena is from {low * 1e3:g} mm to {high:g} m thick"
            yield Slip(name, value, sizes.meant(value, low, high), "m", why)
