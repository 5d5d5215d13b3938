"""Sizes of a robot's parts in plan and in height, from its numbers and a build file."""

import math
import re
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from stepwell.base import InputError, Vec2
from stepwell.build.build_file import BuildFile, mm
from stepwell.build.stack import SCREW_LENGTHS
from stepwell.mechanism import Cell
from stepwell.robot import Antenna, Leg, Robot

# Gap between two parts of one body that turn about each other, as between links and tabs [m].
GAP = 0.3e-3
# Clearance of the links under the flanges [m].
UNDER = 0.5e-3
# Around an opening at which a part is loaded, such as the ends of a rail [m].
EDGE = 10e-3
# From a loaded opening to the end of a sliding plate [m].
WEB = 4e-3


class Heights(NamedTuple):
    """z of the lower faces of the flat layers [m], from the floor upwards; 0 at the V's pivots."""

    floor: float
    foot: float  # of the T-foot's plate
    flange: float
    rail: float  # of the body plate, whose slots are the rails
    slide: float  # of the carriage and the tops of the sliders
    bottom: float  # of the blocks
    middle: float  # of levers and spacers
    top: float
    roof: float  # upper face of the blocks
    crank: float
    bands: float
    under: float  # of the antenna under the nose
    above: float  # of the antenna above it


@dataclass(frozen=True)
class LegPlan:
    """Places of one leg in plan [m], in the robot's body frame with all cells in state 0.

    Attributes:
        leg: its name, cells and foot.
        side: 1 for the left leg, -1 for the right one; `across` times `side` is y.
        front, rear: x of the V's pivots.
        row: y of the V's plane and of the joints of the body's block, as a distance from the
            midline.
        body, inner, outer, last: x of the joint pairs of the body's block, of the middle block
            (its two pairs) and of the outer block.
        label: its name in names of parts, which name files.
    """

    leg: Leg
    side: float
    front: float
    rear: float
    row: float
    body: float
    inner: float
    outer: float
    last: float
    label: str

    @property
    def cells(self) -> tuple[Cell, Cell]:
        """The cell that makes the step, and the one that lifts the foot."""
        first, second = self.leg.chain.levers
        return first, second

    @property
    def middle(self) -> float:
        """Distance of the middle block's joints from the midline in state 00 [m]."""
        return self.row + near(self.cells[0])

    @property
    def outer_row(self) -> float:
        """Distance of the outer block's joints from the midline in state 00 [m]."""
        return self.middle - near(self.cells[1])


def label_of(name: str, kind: str, number: int) -> str:
    """The name of a leg or an antenna if it can name files, else its kind and number."""
    return name if re.fullmatch(r"\w[\w+]*", name, re.ASCII) else f"{kind}{number + 1}"


def near(cell: Cell) -> float:
    """Distance of the two joint lines of a cell at its stops [m]."""
    return cell.lever * math.cos(cell.limit)


def mean_reach(cell: Cell) -> float:
    """Middle of the distances of the two joint lines of a cell [m]."""
    return (near(cell) + cell.lever) / 2.0


def swing(cell: Cell) -> float:
    """Range of the distance of the two joint lines of a cell [m]."""
    return cell.lever - near(cell)


