"""Behaviour of a robot as a table: contacts of its antennas, and the motion after each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import product
from typing import NamedTuple

from stepwell.base import ByValue, InputError, Vec2, check, to_unit
from stepwell.design import BandType
from stepwell.robot.parts import Antenna
from stepwell.robot.robot import Robot

FREE, BOTH = "free", "both"
# Turn in a cycle of a curve, in closed form [rad]; the simulation may deviate by about 1°.
CURVE = (math.radians(2.5), math.radians(6.0))


class LegGait(NamedTuple):
    """Gait of a leg of two cells: whether its inner cell moves before the outer one."""

    loading: bool
    unloading: bool

    @property
    def states(self) -> str:
        """The states of a cycle, as "00>10>11>01>00"."""
        out, back = ("01", "10")[self.loading], ("10", "01")[self.unloading]
        return f"00>{out}>11>{back}>00"


STEPS, BACKS = LegGait(True, True), LegGait(False, False)
IDLE = (LegGait(True, False), LegGait(False, True))


class Action(StrEnum):
    """Motion of a robot of two legs in a cycle."""

    FORWARD = "forward"
    BACKWARD = "backward"
    TURN_LEFT = "turn left"
    TURN_RIGHT = "turn right"
    VEER_LEFT = "veer left"
    VEER_RIGHT = "veer right"
    CURVE_LEFT = "curve left"
    CURVE_RIGHT = "curve right"
    BACK_LEFT = "back left"
    BACK_RIGHT = "back right"
    STOP = "stop"
    ANY = "any"

    @property
    def gaits(self) -> tuple[tuple[LegGait, LegGait], ...]:
        """Gaits of the left and the right leg, in pairs of which any makes this motion.

        A turn has one leg forward and one backward. While a robot veers, one leg is idle and the
        other steps forward; to go back to the left, the left one steps backward. In a curve both
        step forward, one further than the other: see `curve`.
        """
        still = tuple(product(IDLE, IDLE))
        every = tuple(product((STEPS, BACKS, *IDLE), repeat=2))
        return {
            Action.FORWARD: ((STEPS, STEPS),),
            Action.CURVE_LEFT: ((STEPS, STEPS),),
            Action.CURVE_RIGHT: ((STEPS, STEPS),),
            Action.BACKWARD: ((BACKS, BACKS),),
            Action.TURN_LEFT: ((BACKS, STEPS),),
            Action.TURN_RIGHT: ((STEPS, BACKS),),
            Action.VEER_LEFT: tuple((idle, STEPS) for idle in IDLE),
            Action.VEER_RIGHT: tuple((STEPS, idle) for idle in IDLE),
            Action.BACK_LEFT: tuple((BACKS, idle) for idle in IDLE),
            Action.BACK_RIGHT: tuple((idle, BACKS) for idle in IDLE),
            Action.STOP: still,
            Action.ANY: every,
        }[self]

    @property
    def curve(self) -> int:
        """+1 for a curve to the left, -1 to the right, 0 for any other motion."""
        return (self is Action.CURVE_LEFT) - (self is Action.CURVE_RIGHT)

    @property
    def mirrored(self) -> Action:
        """The same motion in a mirror."""
        sides = {"left": "right", "right": "left"}
        return Action(" ".join(sides.get(word, word) for word in self.value.split()))


@dataclass(frozen=True, slots=True, eq=False)
class BehaviourRow(ByValue):
    """A row of the table: the contact, and the motion of the robot during it.

    Args:
        contact: "free" for no contact, the name of an antenna, or "both".
        motion: an `Action`, such as "turn right"; "any" leaves the row open.
    """

    contact: str
    motion: Action

    def __post_init__(self):
        check.fields(self, check.one_of, motion=Action)

    def __repr__(self):
        return f"BehaviourRow({self.contact}: {self.motion})"


@dataclass(frozen=True, slots=True, eq=False)
class RobotChoice(ByValue):
    """Numbers among which a compiler chooses; a `ValueError` refuses values out of range.

    Args:
        pitch: of the holes for the anchors q [m], > 0.
        left, right, bottom, top: edges of the field of holes for q [m].
        bands: types of band; each design has one type. Empty for the robot's own, on its outer
            cell.
        inner_bands, outer_bands: numbers of equal bands on the inner and the outer cell.
        below: preload depths of the feet [m], >= 0.
        moves: lengths of the antennas' displacements of an inner anchor p [m], > 0.
        directions: number of directions of these displacements, evenly spaced from +x.
    """

    pitch: float = 0.005
    left: float = 0.0
    right: float = 0.020
    bottom: float = -0.015
    top: float = 0.015
    bands: Sequence[BandType] = ()
    inner_bands: Sequence[int] = (1, 2)
    outer_bands: Sequence[int] = (1, 2)
    below: Sequence[float] = (0.0007, 0.0008, 0.0009, 0.0010)
    moves: Sequence[float] = (0.002, 0.003, 0.004)
    directions: int = 8

    def __post_init__(self):
        check.fields(self, check.positive, pitch="m")
        check.fields(self, check.finite, left="m", right="m", bottom="m", top="m")
        object.__setattr__(self, "bands", tuple(self.bands))
        for name, least in (("inner_bands", 1), ("outer_bands", 1), ("below", 0), ("moves", 0)):
            values = tuple(getattr(self, name))
            object.__setattr__(self, name, values)
            if not values or not all(least <= one < math.inf for one in values):
                raise InputError(f"{name} = {values}: must be one number or more, >= {least}.")
        if not all(self.moves):
            raise InputError("moves: 0 mm moves no anchor; give lengths > 0.")
        if not (isinstance(self.directions, int) and 1 <= self.directions <= 360):
            raise InputError(f"directions = {self.directions}: must be from 1 to 360.")
        if not (self.left <= self.right and self.bottom <= self.top):
            raise InputError(
                f"x from {to_unit(self.left, 'mm'):g} to {to_unit(self.right, 'mm'):g} mm, y from "
                f"{to_unit(self.bottom, 'mm'):g} to {to_unit(self.top, 'mm'):g} mm: must rise."
            )

    @property
    def holes(self) -> tuple[Vec2, ...]:
        """Holes for an anchor q [m], column by column."""
        x, y = (
            [low + i * self.pitch for i in range(math.floor((high - low) / self.pitch + 1e-6) + 1)]
            for low, high in ((self.left, self.right), (self.bottom, self.top))
        )
        return tuple((round(a, 12), round(b, 12)) for a, b in product(x, y))

    @property
    def displacements(self) -> tuple[Vec2, ...]:
        """Displacements of an inner anchor p [m], by length and then by direction."""
        angles = [math.tau * i / self.directions for i in range(self.directions)]
        return tuple(
            (round(length * math.cos(a), 12), round(length * math.sin(a), 12))
            for length, a in product(self.moves, angles)
        )

    @property
    def designs(self) -> int:
        """Number of designs with two equal legs."""
        bands = len(self.inner_bands) * len(self.outer_bands) * max(len(self.bands), 1)
        return len(self.holes) ** 2 * len(self.displacements) * len(self.below) * bands

    @property
    def leg_designs(self) -> int:
        """Number of designs of a leg with one type of band, depth and displacement."""
        return len(self.holes) ** 2 * len(self.inner_bands) * len(self.outer_bands)

    @property
    def pairs(self) -> int:
        """Number of designs with a left and a right leg that may differ."""
        shared = len(self.displacements) * len(self.below) * max(len(self.bands), 1)
        return self.leg_designs**2 * shared


@dataclass(frozen=True, slots=True, eq=False)
class RobotBehaviour(ByValue):
    """A behaviour that a robot shall have, as a table of all contacts of its antennas.

    Args:
        rows: one for each contact: "free", each antenna, and "both" with two antennas.
        robot: of two legs with two cells each, on the left and on the right, and one or two
            antennas. Its bodies, bands, rest anchors p and gearing are kept.
        choice: numbers among which the compiler chooses.
        title: name in reports.

    Raises:
        ValueError: a row is missing or given twice, a contact without an antenna, or another kind
            of robot; with a line for every problem.
    """

    rows: Sequence[BehaviourRow]
    robot: Robot
    choice: RobotChoice = RobotChoice()
    title: str = field(default="", compare=False)

    def __post_init__(self):
        object.__setattr__(self, "rows", tuple(self.rows))
        if problems := [*_unfit(self.robot), *self._problems()]:
            raise InputError("\n".join(problems))
        order = self.contacts
        object.__setattr__(
            self, "rows", tuple(sorted(self.rows, key=lambda row: order.index(row.contact)))
        )

    @property
    def antennas(self) -> tuple[Antenna, ...]:
        """The antennas of the robot, from the left."""
        return tuple(sorted(self.robot.antennas, key=lambda one: -one.side))

    @property
    def contacts(self) -> tuple[str, ...]:
        """All contacts of the robot: free, each antenna from the left, and both."""
        names = tuple(one.name for one in self.antennas)
        return (FREE, *names, *([BOTH] if len(names) > 1 else []))

    def touched(self, contact: str) -> tuple[str, ...]:
        """Names of the antennas that a contact presses."""
        names = tuple(name for name in self.contacts if name not in (FREE, BOTH))
        return {FREE: (), BOTH: names}.get(contact, (contact,))

    @property
    def is_mirrored(self) -> bool:
        """Whether the table is its own mirror image, so that two equal legs can have it."""
        antennas = [one for one in self.contacts if one not in (FREE, BOTH)]
        if len(antennas) < 2:
            return False
        motions = {row.contact: row.motion for row in self.rows}
        other = dict(zip(antennas, reversed(antennas), strict=True))
        return all(
            motions[other.get(contact, contact)] is motion.mirrored
            for contact, motion in motions.items()
        )

    def _problems(self) -> list[str]:
        given, known = [row.contact for row in self.rows], self.contacts
        allowed = ", ".join(map(repr, known))
        problems = [
            f"contact = {contact!r}: this robot has no such antenna: must be one of {allowed}."
            for contact in dict.fromkeys(given)
            if contact not in known
        ]
        problems += [
            f"contact = {contact!r} has {given.count(contact)} rows: keep one of them."
            for contact in known
            if given.count(contact) > 1
        ]
        problems += [
            f"contact = {contact!r} has no row: add one; motion = 'any' leaves it open."
            for contact in known
            if contact not in given
        ]
        if not problems and all(row.motion is Action.ANY for row in self.rows):
            problems = ["rows: all of them are 'any', which every robot meets: name a motion."]
        return problems

    def __repr__(self):
        table = ", ".join(f"{row.contact}: {row.motion}" for row in self.rows)
        return f"RobotBehaviour({table})"


def _unfit(robot: Robot) -> list[str]:
    """Reasons why the closed form does not describe a robot."""
    sides = sorted(leg.side for leg in robot.legs)
    cells = [cell for leg in robot.legs for cell in leg.chain.levers]
    alike = {(cell.lever, cell.limit) for cell in cells}
    problems: list[str] = []
    if sides != [-1, 1]:
        problems.append(
            f"robot: {len(sides)} legs: must have one on the left and one on the right."
        )
    if any(len(leg.chain) != 2 for leg in robot.legs):
        problems.append("robot: its legs must have two cells each, inner and outer.")
    if len(alike) > 1:
        problems.append("robot: its cells must have equal levers and limits.")
    if any(len(cell.bands) > 1 or cell.load is not None for cell in cells):
        problems.append("robot: its cells must have one kind of band each, and no load.")
    if not 1 <= len(robot.antennas) <= 2:
        problems.append(
            f"robot: {len(robot.antennas)} antennas: must have one or two; add [[antenna]]."
        )
    return problems
