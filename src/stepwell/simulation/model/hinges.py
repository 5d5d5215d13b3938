"""A leg with every lever and every link a hinged body: the check on the legs of rods."""

from __future__ import annotations

import math
from typing import Any

from stepwell.mechanism import Cell
from stepwell.robot import Leg, Robot
from stepwell.simulation.model import parts
from stepwell.simulation.model.leg import SIDEWAYS, TOP, Places, add_bands, add_tip, outline, places
from stepwell.simulation.model.parts import Vec3
from stepwell.simulation.model.settings import Settings

APART = 0.012  # the two levers of a cell, along the chain [m]
# Levers and links are light beside blocks and feet, of whose mass theirs is a part, so that the
# robot weighs the same as one on rods: these shares of a block for a lever, of a foot for a link.
LEVER = 0.05
LINK = 0.075
THICK = 0.001  # radius of what is drawn [m]
# Light bodies make soft constraints, so these are set stiffer than the rods'.
STIFF = (0.998, 0.999, 0.001, 0.5, 2.0)


def add_leg(
    spec: Any,
    robot: Robot,
    leg: Leg,
    body: Any,
    carriage: Any,
    anchors: dict[int, Any],
    settings: Settings,
) -> None:
    """Add a leg to the model.

    Two levers hinged on each block hold the next one parallel; no guide keeps it from turning.
    The V hangs from sliders that share a block's travel and not its sideways swing, so that the
    foot stays in its leg's plane, as it does on rods. Joints, sites and sums that a recording
    reads have the same names.

    Args:
        spec: the model.
        robot: whose leg it is.
        leg: the leg.
        body, carriage: bodies of the model.
        anchors: cell number to the body that carries its anchor p, where an antenna moves it.
        settings: of the simulation.
    """
    where = places(robot, leg)
    cells = leg.chain.cells
    previous, origin = body, (0.0, 0.0)
    moved: dict[str, float] = {}
    for i, cell in enumerate(cells):
        name = f"{leg.name}.{leg.chain.names[i]}"
        x, y = where.blocks[i], where.sideways[i + 1]
        if i < len(cells) - 1:
            travel = sum(c.full_travel for c in cells[: i + 1])
            block = _block(robot, leg, body, name, (x, y), travel)
            moves = f"{name}.block"
        else:
            # The carriage guides the outermost block along the stroke and lets it swing.
            block = carriage.add_body(name=f"{name}.side", pos=(x, y, 0.0))
            _swing(robot, leg, block, name, robot.blocks.mass)
            moves = "stroke"
        inner = (where.joints[i] - origin[0], where.sideways[i] - origin[1], TOP)
        outer = (where.joints[i] - x, 0.0, TOP)
        _levers(spec, robot, leg, name, cell, (previous, inner), (block, outer), settings)
        add_bands(spec, leg, i, (previous, inner), (block, outer), anchors)
        parts.combined(
            spec,
            f"{name}.travel",
            {moves: 1.0} | moved,
            damping=robot.blocks.damping,
            frictionloss=cell.friction,
            solref_friction=(settings.contact_time, 1.0),
            solimp_friction=parts.STIFF,
        )
        moved = {moves: -1.0}
        previous, origin = block, (x, y)
    _links(spec, robot, leg, body, carriage, where, settings)


def start(robot: Robot, leg: Leg) -> dict[str, float]:
    """Angle of each hinge [rad], by its name, with every cell at 0."""
    angles: dict[str, float] = {}
    for cell, name in zip(leg.chain.cells, leg.chain.names, strict=True):
        for end in ("front", "back"):
            angles[f"{leg.name}.{name}.lever.{end}"] = -cell.limit
    link, span = robot.foot.link, robot.foot.span
    half = leg.chain.cells[-1].full_travel / 2
    # Upright, a link has angle 0; the links spread as the pivots move apart.
    spread = math.asin((span + half) / 2 / link) - math.asin(span / 2 / link)
    angles[f"{leg.name}.link.in"] = -spread
    angles[f"{leg.name}.link.out"] = spread
    return angles


def _block(
    robot: Robot, leg: Leg, body: Any, name: str, at: tuple[float, float], travel: float
) -> Any:
    """A slider that carries a V, and on it the block, which swings; returns the block."""
    mass = robot.blocks.mass / 2
    slider = body.add_body(name=f"{name}.block", pos=(at[0], leg.at[1], 0.0))
    parts.slide(slider, f"{name}.block", (-1.0, 0.0, 0.0), ref=travel / 2)
    outline(robot, slider, mass=mass)
    block = slider.add_body(name=f"{name}.side", pos=(0.0, at[1] - leg.at[1], 0.0))
    _swing(robot, leg, block, name, mass)
    return block


