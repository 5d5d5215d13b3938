"""A leg in the simulation: sliding blocks, levers, bands, the V and its foot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from stepwell.robot import Leg, Robot
from stepwell.simulation.model import parts
from stepwell.simulation.model.parts import Vec3
from stepwell.simulation.model.settings import Settings

# The damping that keeps a lever's sideways swing quiet [N s/m]: small beside that of a travel.
SIDEWAYS = 0.02
# Levers and bands lie on top of the blocks, where they are seen [m].
TOP = 0.007


@dataclass(frozen=True)
class Places:
    """Where the parts of a leg are in the reference position, every lever at θ = 0.

    Attributes:
        blocks: (cells,) x of each moving block [m], inner first, at its pivot.
        joints: (cells,) x at which the lever of each cell crosses from block to block [m].
        sideways: (cells + 1,) y of the lever joints of each block [m], the body's first.
        foot: (x, z) of the tip [m].
    """

    blocks: tuple[float, ...]
    joints: tuple[float, ...]
    sideways: tuple[float, ...]
    foot: tuple[float, float]


def places(robot: Robot, leg: Leg) -> Places:
    """The reference position of a leg."""
    cells = leg.chain.cells
    half = [cell.full_travel / 2 for cell in cells]
    middle = leg.at[0] + robot.foot.span / 2 - sum(half[:-1])
    blocks = [middle - robot.foot.span - half[-1], middle]
    for travel in half[-2:0:-1]:
        blocks.append(blocks[-1] + robot.blocks.length + 2 * travel)
    blocks.reverse()
    # A lever is drawn beside the block that it leaves; the body's first beside the first block.
    joints = [blocks[0], *blocks[:-1]]
    sideways = [leg.at[1]]
    for cell in cells:
        sideways.append(sideways[-1] + leg.side * cell.lever)
    width = robot.foot.span + half[-1]
    tip = (middle - width / 2, -math.sqrt(robot.foot.link**2 - width**2 / 4))
    return Places(tuple(blocks), tuple(joints), tuple(sideways), tip)


def in_body(leg: Leg, anchor: tuple[float, float]) -> Vec3:
    """An anchor's offset in the body's frame: along the chain is backwards."""
    return (-anchor[1], leg.side * anchor[0], 0.0)


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
    last = len(cells) - 1
    previous, origin = body, (0.0, 0.0)
    joints: list[str] = []
    for i, cell in enumerate(cells):
        name = f"{leg.name}.{leg.chain.names[i]}"
        x, y = where.blocks[i], where.sideways[i + 1]
        if i < last:
            joints.append(
                _sliding(robot, leg, body, name, x, sum(c.full_travel for c in cells[: i + 1]))
            )
        else:
            joints.append("stroke")
        carrier = body if i == last else spec.body(f"{name}.block")
        lateral = _swinging(robot, leg, carriage if i == last else carrier, name, x, y)
        # The lever and the band join this block to the previous one.
        joint = where.joints[i]
        inner = (joint - origin[0], where.sideways[i] - origin[1], TOP)
        outer = (joint - x, 0.0, TOP)
        parts.site(previous, f"{name}.lever.in", inner)
        parts.site(lateral, f"{name}.lever.out", outer)
        ends = (f"{name}.lever.in", f"{name}.lever.out")
        parts.between(spec, f"{name}.lever", ends, width=0.0016, rgba=parts.LEVER)
        parts.fixed_length(spec, f"{name}.lever", settings)
        add_bands(spec, leg, i, (previous, inner), (lateral, outer), anchors)
        factors = {joints[i]: 1.0} | ({joints[i - 1]: -1.0} if i else {})
        parts.combined(
            spec,
            f"{name}.travel",
            factors,
            limited=True,
            range=(0.0, cell.full_travel),
            damping=robot.blocks.damping,
            frictionloss=cell.friction,
            solref_limit=(settings.contact_time, 1.0),
            # MuJoCo's own values let a slow cell creep at a fraction of its friction.
            solref_friction=(settings.contact_time, 1.0),
            solimp_friction=parts.STIFF,
        )
        previous, origin = lateral, (x, y)
    _foot(spec, robot, leg, body, carriage, where, settings)


def add_bands(
    spec: Any,
    leg: Leg,
    number: int,
    inner: tuple[Any, Vec3],
    outer: tuple[Any, Vec3],
    anchors: dict[int, Any],
) -> None:
    """Add the bands of a cell.

    Args:
        spec: the model.
        leg: whose.
        number: of the cell, from inside.
        inner, outer: each block's body, and the midpoint of its lever joints in it [m].
        anchors: cell number to the body that carries its anchor p, where an antenna moves it.
    """
    name, cell = f"{leg.name}.{leg.chain.names[number]}", leg.chain.cells[number]
    for j, band in enumerate(cell.bands):
        label = f"{name}.band" if len(cell.bands) == 1 else f"{name}.band{j + 1}"
        (x, y, z), p, q = inner[1], in_body(leg, band.p), in_body(leg, band.q)
        if number in anchors and j == 0:
            parts.site(anchors[number], f"{label}.p")
        else:
            parts.site(inner[0], f"{label}.p", (x + p[0], y + p[1], z))
        x, y, z = outer[1]
        parts.site(outer[0], f"{label}.q", (x + q[0], y + q[1], z))
        parts.between(
            spec,
            label,
            (f"{label}.p", f"{label}.q"),
            width=0.0012,
            rgba=parts.BAND,
            **parts.stretch(band),
        )


def _sliding(robot: Robot, leg: Leg, body: Any, name: str, x: float, travel: float) -> str:
    """A block that slides along the chain; returns the name of its joint."""
    block = body.add_body(name=f"{name}.block", pos=(x, leg.at[1], 0.0))
    parts.slide(block, f"{name}.block", (-1.0, 0.0, 0.0), ref=travel / 2)
    outline(robot, block)
    return f"{name}.block"


def _swinging(robot: Robot, leg: Leg, carrier: Any, name: str, x: float, y: float) -> Any:
    """The sideways part of a block: its lever joints and its anchors."""
    on_body = carrier.name in ("body", "carriage")
    at = (x, y, 0.0) if on_body else (0.0, y - leg.at[1], 0.0)
    lateral = carrier.add_body(name=f"{name}.side", pos=at)
    parts.slide(lateral, f"{name}.side", (0.0, leg.side, 0.0), damping=SIDEWAYS)
    share = 1.0 if carrier.name == "carriage" else 0.5
    parts.box(
        lateral,
        (robot.blocks.length / 2, 0.004, 0.004),
        (0.0, 0.0, TOP),
        mass=robot.blocks.mass * share,
        rgba=parts.BLOCK,
        **parts.SEEN,
    )
    return lateral


def outline(robot: Robot, body: Any, at: Vec3 = (0.0, 0.0, 0.0), mass: float | None = None) -> None:
    """The box of a block, which meets walls."""
    parts.box(
        body,
        (robot.blocks.length, robot.blocks.width, 0.008),
        at,
        mass=robot.blocks.mass / 2 if mass is None else mass,
        rgba=parts.BLOCK,
        priority=2,
        condim=3,
        friction=(robot.body.wall_friction, 0.0, 0.0),
        **parts.BLOCKS,
    )


def _foot(
    spec: Any, robot: Robot, leg: Leg, body: Any, carriage: Any, where: Places, settings: Settings
) -> None:
    name = leg.name
    add_tip(robot, leg, body, where, settings)
    middle = spec.body(f"{name}.{leg.chain.names[-2]}.block")
    parts.site(middle, f"{name}.pivot.in")
    parts.site(carriage, f"{name}.pivot.out", (where.blocks[-1], leg.at[1], 0.0))
    for link, pivot in (("in", "pivot.in"), ("out", "pivot.out")):
        label = f"{name}.link.{link}"
        ends = (f"{name}.{pivot}", f"{name}.tip")
        parts.between(spec, label, ends, width=0.0016, rgba=parts.LINK)
        parts.fixed_length(spec, label, settings)


def add_tip(
    robot: Robot,
    leg: Leg,
    body: Any,
    where: Places,
    settings: Settings,
    links: float = 0.0,
) -> None:
    """Add a foot, free in its leg's plane; what its links weigh [kg] is taken off it."""
    foot, name = robot.foot, leg.name
    tip = body.add_body(name=f"{name}.foot", pos=(where.foot[0], leg.at[1], where.foot[1]))
    parts.slide(tip, f"{name}.foot.x", (1.0, 0.0, 0.0))
    parts.slide(tip, f"{name}.foot.z", (0.0, 0.0, 1.0))
    parts.ball(
        tip,
        foot.radius,
        (0.0, 0.0, foot.radius),
        name=f"{name}.foot",
        mass=foot.mass - links,
        rgba=parts.FOOT,
        priority=1,
        condim=3,
        friction=(robot.floor.foot_friction, 0.0, 0.0),
        solref=(settings.contact_time, 1.0),
        solimp=parts.TOUCHING,
        **parts.FEET,
    )
    parts.site(tip, f"{name}.tip")
    tip.add_site(
        name=f"{name}.sole",
        pos=(0, 0, foot.radius),
        size=(1.1 * foot.radius,) * 3,
        rgba=parts.HIDDEN,
    )
