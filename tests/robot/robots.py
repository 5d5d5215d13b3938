"""Robots that the tests of this room predict: the paper's, and one with antennas."""

from functools import cache
from typing import Any, NamedTuple

import stepwell as sw
from stepwell.robot import Antenna, Foot, Leg, Robot
from stepwell.robot.leg_cycles import leg_cycles
from stepwell.robot.slide import slide

FORWARD, BACKWARD = "00>10>11>01>00", "00>01>11>10>00"
VIA_01 = "00>01>11>01>00"


def cell(name: str, q: float, p: float = -0.010, k: float = 30.0, rest: float = 0.010):
    return sw.Cell(sw.Band((p, 0.0), (q, 0.0), k, rest), name=name)


def leg(name: str, q_out: float, q_in: float = 0.010) -> Leg:
    side = 1 if name == "left" else -1
    return Leg(name, sw.Chain([cell("inner", q_in), cell("outer", q_out)]), (0.008, side * 0.0575))


def robot(left: float = 0.020, right: float | None = None, **more: Any) -> Robot:
    """The paper's robot with its outer anchors at these x [m]."""
    return Robot([leg("left", left), leg("right", left if right is None else right)], **more)


def explorer(**more: Any) -> Robot:
    """A robot whose antennas turn the opposite leg round."""

    def legs(name: str, side: int) -> Leg:
        inner = cell("inner", 0.010, -0.007, 58.75, 0.022)
        chain = sw.Chain([inner, cell("outer", 0.014, -0.010, 47.0, 0.022)])
        return Leg(name, chain, (0.008, side * 0.0575))

    def antenna(name: str, side: int, opposite: str) -> Antenna:
        pivot = (0.110, -0.025 * side)
        return Antenna(name, pivot, 0.130, 1.1 * side, opposite, (-0.010, 0.0), **more)

    return Robot(
        [legs("left", 1), legs("right", -1)],
        foot=Foot(below=0.0003),
        antennas=[antenna("left", 1, "right"), antenna("right", -1, "left")],
    )


class Motion(NamedTuple):
    """Gait of each leg, and how far a cycle takes the robot: forward, left [1], turned [rad]."""

    gaits: dict[str, str]
    advance: float
    sideways: float
    turn: float


def gaits(one: Robot) -> dict[str, str]:
    """The gait of each leg as the prediction has it, without its margins, drags and flips."""
    return {cycle.leg.name: cycle.gait() for cycle in leg_cycles(one)}


@cache
def motion(one: Robot) -> Motion:
    """What a prediction says of a cycle, in a tenth of the time that its doubts take."""
    cycles = leg_cycles(one)
    x, y, turn = slide(one, cycles).displacement()
    most = max(leg.stroke for leg in one.legs)
    return Motion({each.leg.name: each.gait() for each in cycles}, x / most, y / most, turn)