def _swing(robot: Robot, leg: Leg, block: Any, name: str, mass: float) -> None:
    """Free a block sideways and about the vertical; the levers do the rest."""
    parts.slide(block, f"{name}.side", (0.0, leg.side, 0.0), damping=SIDEWAYS)
    parts.hinge(block, f"{name}.yaw", (0.0, 0.0, 1.0))
    parts.box(
        block,
        (robot.blocks.length / 2, 0.004, 0.004),
        (0.0, 0.0, TOP),
        mass=mass - 2 * LEVER * robot.blocks.mass,
        rgba=parts.BLOCK,
        **parts.SEEN,
    )


def _levers(
    spec: Any,
    robot: Robot,
    leg: Leg,
    name: str,
    cell: Cell,
    inner: tuple[Any, Vec3],
    outer: tuple[Any, Vec3],
    settings: Settings,
) -> None:
    """Two parallel levers from block to block, whose hinges end at the stops."""
    tip = (0.0, leg.side * cell.lever, 0.0)
    for end, shift in (("front", APART / 2), ("back", -APART / 2)):
        label = f"{name}.lever.{end}"
        lever = inner[0].add_body(name=label, pos=_shifted(inner[1], shift))
        parts.hinge(
            lever,
            label,
            (0.0, 0.0, leg.side),
            range=(-cell.limit, cell.limit),
            limited=True,
            solref_limit=(settings.contact_time, 1.0),
            solimp_limit=STIFF,
        )
        mass = LEVER * robot.blocks.mass
        parts.rod(lever, (0, 0, 0), tip, THICK, mass=mass, rgba=parts.LEVER, **parts.SEEN)
        parts.site(lever, f"{label}.tip", tip)
        parts.site(outer[0], f"{label}.pin", _shifted(outer[1], shift))
        _pin(spec, label, (f"{label}.tip", f"{label}.pin"), settings)
    parts.site(inner[0], f"{name}.lever.in", inner[1])
    parts.site(outer[0], f"{name}.lever.out", outer[1])
    _measure(spec, f"{name}.lever", (f"{name}.lever.in", f"{name}.lever.out"))


def _links(
    spec: Any,
    robot: Robot,
    leg: Leg,
    body: Any,
    carriage: Any,
    where: Places,
    settings: Settings,
) -> None:
    mass = LINK * robot.foot.mass
    add_tip(robot, leg, body, where, settings, links=2 * mass)
    slider = spec.body(f"{leg.name}.{leg.chain.names[-2]}.block")
    pivots = {
        "in": (slider, where.blocks[-2], (0.0, 0.0, 0.0)),
        "out": (carriage, where.blocks[-1], (where.blocks[-1], leg.at[1], 0.0)),
    }
    for end, (holder, x, at) in pivots.items():
        label = f"{leg.name}.link.{end}"
        tip = (where.foot[0] - x, 0.0, where.foot[1])
        link = holder.add_body(name=label, pos=at)
        parts.hinge(link, label, (0.0, 1.0, 0.0))
        parts.rod(link, (0, 0, 0), tip, THICK, mass=mass, rgba=parts.LINK, **parts.SEEN)
        parts.site(link, f"{label}.tip", tip)
        parts.site(holder, f"{leg.name}.pivot.{end}", at)
        _pin(spec, label, (f"{label}.tip", f"{leg.name}.tip"), settings)
        _measure(spec, label, (f"{leg.name}.pivot.{end}", f"{leg.name}.tip"))


def _pin(spec: Any, name: str, sites: tuple[str, str], settings: Settings) -> None:
    """Hold two points together."""
    spec.add_equality(
        type=parts.mujoco.mjtEq.mjEQ_CONNECT,
        objtype=parts.mujoco.mjtObj.mjOBJ_SITE,
        name=name,
        name1=sites[0],
        name2=sites[1],
        solref=(settings.contact_time, 1.0),
        solimp=STIFF,
    )


def _measure(spec: Any, name: str, sites: tuple[str, str]) -> None:
    """A line that carries nothing and whose length tells that the linkage holds."""
    parts.between(spec, name, sites, rgba=parts.HIDDEN)


def _shifted(point: Vec3, along: float) -> Vec3:
    return point[0] + along, point[1], point[2]