@dataclass(frozen=True)
class RobotPlan:
    """All sizes of a robot's parts [m].

    Args:
        robot: two legs of two cells each.
        build_file: material, pins, rails, actuator.

    Raises:
        ValueError: a robot for which there is no layout; the text names the part and the number.
    """

    robot: Robot
    build_file: BuildFile

    def __post_init__(self):
        _refuse(self.robot)

    @cached_property
    def thick(self) -> float:
        """Thickness of the sheet [m]."""
        return self.build_file.sheet.thickness

    @cached_property
    def heights(self) -> Heights:
        """Heights of all layers."""
        own, step = self.build_file.robot, self.thick + self.build_file.lever.shim
        rail = own.link_width / 2.0 + UNDER + step
        slide = rail + step
        bottom = slide + step
        top = bottom + 2.0 * step
        roof = top + self.thick
        crank = roof + self.build_file.lever.shim
        floor = -(self.robot.pivot_height + own.foot_radius)
        high = max(rail + self.clamp_length(rail, roof), crank + self.thick)
        return Heights(
            floor=floor,
            foot=rail - own.standoff - self.thick,
            flange=rail - step,
            rail=rail,
            slide=slide,
            bottom=bottom,
            middle=bottom + step,
            top=top,
            roof=roof,
            crank=crank,
            bands=high + self.build_file.hook.clearance,
            under=rail - step - self.thick,
            above=slide + self.thick,
        )

    def band_heights(self, number: int) -> tuple[float, float]:
        """z of the lower and the upper face of the bands with this number in their cells [m]."""
        own = self.build_file.band
        low = self.heights.bands + number * (own.width + own.gap)
        return low, low + own.width

    @cached_property
    def hook_top(self) -> float:
        """z of the upper end of all hooks, above their caps [m]."""
        most = max(len(cell.bands) for leg in self.legs for cell in leg.cells)
        return self.band_heights(most - 1)[1] + self.build_file.hook.cap

    def clamp_length(self, low: float, roof: float) -> float:
        """Length of the screws that hold the body's blocks on the body plate [m]."""
        least = roof - low + self.build_file.screw.nut
        return next((1e-3 * one for one in SCREW_LENGTHS if 1e-3 * one >= least - 1e-9), least)

    @cached_property
    def half(self) -> float:
        """From the midpoint of a pair of joints to the end of its block [m]."""
        return self.build_file.lever.spacing / 2.0 + self.build_file.block.edge

    @cached_property
    def back(self) -> float:
        """From the joints of a block to its edge away from the other block [m]."""
        return self.spacer + self.build_file.pin.diameter + 2.0 * self.build_file.sheet.bridge

    @cached_property
    def spacer(self) -> float:
        """From the joints of a block to its spacer, which levers never reach [m]."""
        return self.build_file.lever.width / 2.0 + self.build_file.lever.clearance

    @cached_property
    def pin_row(self) -> float:
        """From the joints of a block to the pins that hold its plates together [m]."""
        return self.spacer + self.build_file.sheet.bridge + self.build_file.pin.diameter / 2.0

    @cached_property
    def legs(self) -> tuple[LegPlan, ...]:
        """The places of every leg."""
        return tuple(self._leg(leg) for leg in self.robot.legs)

    def _leg(self, leg: Leg) -> LegPlan:
        first, second = leg.chain.levers
        x, y = leg.at
        half_span = self.robot.foot.span / 2.0
        front, rear = x + half_span, x - half_span
        room = self.tab / 2.0 + self.build_file.robot.gap + self.half
        body = front + room
        outer = front - room - second.full_travel / 2.0
        return LegPlan(
            leg=leg,
            side=math.copysign(1.0, y),
            front=front,
            rear=rear,
            row=abs(y),
            body=body,
            inner=body + first.full_travel / 2.0,
            outer=outer,
            last=outer + second.full_travel / 2.0,
            label=label_of(leg.name, "leg", self.robot.legs.index(leg)),
        )

    @cached_property
    def tab(self) -> float:
        """Width of the tab of a middle block with the pin in the slider's slot [m]."""
        return self.build_file.pin.diameter + 2.0 * self.build_file.block.edge / 2.0

    @cached_property
    def core(self) -> float:
        """Half the length of a slider in its rail [m]."""
        return self.build_file.robot.guide / 2.0

    @cached_property
    def slot(self) -> float:
        """Width of a transverse slot [m]."""
        return self.build_file.pin.diameter + 2.0 * self.build_file.robot.slot_fit

    @cached_property
    def lead(self) -> float:
        """From the carriage's pivot to the front end of its top [m]."""
        ahead = max(leg.last - leg.rear for leg in self.legs)
        return ahead + self.slot / 2.0 + WEB

    @property
    def stroke(self) -> float:
        """The full stroke of the actuator [m]."""
        return self.robot.legs[0].chain.full_stroke

    @cached_property
    def bar(self) -> tuple[float, float]:
        """x of the rear and of the front edge of the carriage bar, stroke 0 [m]."""
        rear = self.legs[0].rear - self.core - self.build_file.robot.gap - 0.5e-3
        return rear, rear + 12e-3

    @cached_property
    def bar_middle(self) -> float:
        """x of the hole for the actuator's rod at stroke 0 [m]."""
        return sum(self.bar) / 2.0

    @cached_property
    def fixed_hole(self) -> float:
        """x of the hole that holds the actuator's body [m].

        The rod has the same room at both ends of the stroke.
        """
        own = self.build_file.linear_actuator
        return self.bar_middle + own.closed + (own.travel - self.stroke) / 2.0

    @cached_property
    def rail_ends(self) -> tuple[float, float]:
        """x of the two ends of the rails [m]."""
        reach = self.core + self.build_file.robot.gap
        return (
            min(leg.rear for leg in self.legs) - self.stroke - reach,
            max(leg.front for leg in self.legs) + reach,
        )

    @cached_property
    def plate(self) -> tuple[float, float, float]:
        """x of the rear and front edge of the body plate without its nose, and half its width."""
        front = max(leg.body for leg in self.legs) + self.half + self.build_file.block.edge + 5e-3
        row = max(leg.row for leg in self.legs)
        half = row + self.build_file.robot.rail / 2.0 + 8e-3
        return self.rail_ends[0] - EDGE, front, half

    @cached_property
    def nose(self) -> tuple[float, float]:
        """x of the front edge of the nose and half its width [m]."""
        own = self.build_file.block.edge
        reach, half = self.fixed_hole + 2.0 * own, 18e-3
        for antenna in self.robot.antennas:
            reach = max(reach, antenna.pivot[0] + own)
            half = max(half, abs(antenna.pivot[1]) + 8e-3)
        return reach, half

    @cached_property
    def antennas(self) -> "tuple[AntennaPlan, ...]":
        """The places of every antenna; the first lies under the nose, the second above it."""
        return tuple(
            AntennaPlan(self, antenna, index) for index, antenna in enumerate(self.robot.antennas)
        )

    def antenna_of(self, leg: LegPlan) -> "AntennaPlan | None":
        """The antenna whose crank carries the anchor of a leg's inner cell."""
        return next((one for one in self.antennas if one.leg.leg.name == leg.leg.name), None)


