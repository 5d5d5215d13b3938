"""Robots, walks and ways through arenas to draw."""

from dataclasses import replace

import numpy as np

from stepwell.mechanism import Band, Cell, Chain
from stepwell.robot import Antenna, Body, Drive, Foot, Leg, Robot
from stepwell.simulation import Walk

SIDES = (("left", 1), ("right", -1))


def walker(left: float = 0.020, right: float = 0.020, title: str = "") -> Robot:
    """The paper's robot with these outer anchors q_x [m]."""
    legs = [
        Leg(name, two_cells(q), (0.008, side * 0.0575))
        for (name, side), q in zip(SIDES, (left, right), strict=True)
    ]
    return Robot(legs, title=title)


def two_cells(q: float, stiffness: float = 30.0, rest: float = 0.010) -> Chain:
    inner = Cell(Band((-0.010, 0.0), (0.010, 0.0), stiffness, rest), name="inner")
    outer = Cell(Band((-0.010, 0.0), (q, 0.0), stiffness, rest), name="outer")
    return Chain((inner, outer))


def explorer(*, connected: bool = True) -> Robot:
    """Antennas crossed in front of the body, each on the inner anchor of the other leg."""
    chain = two_cells(0.014, 47.0, 0.022)
    inner = Cell(Band((-0.007, 0.0), (0.010, 0.0), 58.75, 0.022), name="inner")
    chain = Chain((inner, chain.cells[1]))
    antennas = [
        Antenna(name, (0.110, side * -0.025), 0.130, side * 1.1, other, (-0.010, 0.0),
                hook=0.012, connected=connected)
        for (name, side), other in zip(SIDES, ("right", "left"), strict=True)
    ]  # fmt: skip
    legs = [Leg(name, chain, (0.008, side * 0.0575)) for name, side in SIDES]
    robot = Robot(legs, foot=Foot(below=0.0003), antennas=antennas, title="explorer")
    return robot.with_anchors("right", 0, p=(-0.0078, 0.0))


def three_cells() -> Robot:
    """Two cells step, the third lifts the foot; two bands on one of them."""
    cells = (
        Cell(Band((-0.010, 0.002), (0.010, -0.003)), lever=0.009),
        Cell((Band((-0.010, 0.0), (0.015, 0.0)), Band((-0.005, 0.001), (0.012, 0.0))), lever=0.009),
        Cell(Band((-0.010, 0.0), (0.020, 0.0)), lever=0.010),
    )
    legs = [Leg(name, Chain(cells), (0.008, side * 0.0575)) for name, side in SIDES]
    return Robot(legs, drive=Drive(amplitude=0.039))


def four_legs() -> Robot:
    """Two legs on each side."""
    legs = [
        Leg(f"{name} {i + 1}", two_cells(0.020), (0.008, side * (0.060 + 0.045 * i)))
        for name, side in SIDES
        for i in (0, 1)
    ]
    return Robot(legs, body=Body(mass=0.3), title="four legs")


def cut(walk: Walk, samples: int, stopped: str = "") -> Walk:
    """The same walk, as if it had ended after so many samples."""
    names = (
        "time x y z yaw pitch roll command stroke travel foot_height foot_force foot_speed "
        "support_force actuator_force antenna touch obstacle_force"
    )
    parts = {name: np.asarray(getattr(walk, name))[:samples] for name in names.split()}
    return replace(walk, stopped=stopped, **parts)
