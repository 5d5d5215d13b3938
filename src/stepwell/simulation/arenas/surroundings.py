"""An arena in a model: slope, patches and loose plates of the ground, walls and cylinders."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from stepwell.base import Vec2
from stepwell.robot import Arena, Patch, Plate, Robot
from stepwell.simulation import parts
from stepwell.simulation.simulator import Settings, mujoco

HEIGHT = 0.10  # of walls [m]: above all parts of the robot that collide with them
DEEP = 0.05  # of the blocks of which a floor with patches consists [m]
FAR = 200.0  # from their middle to the edge of the floor [m]
FILM = 2e-4  # by which a patch that is level with the floor is drawn above it [m]
ARROW = 0.1  # length of the arrow that points uphill [m]
ASIDE = 0.2  # distance of the arrow from the start, to the right [m]

Rectangle = tuple[Vec2, Vec2]  # corners with the smallest and the largest x and y [m]


def obstacle_names(arena: Arena) -> tuple[str, ...]:
    """Names of the obstacles in the model: walls first, numbered from 1."""
    walls = (f"wall {i + 1}" for i in range(len(arena.walls)))
    return (*walls, *(f"cylinder {i + 1}" for i in range(len(arena.cylinders))))


def add_arena(model: Any, arena: Arena, robot: Robot, settings: Settings) -> None:
    """Add the ground and the obstacles of an arena to the model of a robot on a bare floor."""
    if arena.slope is not None:
        _tilt(model, arena, robot)
    if arena.patches:
        _add_patches(model, arena, robot, settings)
    for i, plate in enumerate(arena.plates):
        _add_plate(model, f"plate {i + 1}", plate, arena, settings)
    _add_obstacles(model, arena)


def start_level(arena: Arena, robot: Robot) -> float:
    """Level of the ground [m] below the highest foot or support of a robot at the start."""
    c, s = math.cos(arena.heading), math.sin(arena.heading)
    reach, x0, y0 = robot.foot.radius, *arena.start
    points = [*robot.body.supports, *(leg.at for leg in robot.legs)]
    levels = (arena.ground_level(x0 + c * x - s * y, y0 + s * x + c * y, reach) for x, y in points)
    return max(levels)


def _tilt(model: Any, arena: Arena, robot: Robot) -> None:
    """Tilt gravity, in the frame of the floor, and draw an arrow that points uphill."""
    assert arena.slope is not None
    angle, uphill, g = arena.slope.angle, arena.slope.uphill, robot.floor.gravity
    along = (math.cos(uphill), math.sin(uphill))
    level = -g * math.sin(angle)
    model.option.gravity = (level * along[0], level * along[1], -g * math.cos(angle))
    up = uphill if angle >= 0 else uphill + math.pi
    x, y = arena.start
    side = arena.heading - math.pi / 2
    tail = (x + ASIDE * math.cos(side), y + ASIDE * math.sin(side), 0.0)

    def add_line(start: parts.Vec3, turn: float, length: float) -> parts.Vec3:
        way = up + turn
        end = start[0] + length * math.cos(way), start[1] + length * math.sin(way), 0.0
        parts.rod(model.worldbody, start, end, 0.002, rgba=parts.WALL, **parts.SEEN)
        return end

    tip = add_line(tail, 0.0, ARROW)
    for turn in (2.6, -2.6):
        add_line(tip, turn, 0.3 * ARROW)


def _add_patches(model: Any, arena: Arena, robot: Robot, settings: Settings) -> None:
    """Replace the floor by blocks, one for each patch, with its own level and friction."""
    floor = model.geom("floor")
    floor.contype, floor.conaffinity = 0, 0
    ground = model.worldbody
    for rectangle in remainder([(one.low, one.high) for one in arena.patches]):
        _block(ground, rectangle, 0.0, rgba=parts.HIDDEN, **parts.FLOOR)
    # The contact of a foot, which has priority over that of the floor.
    touch = {"solref": parts.soft(settings), "solimp": parts.TOUCHING, "condim": 3, "priority": 2}
    for patch in arena.patches:
        rectangle = (patch.low, patch.high)
        drawn = max(patch.level, 0.0) + FILM
        _block(ground, rectangle, drawn, rgba=_patch_colour(patch), **parts.SEEN)
        # One block for the feet and one for the supports, since their friction differs.
        feet = robot.floor.foot_friction if patch.foot_friction is None else patch.foot_friction
        drag = robot.floor.drag if patch.drag is None else patch.drag
        glide = replace(robot.floor, drag=drag).support_friction(robot.mass)
        for friction, who in ((feet, parts.UNDER_FEET), (glide, parts.UNDER_SUPPORTS)):
            look = {"rgba": parts.HIDDEN, "friction": (friction, 0.0, 0.0)}
            _block(ground, rectangle, patch.level, **look, **touch, **who)


def _patch_colour(patch: Patch) -> parts.Colour:
    if patch.level < 0:
        return parts.GROOVE
    return parts.STEP if patch.level > 0 else parts.OTHER_FRICTION


def _block(body: Any, rectangle: Rectangle, top: float, **more: Any) -> None:
    """Add a block below a rectangle of the floor, up to this level [m]."""
    (left, right), (low, high) = zip(*rectangle, strict=True)
    size = right - left, high - low, DEEP
    parts.box(body, size, ((left + right) / 2, (low + high) / 2, top - DEEP / 2), **more)


def remainder(rectangles: Sequence[Rectangle]) -> Iterator[Rectangle]:
    """The floor without some rectangles that do not overlap, as rectangles with few seams.

    Corners are those with the smallest and the largest x and y [m], of (n,) rectangles.
    """
    cuts = sorted({-FAR, FAR, *(corner[0] for one in rectangles for corner in one)})
    before: dict[tuple[float, float], float] = {}  # free stretches of y and where they began in x
    for left in cuts:
        taken = sorted((low[1], high[1]) for low, high in rectangles if low[0] <= left < high[0])
        free = set(_gaps(taken)) if left < FAR else set()
        for stretch in sorted(before.keys() - free):
            yield (before.pop(stretch), stretch[0]), (left, stretch[1])
        for stretch in sorted(free - before.keys()):
            before[stretch] = left


def _gaps(taken: Iterable[tuple[float, float]]) -> Iterator[tuple[float, float]]:
    """Stretches between sorted ones that do not overlap, from edge to edge of the floor."""
    edge = -FAR
    for low, high in taken:
        if low > edge:
            yield edge, low
        edge = high
    if edge < FAR:
        yield edge, FAR


def _add_plate(model: Any, name: str, plate: Plate, arena: Arena, settings: Settings) -> None:
    """Add a loose plate as a free body at its place on the ground."""
    (x, y), half = plate.at, plate.thickness / 2
    turn = plate.heading / 2
    # The level below its middle and its corners, without the plate itself.
    below = _level_below(plate, arena)
    body = model.worldbody.add_body(
        name=name, pos=(x, y, below + half), quat=(math.cos(turn), 0.0, 0.0, math.sin(turn))
    )
    body.add_freejoint(name=name)
    size = (*plate.size, plate.thickness)
    touch = {"solref": parts.soft(settings), "solimp": parts.TOUCHING, "condim": 3}
    friction = (plate.friction, 0.0, 0.0)
    own = {"mass": plate.mass, "friction": friction, "priority": 1, "rgba": parts.PLATE}
    parts.box(body, size, **own, **touch, **parts.PLATES)
    parts.box(body, size, mass=0.0, rgba=parts.HIDDEN, **parts.UNDER_ROBOT)


def _level_below(plate: Plate, arena: Arena) -> float:
    c, s = math.cos(plate.heading), math.sin(plate.heading)
    a, b = plate.size[0] / 2, plate.size[1] / 2
    corners = [(0.0, 0.0), (a, b), (a, -b), (-a, b), (-a, -b)]
    bare = replace(arena, plates=())
    return max(
        bare.ground_level(plate.at[0] + c * u - s * v, plate.at[1] + s * u + c * v)
        for u, v in corners
    )


def _add_obstacles(model: Any, arena: Arena) -> None:
    """Add every obstacle as a separate body, so that its contact force is known."""
    names = iter(obstacle_names(arena))

    def add(at: Sequence[float], shape: Any, size: Sequence[float], angle: float = 0.0) -> None:
        body = model.worldbody.add_body(
            name=next(names),
            pos=(*at, HEIGHT / 2),
            quat=(math.cos(angle / 2), 0, 0, math.sin(angle / 2)),
        )
        body.add_geom(type=shape, size=size, rgba=parts.WALL, **parts.OBSTACLE)
        # The touch sensor extends beyond the surface.
        felt = [length + 0.01 if length else 0.0 for length in size]
        body.add_site(name=body.name, type=shape, size=felt, rgba=parts.HIDDEN)

    for wall in arena.walls:
        middle = [(a + b) / 2 for a, b in zip(wall.start, wall.end, strict=True)]
        size = (wall.length / 2, wall.thickness / 2, HEIGHT / 2)
        add(middle, mujoco.mjtGeom.mjGEOM_BOX, size, wall.angle)
    for cylinder in arena.cylinders:
        size = (cylinder.radius, HEIGHT / 2, 0.0)
        add(cylinder.at, mujoco.mjtGeom.mjGEOM_CYLINDER, size)