@dataclass(frozen=True)
class AntennaPlan:
    """An antenna with its hub, the cord, and the crank that displaces the anchor [m, rad]."""

    plan: RobotPlan
    antenna: Antenna
    index: int

    @property
    def label(self) -> str:
        """Its name in names of parts, which name files."""
        return label_of(self.antenna.name, "antenna", self.index)

    @property
    def leg(self) -> LegPlan:
        """The leg whose anchor it displaces."""
        return next(one for one in self.plan.legs if one.leg.name == self.antenna.leg)

    @property
    def under(self) -> bool:
        """Whether it lies under the nose."""
        return self.index % 2 == 0

    @property
    def base(self) -> float:
        """z of its lower face [m]."""
        return self.plan.heights.under if self.under else self.plan.heights.above

    @property
    def move(self) -> float:
        """Displacement of the anchor, away from the leg's row towards the midline [m]."""
        return -self.antenna.moves[0]

    @property
    def anchor(self) -> Vec2:
        """The anchor at rest: x, and the distance from the leg's row towards the midline [m]."""
        px, py = self.leg.cells[0].bands[0].p
        return self.leg.body - py, -px

    @property
    def turn(self) -> float:
        """Rotation of the crank from stop to stop [rad]."""
        return 2.0 * math.asin(self.move / (2.0 * self.plan.build_file.robot.crank_arm))

    @property
    def pivot(self) -> Vec2:
        """The crank's pivot: x, and the distance from the leg's row towards the midline [m]."""
        x, inboard = self.anchor
        ahead = math.sqrt(self.plan.build_file.robot.crank_arm**2 - (self.move / 2.0) ** 2)
        return x + ahead, inboard + self.move / 2.0

    @property
    def cord_arm(self) -> float:
        """Arm of the cord on the crank [m]: the full swing of the rod is the full displacement."""
        hub = self.plan.build_file.robot.cord_arm
        return hub * math.sin(self.antenna.swing / 2.0) / math.sin(self.turn / 2.0)

    @property
    def aligned(self) -> float:
        """Distance of the hub from the midline at which the cord runs along the body [m]."""
        row = self.leg.row - self.pivot[1] - self.cord_arm * math.cos(self.turn / 2.0)
        hub = self.plan.build_file.robot.cord_arm * math.cos(self.antenna.swing / 2.0)
        return row - hub

    def crank_turn(self, swing: float) -> float:
        """Rotation of the crank from rest [rad] at a swing of the rod [rad]; the cord is long."""
        ratio = self.plan.build_file.robot.cord_arm / self.cord_arm
        half = self.antenna.swing / 2.0
        sine = ratio * math.sin(min(max(swing, 0.0), 2.0 * half) - half)
        return self.turn / 2.0 + math.asin(min(max(sine, -1.0), 1.0))


