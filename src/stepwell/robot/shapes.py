"""Solid parts of a robot that can be cut: shapes, and masses of its rigid bodies.

Every vector is in the frame of the robot's body (origin at the height of the legs' pivots, x
forward, y to the left, z up), in the reference pose: the stroke is 0, every cell is in state 0, and
the antennas are at rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from stepwell.base import ByValue, Floats, InputError, Ints, ReadOnly, check, to_unit

if TYPE_CHECKING:
    from stepwell.robot.robot import Robot

Vec3 = tuple[float, float, float]

BODY, CARRIAGE = "body", "carriage"
# Source of numbers that parts give, in the list of a robot's sources.
FROM_PARTS = "from the parts"
# Relative error of a body's mass, and error of the inertia over its largest entry, from rounding.
SAME = 1e-6


class PartRole(StrEnum):
    """Kind of a part, which decides its colour."""

    BODY = "body"
    CARRIAGE = "carriage"
    MIDDLE_BLOCK = "middle block"
    OUTER_BLOCK = "outer block"
    LEVER = "lever"
    LINK = "link"
    FOOT = "foot"
    ANTENNA = "antenna"
    CRANK = "crank"
    PIN = "pin"
    ACTUATOR = "actuator"
    BATTERY = "battery"
    SUPPORT = "support"


@dataclass(frozen=True, slots=True, eq=False)
class Shape(ByValue):
    """One solid part; a `ValueError` refuses a shape without faces or with wrong indices.

    Args:
        body: name of its rigid body, see `body_names`.
        part: name of the part, as in the list of parts.
        vertices: (n, 3) [m], in the frame and the pose of this module.
        faces: (m, 3) indices of vertices, counter-clockwise seen from outside.
        colour: kind of the part, which decides its colour.
        collides: True for a convex shape that collides with obstacles and moving parts. Such a
            shape is not drawn; give a second one to draw the part.
    """

    body: str
    part: str
    vertices: Floats
    faces: Ints
    colour: PartRole
    collides: bool = False

    def __post_init__(self):
        check.fields(self, check.one_of, colour=PartRole)
        vertices = _array(f"vertices of {self.part!r}", self.vertices, (None, 3), "m")
        given = np.asarray(self.faces)
        if given.ndim != 2 or given.shape[1:] != (3,) or given.dtype.kind not in "iu":
            raise InputError(
                f"faces of {self.part!r} has shape {given.shape} of {given.dtype}: must be (m, 3) "
                f"whole numbers."
            )
        faces = given.astype(np.int64)
        if len(vertices) < 4 or len(faces) < 4:
            raise InputError(
                f"part {self.part!r} has {len(vertices)} vertices and {len(faces)} faces: a solid "
                f"has 4 or more of both."
            )
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise InputError(
                f"faces of {self.part!r} has indices {faces.min()} to {faces.max()}: must be from "
                f"0 to {len(vertices) - 1}."
            )
        faces.setflags(write=False)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces)


@dataclass(frozen=True, slots=True, eq=False)
class BodyMass(ByValue):
    """Mass of one rigid body; a `ValueError` refuses an inertia that no solid has.

    Args:
        body: its name, see `body_names`.
        mass: of all its parts [kg], > 0.
        centre: (3,) centre of mass [m], in the frame and the pose of this module.
        inertia: (3, 3) about the centre [kg m²], symmetric, along the axes of that frame.
    """

    body: str
    mass: float
    centre: Floats
    inertia: Floats

    def __post_init__(self):
        check.fields(self, check.positive, mass="kg")
        centre = _array(f"centre of {self.body!r}", self.centre, (3,), "m")
        inertia = _array(f"inertia of {self.body!r}", self.inertia, (3, 3), "kg m²")
        largest = float(np.abs(inertia).max())
        principal = np.linalg.eigvalsh(inertia)
        symmetric = bool(np.all(np.abs(inertia - inertia.T) <= SAME * largest))
        # Of a solid, the two smaller principal moments exceed the largest.
        solid = principal[0] > 0 and principal[0] + principal[1] >= (1 - SAME) * principal[2]
        if not (symmetric and solid):
            least, middle, most = (to_unit(value, "g") * 1e6 for value in principal)
            raise InputError(
                f"inertia of {self.body!r}: must be symmetric, with principal moments > 0 of which "
                f"two exceed the third; they are {least:.4g}, {middle:.4g} and {most:.4g} g mm²."
            )
        object.__setattr__(self, "centre", centre)
        object.__setattr__(self, "inertia", inertia)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class RobotParts(ByValue):
    """All parts of a robot that can be cut; a `ValueError` refuses parts of unknown bodies.

    Args:
        shapes: parts to draw, and convex shapes that collide.
        masses: one for every rigid body.
        material: of the sheet, as "acrylic-3mm".
        hinges: a point (3,) [m] on the vertical axis of each lever and crank, by the body's name.
            A lever turns there on the block nearer to the body, a crank on the body.
        cords: the two ends of each cord from an antenna to its crank, by the antenna's name: a body
            and a point (3,) [m] of it.
    """

    shapes: Sequence[Shape]
    masses: Sequence[BodyMass]
    material: str
    hinges: Mapping[str, Vec3]
    cords: Mapping[str, tuple[tuple[str, Vec3], tuple[str, Vec3]]] = field(default_factory=dict)

    def __post_init__(self):
        object.__setattr__(self, "cords", ReadOnly(self.cords))
        object.__setattr__(self, "shapes", tuple(self.shapes))
        object.__setattr__(self, "masses", tuple(self.masses))
        names = [one.body for one in self.masses]
        for name in sorted({name for name in names if names.count(name) > 1}):
            raise InputError(f"masses: body {name!r} is given twice; give it one mass.")
        hinges = {
            name: tuple(map(float, _array(f"hinge of {name!r}", at, (3,), "m")))
            for name, at in self.hinges.items()
        }
        object.__setattr__(self, "hinges", ReadOnly(hinges))
        for what, given in (
            ("shapes", [shape.body for shape in self.shapes]),
            ("hinges", [*hinges]),
            ("cords", [body for ends in self.cords.values() for body, _ in ends]),
        ):
            unknown = sorted(set(given) - set(names))
            if unknown:
                raise InputError(
                    f"{what}: body {unknown[0]!r} has no mass; the bodies with a mass are "
                    f"{', '.join(map(repr, names))}."
                )

    @property
    def mass(self) -> float:
        """Total mass [kg]."""
        return sum(one.mass for one in self.masses)

    @property
    def centre(self) -> Floats:
        """(3,) centre of mass of all parts [m] in the reference pose."""
        return sum((one.mass * one.centre for one in self.masses), np.zeros(3)) / self.mass

    def of(self, body: str) -> BodyMass:
        """Mass of the body of that name; or a `ValueError`."""
        for one in self.masses:
            if one.body == body:
                return one
        raise InputError(
            f"body = {body!r}: must be one of {', '.join(repr(one.body) for one in self.masses)}."
        )

    def __repr__(self):
        return (
            f"RobotParts({len(self.shapes)} shapes of {len(self.masses)} bodies, {self.material}, "
            f"{to_unit(self.mass, 'g'):.0f} g)"
        )


class Inertial(NamedTuple):
    """A solid's mass [kg], centre (3,) [m] and inertia (3, 3) about it [kg m²]."""

    mass: float
    centre: Floats
    inertia: Floats


