"""What the floor does to a foot that stands: weight and drag, against the travel of its leg."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepwell.base import Floats
from stepwell.robot.gait.standing import HANDOVER, feet_load, stands_proud
from stepwell.robot.parts import Leg, Robot

POINTS = 8  # steps of a leg at which its stance is worked out
HAIR = 1e-5  # travel by which a foot is lifted to see who carries its weight [m]
CLOSE = 0.02  # a foot this share of its travel above the supports' plane is on its way down


@dataclass(frozen=True, eq=False)
class Stance:
    """How a foot of a leg stands, by how far the leg has stepped. k points.

    Attributes:
        robot: whose.
        step: (k,) travel of all cells but the last together [m], rising.
        load: (k,) force of the floor on the foot [N], its own weight included.
        sharing: (k,) how many feet stand there together.
        drags: False leaves the drag out.
    """

    robot: Robot
    step: Floats
    load: Floats
    sharing: Floats
    drags: bool = True

    def load_at(self, step: float) -> float:
        """Force of the floor on the foot [N] when the leg has stepped that far [m]."""
        return float(np.interp(step, self.step, self.load))

    def hold(self, load: Floats, step: Floats | float) -> Floats:
        """Force along the floor [N] on the foot as it moves, carrying `load` [N].

        The drag of the T-foot, which carries what the feet leave it, shared by those that
        stand; or as much of it as the foot can hold before it slips.
        """
        load = np.asarray(load, float)
        if not self.drags:
            return np.zeros_like(load)
        sharing = np.interp(step, self.step, self.sharing)
        left = np.maximum(self.robot.weight - sharing * load, 0.0)
        drag = self.robot.support_friction * left / sharing
        return np.minimum(drag, self.robot.floor.foot_friction * load)

    def slips_below(self, step: float) -> float:
        """Load [N] below which the foot slips and the body stays."""
        sharing = float(np.interp(step, self.step, self.sharing))
        drag = self.robot.support_friction
        if not self.drags or drag == 0.0:
            return 0.0
        # friction x load = drag x (weight - sharing x load) / sharing
        return drag * self.robot.weight / (sharing * (self.robot.floor.foot_friction + drag))

    def push(self, load: Floats, travel: Floats | float, step: Floats | float, way: int) -> Floats:
        """Force by which the floor opens the last cell [N], of the arguments' common shape.

        A force H along the floor acts on the tip, which goes back by the travels of all cells
        but the last and by half of the last one's. A force that is the same on every cell moves
        nothing at a given stroke; so H on all but the last and H/2 on the last is no more
        than -H/2 against the last one.

        Args:
            load: of the floor on the foot [N].
            travel: of the last cell [m].
            step: of the cells before it [m].
            way: +1 while the foot is pushed back (loading), -1 while it is pulled forward.
        """
        own = self.robot.foot.mass * self.robot.floor.gravity
        return (load - own) * self.robot.foot.lever(travel) + way * self.hold(load, step) / 2

    def change(self, start: float, way: int) -> Floats:
        """(k,) by how much more the floor opens the last cell than at `start` [m], in N."""
        each = self.push(self.load, 0.0, self.step, way)
        return each - np.interp(start, self.step, each)


def touch(robot: Robot) -> float:
    """Travel of the last cell [m] past which the foot carries nothing."""
    return max(robot.foot.contact_travel, HANDOVER)


def leaning(robot: Robot) -> Floats:
    """Force of the floor on each foot (legs,) [N] as the actuator sets out from all cells at 0.

    Feet that stand alike share their weight alike. Where one leg would lift its foot and another
    would rather step, the body leans from the one towards the other until both would lift, or
    neither: what a last cell lacks to open is made equal by moving weight, as far as the body
    can lean.
    """
    rest = [np.zeros(len(leg.chain)) for leg in robot.legs]
    even = feet_load(robot, rest)
    most, least = even.copy(), even.copy()
    for i in range(len(rest)):
        for bound, chosen in ((least, [i]), (most, [k for k in range(len(rest)) if k != i])):
            leant = [travel.copy() for travel in rest]
            for k in chosen:
                leant[k][-1] = HAIR
            bound[i] = feet_load(robot, leant)[i]
    lacks = np.array([_lacks(leg) for leg in robot.legs])
    moved = even + (lacks - lacks.mean()) / float(robot.foot.lever(0.0))
    return np.clip(moved, np.minimum(least, even), np.maximum(most, even))


def _lacks(leg: Leg) -> float:
    """Force [N] by which the last cell of a leg holds out longer than the others at 0."""
    *stepping, last = leg.chain.cells
    return last.force_0 - min(cell.force_0 for cell in stepping)


def stance(
    robot: Robot, leg: int, others: list[Floats], setting_out: float | None = None
) -> Stance:
    """How a foot stands with its last cell at 0.

    Args:
        robot: any robot.
        leg: number of the leg.
        others: for each leg (POINTS, cells) travels [m] of the others at these steps of the
            leg; its own are not looked at.
        setting_out: force of the floor on the foot before it has stepped [N]; None shares
            the weight there as everywhere.
    """
    cells = robot.legs[leg].chain.cells
    full = np.array([cell.full_travel for cell in cells])
    share = np.linspace(0.0, 1.0, POINTS)
    loads, sharing = [], []
    for k, part in enumerate(share):
        travels = [other[k].copy() for other in others]
        travels[leg] = np.append(part * full[:-1], 0.0)
        for travel, one in zip(travels, robot.legs, strict=True):
            # A foot that only just touches is about to stand.
            if travel[-1] <= touch(robot) + CLOSE * one.chain.cells[-1].full_travel:
                travel[-1] = 0.0
        loads.append(feet_load(robot, travels)[leg])
        sharing.append(sum(stands_proud(robot, travel) for travel in travels))
    if setting_out is not None:
        loads[0] = setting_out
    return Stance(robot, share * full[:-1].sum(), np.array(loads), np.array(sharing, float))
