"""Motion of a robot's bodies relative to the reference pose, and how fast each parameter moves it.

A parameter is the angle of a cell [rad], as ("left", 0), or the swing of an antenna, as ("antenna",
"left"). All are independent, so that all states of both legs and all antenna angles are among them.
Two bodies that are moved by fewer have parameters of their own: the stroke of the carriage [m], as
STROKE, and the place of an outer block along the carriage's slot [m], as ("across", "left").
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Vec2
from stepwell.build.robots.plan import AntennaPlan, LegPlan, RobotPlan, near

Parameter = tuple[str, int | str]
# How a parameter moves a body: with the swinging block of a cell, with its travel alone, by
# turning, or in a way of its own.
ARC, ALONG, TURN, OWN = "arc", "along", "turn", "own"
# Bodies of a leg that move in the plane of x and z.
UPRIGHT = ("link front", "link rear", "foot")

STROKE: Parameter = ("stroke", "")


class Moved(NamedTuple):
    """(n, 2) shift [m], and (n,) turn [rad] about the point `hinge` of the reference pose [m].

    Both are in plan; of an upright body in the plane of x and z.
    """

    shift: Floats
    turn: Floats
    hinge: tuple[float, float]

    def of(self, point: Vec2) -> Floats:
        """(n, 2) places [m] of a point of the body, which is given in the reference pose [m]."""
        hinge = np.array(self.hinge)
        x, y = np.array(point) - hinge
        c, s = np.cos(self.turn), np.sin(self.turn)
        return self.shift + hinge + np.column_stack([c * x - s * y, s * x + c * y])


@dataclass(frozen=True)
class Motions:
    """The motion of every body of a plan."""

    plan: RobotPlan

    def ranges(self) -> dict[Parameter, tuple[float, float]]:
        """Least and largest value of each parameter; at the first, the robot is at rest."""
        found: dict[Parameter, tuple[float, float]] = {}
        for leg in self.plan.legs:
            for number, cell in enumerate(leg.cells):
                found[leg.leg.name, number] = (-cell.limit, cell.limit)
        for one in self.plan.antennas:
            found["antenna", one.antenna.name] = (0.0, one.antenna.swing)
        return found

    def split(self, body: str) -> tuple[str, str]:
        """The leg or the antenna of a body, and what follows its name; ("", body) for others."""
        names = [one.antenna.name for one in self.plan.antennas]
        owner, _, kind = body.rpartition(".")
        if kind in ("antenna", "crank") and owner in names:
            return owner, kind
        for leg in self.plan.legs:
            if body.startswith(f"{leg.leg.name}."):
                return leg.leg.name, body.removeprefix(f"{leg.leg.name}.")
        return "", body

    def upright(self, body: str) -> bool:
        """Whether a body moves in the plane of x and z, not in plan."""
        return self.split(body)[1] in UPRIGHT

    def across(self, leg: LegPlan) -> tuple[float, float]:
        """Range of the place of an outer block along the carriage's slot, 0 in state 00 [m]."""
        first, second = leg.cells
        return near(second) - second.lever, first.lever - near(first)

    def reach(
        self, body: str, extent: float, driver: str = ""
    ) -> dict[Parameter, tuple[str, float]]:
        """For each parameter that moves a body, how, and the largest speed of its points.

        Args:
            body: its name.
            extent: largest distance of its points from its hinge [m], for bodies that turn.
            driver: leg whose cells move the carriage; the first by default.
        """
        owner, kind = self.split(body)
        if body == "body":
            return {}
        if kind in ("antenna", "crank"):
            name = owner
            if kind == "antenna":
                return {("antenna", name): (TURN, extent)}
            one = next(one for one in self.plan.antennas if one.antenna.name == name)
            return {("antenna", name): (TURN, extent * _crank_rate(one))}
        leg = self._leg(owner, driver)
        first, second = leg.cells
        zero, one_ = (leg.leg.name, 0), (leg.leg.name, 1)
        inner, outer = leg.leg.chain.names
        if kind.startswith(f"{inner}.lever"):
            return {zero: (TURN, extent)}
        if kind == f"{inner}.block":
            return {zero: (ARC, first.lever)}
        if kind.startswith(f"{outer}.lever"):
            return {zero: (ARC, first.lever), one_: (TURN, extent)}
        if kind == f"{outer}.block":
            return {zero: (ARC, first.lever), one_: (ARC, second.lever)}
        if kind == "slider":
            return {zero: (ALONG, first.lever)}
        if body in ("carriage", "rod"):
            return {zero: (ALONG, first.lever), one_: (ALONG, second.lever)}
        # The V: its apex moves with half the travel of the outer cell, and rises.
        turning = second.lever / self._least_rise()
        if kind == "foot":
            steep = (self.plan.robot.foot.span + second.full_travel) / 4.0 / self._least_depth()
            return {zero: (ALONG, first.lever), one_: (OWN, second.lever * math.hypot(0.5, steep))}
        more = second.lever if kind == "link rear" else 0.0
        return {zero: (ALONG, first.lever), one_: (OWN, more + extent * turning)}

    def _least_depth(self) -> float:
        foot = self.plan.robot.foot
        travel = max(leg.cells[1].full_travel for leg in self.plan.legs)
        return float(foot.depth(travel))

    def _least_rise(self) -> float:
        """The travel of the outer cell per angle of a link is at least this [m/rad]."""
        return 2.0 * self._least_depth()

    def _leg(self, owner: str, driver: str) -> LegPlan:
        wanted = [leg for name in (owner, driver) for leg in self.plan.legs if leg.leg.name == name]
        return wanted[0] if wanted else self.plan.legs[0]

    def of(self, body: str, values: Mapping[Parameter, Floats], driver: str = "") -> Moved:
        """The motion of a body at parameters (n,) each; those that are not given are at rest."""
        count = max((len(one) for one in values.values()), default=1)
        owner, kind = self.split(body)
        still = np.zeros(count)
        if body == "body":
            return Moved(np.zeros((count, 2)), still, (0.0, 0.0))
        if kind in ("antenna", "crank"):
            return self._antenna(owner, kind, values, count)
        leg = self._leg(owner, driver)
        if STROKE in values and body in ("carriage", "rod"):
            return Moved(np.column_stack([-values[STROKE], still]), still, (0.0, 0.0))
        if ("across", owner) in values:
            across = leg.side * values["across", owner]
            return Moved(np.column_stack([still, across]), still, (0.0, 0.0))
        return self._of_leg(leg, kind or body, self._cells(leg, values, count))

    def table(self, bodies: Sequence[str], values: Mapping[Parameter, Floats]) -> Floats:
        """(n, bodies, 4) shift x, y, z [m] and turn [rad] about the hinges, see `of`."""
        each = [self.of(name, values) for name in bodies]
        found = np.zeros((max(len(one.shift) for one in each), len(each), 4))
        for k, (name, one) in enumerate(zip(bodies, each, strict=True)):
            second = 2 if self.upright(name) else 1
            found[:, k, [0, second]], found[:, k, 3] = one.shift, one.turn
        return found

    def _cells(self, leg: LegPlan, values: Mapping[Parameter, Floats], count: int) -> list[Floats]:
        return [
            np.asarray(values.get((leg.leg.name, i), np.full(count, -cell.limit)), float)
            for i, cell in enumerate(leg.cells)
        ]

    def _of_leg(self, leg: LegPlan, kind: str, theta: list[Floats]) -> Moved:
        travels, across = [], []
        for cell, angle in zip(leg.cells, theta, strict=True):
            travels.append(cell.lever * (np.sin(angle) + math.sin(cell.limit)))
            across.append(cell.lever * (np.cos(angle) - math.cos(cell.limit)))
        inner, outer = leg.leg.chain.names
        still, side = np.zeros_like(travels[0]), leg.side
        middle = np.column_stack([-travels[0], side * across[0]])
        if kind == f"{inner}.block":
            return Moved(middle, still, (0.0, 0.0))
        if kind == f"{outer}.block":
            last = [-travels[0] - travels[1], side * (across[0] - across[1])]
            return Moved(np.column_stack(last), still, (0.0, 0.0))
        if ".lever " in kind:
            return self._lever(leg, kind, theta, middle)
        along = np.column_stack([-travels[0], still])
        if kind == "slider":
            return Moved(along, still, (0.0, 0.0))
        both = np.column_stack([-travels[0] - travels[1], still])
        if kind in ("carriage", "rod"):
            return Moved(both, still, (0.0, 0.0))
        foot = self.plan.robot.foot
        depth, rest = foot.depth(travels[1]), float(foot.depth(0.0))
        if kind == "foot":
            shift = [-travels[0] - travels[1] / 2.0, rest - depth]
            return Moved(np.column_stack(shift), still, (0.0, 0.0))
        # Links turn about their pivots, opposite to each other.
        half = foot.span / 2.0
        tilt = np.arctan2(depth, half + travels[1] / 2.0) - math.atan2(rest, half)
        if kind == "link front":
            return Moved(along, tilt, (leg.front, 0.0))
        return Moved(both, -tilt, (leg.rear, 0.0))

    def _lever(self, leg: LegPlan, kind: str, theta: list[Floats], middle: Floats) -> Moved:
        name, _, number = kind.rpartition(".lever ")
        index = int(number) - 1
        offset = (index - 0.5) * self.plan.build_file.lever.spacing
        inner, _ = leg.leg.chain.names
        first = name == inner
        x, row, way = (leg.body, leg.row, 1.0) if first else (leg.outer, leg.middle, -1.0)
        cell, angle = (leg.cells[0], theta[0]) if first else (leg.cells[1], theta[1])
        # From the inner joint the lever points along (-r sin θ, ±r cos θ).
        turn = leg.side * way * (angle + cell.limit)
        shift = np.zeros_like(middle) if first else middle
        return Moved(shift, turn, (x + offset, leg.side * row))

    def _antenna(
        self, name: str, kind: str, values: Mapping[Parameter, Floats], count: int
    ) -> Moved:
        one = next(one for one in self.plan.antennas if one.antenna.name == name)
        swing = np.asarray(values.get(("antenna", name), np.zeros(count)), float)
        if kind == "antenna":
            x, y = one.antenna.pivot
            return Moved(np.zeros((count, 2)), one.antenna.side * swing, (float(x), float(y)))
        x, inboard = one.pivot
        leg = one.leg
        turn = leg.side * np.array([one.crank_turn(float(value)) for value in swing])
        return Moved(np.zeros((count, 2)), turn, (x, leg.side * (leg.row - inboard)))


def _crank_rate(one: AntennaPlan) -> float:
    """Largest rotation of a crank per rotation of the antenna [1]."""
    ratio = one.plan.build_file.robot.cord_arm / one.cord_arm
    half = one.antenna.swing / 2.0
    return max(ratio, ratio * math.cos(half) / math.cos(one.turn / 2.0)) * 1.001