def joined_solids(solids: Sequence[Inertial | BodyMass]) -> Inertial:
    """Several solids as one."""
    mass = float(sum(one.mass for one in solids))
    centre = sum((one.mass * one.centre for one in solids), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for one in solids:
        off = one.centre - centre
        inertia += one.inertia + one.mass * (off @ off * np.eye(3) - np.outer(off, off))
    return Inertial(mass, centre, inertia)


def body_names(robot: Robot) -> tuple[str, ...]:
    """Names of the rigid bodies of a robot whose legs have two cells, in a fixed order.

    They are "body"; "carriage"; for each leg "{leg}.{cell}.block" (the block that the cell moves),
    "{leg}.{cell}.lever 1" and "{leg}.{cell}.lever 2" for each cell, "{leg}.slider" (the middle
    slider with the V's front pivot, which moves in x only), "{leg}.link front", "{leg}.link rear"
    and "{leg}.foot"; for each antenna "{antenna}.antenna" and "{antenna}.crank".
    """
    return tuple(_body_names(robot))


def _body_names(robot: Robot) -> Iterator[str]:
    yield from (BODY, CARRIAGE)
    for leg in robot.legs:
        for cell in leg.chain.names:
            yield from (f"{leg.name}.{cell}.{part}" for part in ("block", "lever 1", "lever 2"))
        yield from (f"{leg.name}.{part}" for part in ("slider", "link front", "link rear", "foot"))
    for antenna in robot.antennas:
        yield from (f"{antenna.name}.antenna", f"{antenna.name}.crank")


def with_parts(robot: Robot, parts: RobotParts) -> Robot:
    """The same robot made of these parts, which give its masses and its centre of mass.

    A lever or a link counts half for each of the two bodies it joins, the slider for the middle
    block, and a crank for the body. Where two legs differ, `blocks` and `foot` have the mean. The
    body's centre is the one with which statics, which puts every block at its pivot, has the centre
    of mass of all parts; its height is that of the body's own parts.

    Raises:
        ValueError: bodies are missing, or the robot with these masses cannot walk.
    """
    from stepwell.robot.stance import balanced_centre

    missing = [name for name in body_names(robot) if all(name != one.body for one in parts.masses)]
    if missing:
        raise InputError(
            f"parts: body {missing[0]!r} has no mass; give one for each of body_names(robot)."
        )

    def mass(*names: str) -> float:
        return sum(parts.of(name).mass for name in names)

    legs, count = [leg.name for leg in robot.legs], len(robot.legs)
    names = {leg.name: leg.chain.names for leg in robot.legs}

    def blocks(cell: int) -> float:
        return sum(mass(f"{leg}.{names[leg][cell]}.block") for leg in legs)

    def half_levers(cell: int) -> float:
        ends = (1, 2)
        each = (mass(*(f"{leg}.{names[leg][cell]}.lever {k}" for k in ends)) for leg in legs)
        return sum(each) / 2

    def half_links(end: str) -> float:
        return sum(mass(f"{leg}.link {end}") for leg in legs) / 2

    inner, outer = half_levers(0), half_levers(1)
    front, rear = half_links("front"), half_links("rear")
    middle = blocks(0) + inner + outer + front + sum(mass(f"{leg}.slider") for leg in legs)
    feet = sum(mass(f"{leg}.foot") for leg in legs) + front + rear
    cranks = mass(*(f"{antenna.name}.crank" for antenna in robot.antennas))
    made = replace(
        robot,
        made=None,
        body=replace(robot.body, mass=mass(BODY) + inner + cranks),
        blocks=replace(
            robot.blocks,
            mass=middle / count,
            outer=(blocks(1) + outer) / count,
            carriage=mass(CARRIAGE) + rear,
        ),
        foot=replace(robot.foot, mass=feet / count),
        antennas=[
            replace(antenna, mass=mass(f"{antenna.name}.antenna")) for antenna in robot.antennas
        ],
    )
    x, y = balanced_centre(made, parts.centre[:2])
    centre = (float(x), float(y), float(parts.of(BODY).centre[2]))
    given = ["body.mass_g", "body.centre_mm", "blocks.mass_g", "blocks.outer_g"]
    given += ["blocks.carriage_g", "foot.mass_g", *["antenna.*.mass_g"] * bool(robot.antennas)]
    labels = {**robot.sources, **dict.fromkeys(given, FROM_PARTS)}
    return replace(made, body=replace(made.body, centre=centre), made=parts, sources=labels)


def part_problems(robot: Robot) -> Iterator[str]:
    """Every reason why the parts of a robot are not those of its numbers, one line each."""
    made = robot.made
    if made is None:
        return
    for leg in robot.legs:
        if len(leg.chain) != 2:
            yield (
                f"made: leg {leg.name!r} has {len(leg.chain)} cells: parts are for legs of two "
                f"cells; leave the parts out."
            )
            return
    needed, given = body_names(robot), [one.body for one in made.masses]
    if missing := [name for name in needed if name not in given]:
        yield f"made: body {missing[0]!r} has no mass; give one for each of body_names(robot)."
        return
    yield from _wrong_bodies(made, needed)
    if abs(made.mass - robot.mass) > SAME * robot.mass:
        yield (
            f"made: the parts weigh {to_unit(made.mass, 'g'):.4f} g and the robot's numbers give "
            f"{to_unit(robot.mass, 'g'):.4f} g; build the robot again, or remove the parts."
        )


def _wrong_bodies(made: RobotParts, needed: Sequence[str]) -> Iterator[str]:
    """A body that the robot lacks, and a turning one without a hinge."""
    if extra := [one.body for one in made.masses if one.body not in needed]:
        yield f"made: body {extra[0]!r} is not of this robot; remove it, or build the robot again."
    turning = [name for name in needed if ".lever " in name or name.endswith(".crank")]
    if unhinged := [name for name in turning if name not in made.hinges]:
        yield f"made: {unhinged[0]!r} has no hinge; give a point on its axis in hinges."


def _array(name: str, value: ArrayLike, shape: tuple[int | None, ...], unit: str) -> Floats:
    """A read-only copy of finite numbers of this shape, None for any length."""
    try:
        array = np.array(value, float)
    except (TypeError, ValueError):
        raise InputError(f"{name}: must be numbers [{unit}].") from None
    fits = array.ndim == len(shape) and all(
        want in (None, own) for own, want in zip(array.shape, shape, strict=True)
    )
    if not fits:
        wanted = str(tuple("n" if n is None else n for n in shape)).replace("'", "")
        raise InputError(f"{name} has shape {array.shape}: must be {wanted} [{unit}].")
    if not np.isfinite(array).all():
        raise InputError(f"{name}: must be finite [{unit}].")
    array.setflags(write=False)
    return array
