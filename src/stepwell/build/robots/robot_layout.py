"""The layout of a whole robot: all parts, fasteners, bands and cords, and where each is."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Vec2
from stepwell.build.build_file import BuildFile, mm
from stepwell.build.part import Part
from stepwell.build.plates import Fastener
from stepwell.build.robots import body as bodies
from stepwell.build.robots.antennas import Cord, antenna_parts
from stepwell.build.robots.legs import LegMaker
from stepwell.build.robots.making import Bought, Maker, PartFrame
from stepwell.build.robots.motion import Motions, Moved, Parameter
from stepwell.build.robots.plan import RobotPlan
from stepwell.mechanism import Cell
from stepwell.robot import Robot


@dataclass(frozen=True, slots=True, eq=False)
class RobotBand(ByValue):
    """A band of a leg between its hooks.

    Attributes:
        leg, cell, number: name of the leg, number of the cell and of the band in it, from 0.
            Cells are counted over all legs.
        bodies: that carry its two hooks, inner first.
        p, q: centres of the hooks [m], in the robot's body frame and the reference pose.
        low, high, width: its z, and the width of its loop in plan [m].
        holes: names of the hooks' holes.
        shift: (0, 0); the hooks are where the anchors are.
    """

    leg: str
    cell: int
    number: int
    bodies: tuple[str, str]
    p: Vec2
    q: Vec2
    low: float
    high: float
    width: float
    holes: tuple[str, str]
    shift: Vec2 = (0.0, 0.0)


@dataclass(frozen=True, eq=False, repr=False)
class RobotLayout(ByValue):
    """The parts of a robot, and their places at any state of its legs and antennas.

    Attributes:
        robot, build_file: what it is made of.
        parts: flat parts, layer by layer from below, then upright ones.
        fasteners: bought parts: pins, hooks, screws, nuts, shims, posts.
        boxes: actuator, rod, battery and board.
        bands, cords: the bands of both legs; from each antenna to its crank.
        places, body, roles: of each part by its name: frame in the reference pose, rigid body,
            kind for its colour.
    """

    robot: Robot
    build_file: BuildFile
    parts: tuple[Part, ...]
    fasteners: tuple[Fastener, ...]
    boxes: tuple[Bought, ...]
    bands: tuple[RobotBand, ...]
    cords: tuple[Cord, ...]
    places: Mapping[str, PartFrame] = field(hash=False)
    body: Mapping[str, str] = field(hash=False)
    roles: Mapping[str, str] = field(hash=False)

    def __repr__(self):
        return (
            f"RobotLayout({len(self.parts)} parts of {mm(self.build_file.sheet.thickness)} mm, "
            f"{len(self.fasteners)} fasteners, {len(self.bands)} bands)"
        )

    @cached_property
    def plan(self) -> RobotPlan:
        """All sizes."""
        return RobotPlan(self.robot, self.build_file)

    @cached_property
    def motions(self) -> Motions:
        """The motion of every body."""
        return Motions(self.plan)

    def cell(self, band: RobotBand) -> Cell:
        """The cell of a band."""
        return self.plan.legs[band.cell // 2].cells[band.cell % 2]

    def part(self, name: str) -> Part:
        """The part of this name; ValueError if there is none."""
        for one in self.parts:
            if one.name == name:
                return one
        raise InputError(f"{name}: no such part. Known: {', '.join(p.name for p in self.parts)}.")

    def pose(
        self, states: Mapping[str, str] | None = None, swings: Mapping[str, float] | None = None
    ) -> dict[Parameter, float]:
        """The parameters of a pose.

        Args:
            states: state of each leg, such as {"left": "10"}; "00" by default.
            swings: of each antenna from rest [rad]; 0 by default.
        """
        values = {name: low for name, (low, _) in self.motions.ranges().items()}
        for leg, state in (states or {}).items():
            for number, digit in enumerate(state):
                if (leg, number) not in values or digit not in "01":
                    raise InputError(f"state {state!r} of leg {leg!r}: must be 00, 10, 01 or 11.")
                values[leg, number] *= -1.0 if digit == "1" else 1.0
        for name, swing in (swings or {}).items():
            if ("antenna", name) not in values:
                raise InputError(f"antenna = {name!r}: this robot has no such antenna.")
            values["antenna", name] = swing
        return values

    def moved(self, body: str, pose: Mapping[Parameter, float]) -> Moved:
        """The motion of one body at a pose."""
        arrays: dict[Parameter, Floats] = {k: np.array([v]) for k, v in pose.items()}
        return self.motions.of(body, arrays)

    def frames_of(self, part: Part, pose: Mapping[Parameter, float]) -> PartFrame:
        """The place of one part at a pose."""
        return carried(self.places[part.name], self.moved(self.body[part.name], pose))

    def frames(self, pose: Mapping[Parameter, float]) -> dict[str, PartFrame]:
        """The place of every part at a pose, see `pose`."""
        moved = {name: self.moved(name, pose) for name in set(self.body.values())}
        return {
            part.name: carried(self.places[part.name], moved[self.body[part.name]])
            for part in self.parts
        }


def carried(place: PartFrame, moved: Moved) -> PartFrame:
    """A place after a motion of its body."""
    (hx, hy), turn = moved.hinge, float(moved.turn[0])
    x, y = turned((place.x - hx, place.y - hy), turn)
    dx, dy = moved.shift[0]
    # The body of an upright part that moves in plan moves along x only.
    return PartFrame(hx + x + float(dx), hy + y + float(dy), place.angle + turn, place.upright)


def turned(point: Vec2, angle: float) -> Vec2:
    """A point turned about the origin by an angle [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    return c * point[0] - s * point[1], s * point[0] + c * point[1]


def robot_layout(robot: Robot, build_file: BuildFile) -> RobotLayout:
    """All parts of a robot of two legs with two cells each.

    Raises:
        ValueError: a robot for which there is no layout.
    """
    make = Maker(RobotPlan(robot, build_file))
    plan = make.plan
    bodies.t_foot(make)
    bodies.body_plate(make)
    legs = [LegMaker(make, plan, leg) for leg in plan.legs]
    bodies.carriage(make, legs)
    cords = []
    for one in legs:
        bodies.body_block(one)
        one.blocks()
    bodies.holder(make)
    for antenna in plan.antennas:
        leg = next(one for one in legs if one.leg.leg.name == antenna.leg.leg.name)
        cords.append(antenna_parts(make, leg, antenna))
    bands = tuple(band for i, one in enumerate(legs) for band in _bands(one, 2 * i))
    return RobotLayout(
        robot,
        build_file,
        tuple(make.drilled()),
        tuple(make.fasteners),
        tuple(make.boxes),
        bands,
        tuple(cords),
        make.places,
        make.bodies,
        make.roles,
    )


def _bands(one: LegMaker, counted: int) -> list[RobotBand]:
    plan, leg, hook = one.plan, one.leg, one.plan.build_file.hook
    antenna = plan.antenna_of(leg)
    first = "body" if antenna is None else f"{antenna.antenna.name}.crank"
    inner, outer = (one.body(f"{one.cell(i)}.block") for i in (0, 1))
    rows = (
        (0, (first, inner), (leg.body, leg.row, -1.0), (leg.inner, leg.middle, 1.0)),
        (1, (inner, outer), (leg.outer, leg.middle, 1.0), (leg.last, leg.outer_row, -1.0)),
    )
    made = []
    for cell, owners, (x, row, way), (to, across, away) in rows:
        for number, band in enumerate(leg.cells[cell].bands):
            p = one.at(x - band.p[1], row - way * band.p[0])
            q = one.at(to - band.q[1], across + away * band.q[0])
            low, high = plan.band_heights(number)
            places = ("p", (band.p[1], -band.p[0])), ("q", (band.q[1], band.q[0]))
            ends = [one.hook_name(cell, k, one.hooks(cell, k).index(at)) for k, at in places]
            made.append(
                RobotBand(
                    leg.leg.name,
                    counted + cell,
                    number,
                    owners,
                    p,
                    q,
                    low,
                    high,
                    hook.diameter + 2.0 * plan.build_file.band.thickness,
                    (ends[0], ends[1]),
                )
            )
    return made
