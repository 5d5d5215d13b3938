"""Robots that the tests of the simulation walk: the paper's, and one with antennas."""

from dataclasses import replace
from functools import cache
from typing import Any

import stepwell as sw
from stepwell.robot import Antenna, Foot, Leg, Robot
from stepwell.simulation import Linkage, Settings, Walk, walk

AT = (0.008, 0.0575)
STIFFNESS, REST = 30.0, 0.010

# A foot that is put down at the front and lifted at the back, and the other way round.
FORWARD, BACKWARD = "00>10>11>01>00", "00>01>11>10>00"


def cell(name: str, q: float, p: float = -0.010, k: float = STIFFNESS, rest: float = REST):
    """A cell of the paper's size with its band from (p, 0) to (q, 0) [m]."""
    return sw.Cell(sw.Band((p, 0.0), (q, 0.0), k, rest), name=name, unusual=k > 1e4)


def leg(name: str, q_out: float) -> Leg:
    """A leg of the paper's robot with the outer anchor at (q_out, 0) [m]."""
    side = 1 if name == "left" else -1
    chain = sw.Chain([cell("inner", 0.010), cell("outer", q_out)])
    return Leg(name, chain, (AT[0], side * AT[1]))


def leg_of_three(name: str) -> Leg:
    """A leg that steps with two cells, one after the other."""
    side = 1 if name == "left" else -1
    cells = [cell("inner", 0.008), cell("middle", 0.012), cell("outer", 0.020)]
    return Leg(name, sw.Chain(cells), (AT[0], side * AT[1]))


def robot(left: float = 0.020, right: float | None = None, **more: Any) -> Robot:
    """The paper's robot with its outer anchors at these x [m], every other number as assumed."""
    return Robot([leg("left", left), leg("right", left if right is None else right)], **more)


def explorer(connected: bool = True) -> Robot:
    """A robot whose antennas turn the opposite leg round: `robot-explorer` on shallower feet."""

    def legs(name: str, side: int) -> Leg:
        chain = sw.Chain(
            [cell("inner", 0.010, -0.007, 58.75, 0.022), cell("outer", 0.014, -0.010, 47.0, 0.022)]
        )
        return Leg(name, chain, (AT[0], side * AT[1]))

    def antenna(name: str, side: int, opposite: str) -> Antenna:
        return Antenna(
            name,
            pivot=(0.110, -0.025 * side),
            length=0.130,
            angle=1.1 * side,
            leg=opposite,
            moves=(-0.010, 0.0),
            hook=0.012,
            connected=connected,
        )

    return Robot(
        [legs("left", 1), legs("right", -1)],
        foot=Foot(below=0.0003),
        antennas=[antenna("left", 1, "right"), antenna("right", -1, "left")],
    )


def mirrored(one: Robot) -> Robot:
    """Left and right changed over."""
    swap = {"left": "right", "right": "left"}
    legs = [replace(a, name=swap[a.name], at=(a.at[0], -a.at[1])) for a in reversed(one.legs)]
    return replace(one, legs=tuple(legs))


@cache
def walked(left: float, right: float, cycles: float = 4, linkage: Linkage = Linkage.RODS) -> Walk:
    """A walk of the paper's robot that several tests look at."""
    return walk(robot(left, right), cycles, settings=Settings(linkage=linkage))