def _refuse(robot: Robot) -> None:
    """A `ValueError` for a robot without a layout."""
    sides = sorted(leg.side for leg in robot.legs)
    if sides != [-1, 1]:
        raise InputError(
            f"legs: {len(robot.legs)} with sides {sides}: parts are made for one leg on either "
            f"side of the body; give two legs."
        )
    for leg in robot.legs:
        if len(leg.chain) != 2:
            raise InputError(
                f"leg {leg.name!r} has {len(leg.chain)} cells: parts are made for legs of two "
                f"cells; remove {len(leg.chain) - 2}."
            )
    left, right = robot.legs
    rears = [leg.at[0] for leg in robot.legs]
    if abs(rears[0] - rears[1]) > 1e-9 or abs(abs(left.at[1]) - abs(right.at[1])) > 1e-9:
        raise InputError(
            f"leg.at: ({mm(left.at[0])}, {mm(left.at[1])}) and ({mm(right.at[0])}, "
            f"{mm(right.at[1])}) mm: parts are made for legs at mirrored places; use the same x "
            f"and opposite y."
        )
    if len(robot.antennas) > 2:
        raise InputError(
            f"antennas: {len(robot.antennas)}: there are two layers for antennas, under and above "
            f"the nose; remove {len(robot.antennas) - 2}."
        )
    for antenna in robot.antennas:
        _refuse_antenna(robot, antenna)
    driven = [antenna.leg for antenna in robot.antennas]
    if len(set(driven)) < len(driven):
        raise InputError(f"antennas: two of them displace an anchor of leg {driven[0]!r}.")


def _refuse_antenna(robot: Robot, antenna: Antenna) -> None:
    leg = robot.leg(antenna.leg)
    if leg.cell_index(antenna.cell) != 0:
        raise InputError(
            f"cell = {antenna.cell!r} of antenna {antenna.name!r}: a crank on the body moves the "
            f"anchor p of the inner cell only; use cell = {leg.chain.names[0]!r}."
        )
    if antenna.side == leg.side or antenna.pivot[1] * leg.side <= 0.0:
        raise InputError(
            f"antenna {antenna.name!r}: its cord needs a pivot on the side of leg {leg.name!r} and "
            f"a tip on the other side; change the sign of pivot y or of the angle, or use the "
            f"other leg."
        )
    x, y = antenna.moves
    if x >= 0.0 or abs(y) > 1e-9:
        raise InputError(
            f"moves = ({mm(x)}, {mm(y)}) mm of antenna {antenna.name!r}: the crank pulls an "
            f"anchor towards the midline; use (-{mm(abs(x) or 1e-3)}, 0) mm."
        )
