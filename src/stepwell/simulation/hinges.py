"""Levers and links as hinged bodies, to validate the legs of rods.

Two levers hinged on each block keep the next one parallel, without a guide.
"""

import math
from typing import TYPE_CHECKING

from stepwell.mechanism import Cell
from stepwell.robot import Leg, Robot
from stepwell.simulation import parts
from stepwell.simulation.parts import Place, Vec3

if TYPE_CHECKING:
    from stepwell.simulation.leg import LegModel

APART = 0.012  # the two levers of a cell, along the chain [m]
# Mass of a lever as a fraction of a block, and of a link as a fraction of a foot. It is taken from
# the block and the foot, so that the robot weighs the same as one on rods.
LEVER = 0.05
LINK = 0.075
THICK = 0.001  # radius of the drawn rods [m]
# Light bodies make constraints soft, so these are set stiffer than those of the rods.
STIFF = (0.998, 0.999, 0.001, 0.5, 2.0)


def start(robot: Robot, leg: Leg) -> dict[str, float]:
    """Angle of each hinge [rad], by its name, with every cell at 0."""
    angles = {
        f"{leg.name}.{name}.lever.{end}": -cell.limit
        for cell, name in zip(leg.chain.levers, leg.chain.names, strict=True)
        for end in ("front", "back")
    }
    link, span = robot.foot.link, robot.foot.span
    half = leg.chain.cells[-1].full_travel / 2
    # Upright, a link has angle 0; the links spread as the pivots move apart.
    spread = math.asin((span + half) / 2 / link) - math.asin(span / 2 / link)
    return angles | {f"{leg.name}.link.in": -spread, f"{leg.name}.link.out": spread}


def add_levers(model: "LegModel", name: str, cell: Cell, inner: Place, outer: Place) -> None:
    """Add two parallel levers from block to block, whose hinges have the stops."""
    tip = (0.0, model.leg.side * cell.lever, 0.0)
    for end, shift in (("front", APART / 2), ("back", -APART / 2)):
        label = f"{name}.lever.{end}"
        (x, y, z), (a, b, c) = inner[1], outer[1]
        lever = inner[0].add_body(name=label, pos=(x + shift, y, z))
        stops = {"limited": True, "range": (-cell.limit, cell.limit), "solimp_limit": STIFF}
        soft = parts.soft(model.settings)
        parts.hinge(lever, label, (0.0, 0.0, model.leg.side), solref_limit=soft, **stops)
        mass = LEVER * model.robot.blocks.mass
        parts.rod(lever, (0, 0, 0), tip, THICK, mass=mass, rgba=parts.LEVER, **parts.SEEN)
        parts.site(lever, f"{label}.tip", tip)
        parts.site(outer[0], f"{label}.pin", (a + shift, b, c))
        _pin(model, label, f"{label}.pin")


def add_link(model: "LegModel", end: str, pivot: Place, tip: Vec3) -> None:
    """Add a link of the V, from a pivot down to the foot's tip."""
    label, mass = f"{model.leg.name}.link.{end}", LINK * model.robot.foot.mass
    link = pivot[0].add_body(name=label, pos=pivot[1])
    parts.hinge(link, label, (0.0, 1.0, 0.0))
    parts.rod(link, (0, 0, 0), tip, THICK, mass=mass, rgba=parts.LINK, **parts.SEEN)
    parts.site(link, f"{label}.tip", tip)
    _pin(model, label, f"{model.leg.name}.tip")


def _pin(model: "LegModel", name: str, site: str) -> None:
    """Connect the tip of a lever or link to a point."""
    model.spec.add_equality(
        type=parts.mujoco.mjtEq.mjEQ_CONNECT,
        objtype=parts.mujoco.mjtObj.mjOBJ_SITE,
        name=name,
        name1=f"{name}.tip",
        name2=site,
        solref=parts.soft(model.settings),
        solimp=STIFF,
    )
