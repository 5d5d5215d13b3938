"""A leg in the simulation: sliding blocks, levers, bands, the V and its foot.

With levers and links as hinged bodies it validates the legs of rods: two levers hinged on each
block keep the next one parallel, without a guide.
"""

import math
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

from stepwell.robot import Leg, Robot
from stepwell.simulation import parts, simulator
from stepwell.simulation.parts import TOP, Place, Vec3

# Damping of a lever's sideways swing [N s/m]: small against the damping of a travel.
SIDEWAYS = 0.02
APART = 0.012  # the two levers of a cell, along the chain [m]
# Mass of a lever as a fraction of a block, and of a link as a fraction of a foot. It is taken from
# the block and the foot, so that the robot weighs the same as one on rods.
LEVER = 0.05
LINK = 0.075
ABOVE = 0.002  # bands over the blocks of a robot made of parts [m]
THICK = 0.001  # radius of the drawn rods [m]
# Light bodies make constraints soft, so these are set stiffer than those of the rods.
STIFF = (0.998, 0.999, 0.001, 0.5, 2.0)


# The joints of a lever on its inner and its outer block, in their frames [m].
LeverPins = tuple[Vec3, Vec3]


@dataclass(frozen=True)
class Places:
    """Places of the parts of a leg in the reference position, every lever at θ = 0."""

    blocks: tuple[float, ...]  # (cells,) x of each moving block [m], inner first, at its pivot
    joints: tuple[float, ...]  # (cells,) x at which each cell's lever crosses between blocks [m]
    sideways: tuple[float, ...]  # (cells + 1,) y of each block's lever joints [m], the body's first
    foot: tuple[float, float]  # (x, z) of the tip [m]


@dataclass(frozen=True)
class LegModel:
    """A leg, and the model and bodies to which it is added."""

    spec: Any  # the model, and two bodies of it
    body: Any
    carriage: Any
    robot: Robot
    leg: Leg
    anchors: dict[int, Any]  # cell number to the body of its anchor p, where an antenna moves it
    settings: simulator.Settings

    @property
    def hinged(self) -> bool:
        """Whether levers and links are hinged bodies instead of lines of fixed length."""
        return self.settings.linkage is simulator.Linkage.HINGES

    def cell_name(self, number: int) -> str:
        """The name of a cell in the model; the cell is counted from inside."""
        return f"{self.leg.name}.{self.leg.chain.names[number]}"


def sides(robot: Robot, leg: Leg) -> tuple[int, ...]:
    """For each cell +1 if its levers at θ = 0 point to the left from the inner block, else -1.

    Levers of plain legs all point away from the midline; in a layout that can be cut they may point
    back, which moves the blocks along the leg alike.
    """
    made = robot.made
    if made is None:
        return (leg.side,) * len(leg.chain)
    levers = (f"{leg.name}.{cell}.lever 1" for cell in leg.chain.names)
    return tuple(1 if made.of(one).centre[1] > made.hinges[one][1] else -1 for one in levers)


def places(robot: Robot, leg: Leg) -> Places:
    """The reference position of a leg."""
    cells = leg.chain.levers
    half = [cell.full_travel / 2 for cell in cells]
    middle = leg.at[0] + robot.foot.span / 2 - sum(half[:-1])
    blocks = [middle - robot.foot.span - half[-1], middle]
    for travel in half[-2:0:-1]:
        blocks.append(blocks[-1] + robot.blocks.length + 2 * travel)
    blocks.reverse()
    # A lever is drawn next to its inner block; the first one next to the first block.
    joints = [blocks[0], *blocks[:-1]]
    levers = (
        side * cell.lever for side, cell in zip(sides(robot, leg), leg.chain.levers, strict=True)
    )
    sideways = accumulate(levers, initial=leg.at[1])
    width = robot.foot.span + half[-1]
    tip = (middle - width / 2, -math.sqrt(robot.foot.link**2 - width**2 / 4))
    return Places(tuple(blocks), tuple(joints), tuple(sideways), tip)


def in_body(side: int, anchor: tuple[float, float]) -> Vec3:
    """An anchor's offset in the body's frame: along the chain is backwards."""
    return (-anchor[1], side * anchor[0], 0.0)


def swung(robot: Robot, leg: Leg, number: int) -> float:
    """Sideways displacement of a block [m] from every lever at θ = 0 to every cell at 0."""
    cells = zip(sides(robot, leg), leg.chain.levers[: number + 1], strict=False)
    return sum(side * cell.lever * (math.cos(cell.limit) - 1.0) for side, cell in cells)


def band_height(robot: Robot) -> float:
    """Height of bands, levers and anchors above the legs' pivots [m]: on top of all blocks."""
    if robot.made is None:
        return TOP
    blocks = (shape for shape in robot.made.shapes if shape.body.endswith(".block"))
    return max((float(shape.vertices[:, 2].max()) for shape in blocks), default=TOP) + ABOVE


def block_start(robot: Robot, leg: Leg, number: int) -> Vec3:
    """Place of a block in the body's frame with every cell at 0 [m]; -1 is the body's own."""
    if number < 0:
        return (0.0, 0.0, 0.0)
    where, cells = places(robot, leg), leg.chain.levers[: number + 1]
    x = where.blocks[number] + sum(cell.full_travel for cell in cells) / 2
    return (x, where.sideways[number + 1] + swung(robot, leg, number), 0.0)


def lever_pins(robot: Robot, leg: Leg, number: int) -> dict[str, LeverPins]:
    """The joints of the two levers of a cell on their blocks, by the lever's end."""
    made = robot.made
    if made is None:
        (x, y, z), (a, b, c) = cell_joints(robot, leg, number)
        ends = {"front": APART / 2, "back": -APART / 2}
        return {end: ((x + dx, y, z), (a + dx, b, c)) for end, dx in ends.items()}
    name, cell = f"{leg.name}.{leg.chain.names[number]}", leg.chain.levers[number]
    side = sides(robot, leg)[number]
    lever = cell.lever * math.sin(cell.limit), side * cell.lever * math.cos(cell.limit)
    (x0, y0, _), (x1, y1, _) = (block_start(robot, leg, number - back) for back in (1, 0))
    pins: dict[str, LeverPins] = {}
    for end, index in (("front", 1), ("back", 2)):
        x, y, z = made.hinges[f"{name}.lever {index}"]
        pins[end] = (x - x0, y - y0, z), (x + lever[0] - x1, y + lever[1] - y1, z)
    return pins


def cell_joints(robot: Robot, leg: Leg, number: int) -> LeverPins:
    """Midpoints between the lever joints of a cell on its two blocks, at the height of bands."""
    top = band_height(robot)
    if robot.made is not None:
        front, back = lever_pins(robot, leg, number).values()
        (x, y), (a, b) = (
            [(one[k] + other[k]) / 2 for k in (0, 1)]
            for one, other in zip(front, back, strict=True)
        )
        return (x, y, top), (a, b, top)
    where = places(robot, leg)
    x, y, own = where.joints[number], where.sideways[number], where.blocks[number]
    x0, y0 = (where.blocks[number - 1], where.sideways[number]) if number else (0.0, 0.0)
    return (x - x0, y - y0, top), (x - own, 0.0, top)


def add_leg(model: LegModel) -> None:
    """Add a leg on rods or on hinges, with the same sensor names."""
    spec, robot, leg, soft = model.spec, model.robot, model.leg, parts.soft(model.settings)
    where, cells, previous = places(robot, leg), leg.chain.levers, model.body
    before: dict[str, float] = {}
    *_, outermost = robot.blocks.masses(len(cells))
    for i, cell in enumerate(cells):
        name = model.cell_name(i)
        x, y = where.blocks[i], where.sideways[i + 1]
        if i < len(cells) - 1:
            carrier, joint, at = _slider(model, i, x), f"{name}.block", (0.0, y - leg.at[1], 0.0)
            mass = robot.blocks.mass / 2
        else:
            # The carriage guides the outermost block along the stroke and lets it swing.
            carrier, joint, at, mass = model.carriage, "stroke", (x, y, 0.0), outermost
        block = carrier.add_body(name=f"{name}.side", pos=at)
        parts.slider(block, f"{name}.side", (0.0, leg.side, 0.0), damping=SIDEWAYS)
        if model.hinged:
            parts.hinge(block, f"{name}.yaw", (0.0, 0.0, 1.0))
            mass -= 2 * LEVER * robot.blocks.mass
        size = (robot.blocks.length / 2, 0.004, 0.004)
        parts.box(block, size, (0.0, 0.0, TOP), mass=mass, rgba=parts.BLOCK, **parts.SEEN)
        # The levers and the bands join this block to the previous one.
        near, far = cell_joints(robot, leg, i)
        inner, outer = (previous, near), (block, far)
        if model.hinged:
            add_levers(model, i, previous, block)
        parts.site(previous, f"{name}.lever.in", inner[1])
        parts.site(block, f"{name}.lever.out", outer[1])
        _add_line(model, f"{name}.lever", (f"{name}.lever.in", f"{name}.lever.out"), parts.LEVER)
        _add_bands(model, i, inner, outer)
        stops = {"limited": True, "range": (0.0, cell.full_travel), "solref_limit": soft}
        parts.combined(
            spec,
            f"{name}.travel",
            {joint: 1.0} | before,
            damping=robot.blocks.damping,
            frictionloss=cell.friction,
            # MuJoCo's own values let a slow cell creep at a fraction of its friction.
            solref_friction=soft,
            solimp_friction=parts.STIFF,
            # On hinges the levers end at the stops.
            **({} if model.hinged else stops),
        )
        previous, before = block, {joint: -1.0}
    _add_foot(model, where)


def _slider(model: LegModel, number: int, x: float) -> Any:
    """Add a box that slides along the chain with the cells up to this one; walls stop it."""
    robot, leg, name = model.robot, model.leg, f"{model.cell_name(number)}.block"
    travel = sum(cell.full_travel for cell in leg.chain.cells[: number + 1])
    slider = model.body.add_body(name=name, pos=(x, leg.at[1], 0.0))
    soft = parts.soft(model.settings)
    rail = {"solref_friction": soft, "solimp_friction": parts.STIFF}
    rail["frictionloss"] = robot.blocks.rail_friction
    parts.slider(slider, name, (-1.0, 0.0, 0.0), ref=travel / 2, **rail)
    size, mass = (robot.blocks.length, robot.blocks.width, 0.008), robot.blocks.mass / 2
    parts.hull(robot, slider, size, mass=mass, rgba=parts.BLOCK, **parts.BLOCKS)
    return slider


def _add_line(model: LegModel, name: str, ends: tuple[str, str], rgba: parts.Colour) -> None:
    """Add a lever or link of rods; on hinges, a line whose length checks the linkage."""
    if model.hinged:
        parts.between(model.spec, name, ends, rgba=parts.HIDDEN)
    else:
        parts.between(model.spec, name, ends, width=0.0016, rgba=rgba)
        parts.fixed_length(model.spec, name, model.settings)


def _add_bands(model: LegModel, number: int, inner: Place, outer: Place) -> None:
    """Add the bands of a cell, counted from inside, between the lever joints of its blocks."""
    leg, name, cell = model.leg, model.cell_name(number), model.leg.chain.levers[number]
    for j, band in enumerate(cell.bands):
        label = f"{name}.band" if len(cell.bands) == 1 else f"{name}.band{j + 1}"
        ends = {"p": (inner, band.p), "q": (outer, band.q)}
        for end, ((body, joint), anchor) in ends.items():
            if end == "p" and j == 0 and number in model.anchors:
                parts.site(model.anchors[number], f"{label}.p")
            else:
                x, y, _ = in_body(sides(model.robot, leg)[number], anchor)
                parts.site(body, f"{label}.{end}", (joint[0] + x, joint[1] + y, joint[2]))
        sites = (f"{label}.p", f"{label}.q")
        law, colour = parts.stretch(band), parts.BANDS[number % len(parts.BANDS)]
        parts.between(model.spec, label, sites, width=0.0012, rgba=colour, **law)


def _add_foot(model: LegModel, where: Places) -> None:
    """Add the V and its foot, which is free in the plane of the leg."""
    robot, leg, name = model.robot, model.leg, model.leg.name
    x, z = where.foot
    # The V hangs from sliders, which have a block's travel but not its sideways swing.
    middle = model.spec.body(f"{model.cell_name(-2)}.block")
    tip = model.body.add_body(name=f"{name}.foot", pos=(x, leg.at[1], z))
    parts.slider(tip, f"{name}.foot.x", (1.0, 0.0, 0.0))
    parts.slider(tip, f"{name}.foot.z", (0.0, 0.0, 1.0))
    parts.site(tip, f"{name}.tip")
    foot, links = robot.foot, 2 * LINK * robot.foot.mass if model.hinged else 0.0
    parts.stand(
        tip,
        (f"{name}.foot", f"{name}.sole"),
        foot.radius,
        (0.0, 0.0, foot.radius),
        model.settings,
        friction=(robot.floor.foot_friction, 0.0, 0.0),
        mass=foot.mass - links,
        rgba=parts.FOOT,
        **parts.FEET,
    )
    pivots = {
        "in": (middle, (0.0, 0.0, 0.0), where.blocks[-2]),
        "out": (model.carriage, (where.blocks[-1], leg.at[1], 0.0), where.blocks[-1]),
    }
    for end, (holder, at, pivot) in pivots.items():
        if model.hinged:
            add_link(model, end, (holder, at), (x - pivot, 0.0, z))
        parts.site(holder, f"{name}.pivot.{end}", at)
        _add_line(model, f"{name}.link.{end}", (f"{name}.pivot.{end}", f"{name}.tip"), parts.LINK)


def hinge_angles(robot: Robot, leg: Leg) -> dict[str, float]:
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


def add_levers(model: LegModel, number: int, inner: Any, outer: Any) -> None:
    """Add two parallel levers from block to block, whose hinges have the stops."""
    name, cell = model.cell_name(number), model.leg.chain.levers[number]
    side = sides(model.robot, model.leg)[number]
    tip = (0.0, side * cell.lever, 0.0)
    for end, (near, far) in lever_pins(model.robot, model.leg, number).items():
        label = f"{name}.lever.{end}"
        lever = inner.add_body(name=label, pos=near)
        stops = {"limited": True, "range": (-cell.limit, cell.limit), "solimp_limit": STIFF}
        soft = parts.soft(model.settings)
        parts.hinge(lever, label, (0.0, 0.0, side), solref_limit=soft, **stops)
        mass = LEVER * model.robot.blocks.mass
        parts.rod(lever, (0, 0, 0), tip, THICK, mass=mass, rgba=parts.LEVER, **parts.SEEN)
        parts.site(lever, f"{label}.tip", tip)
        parts.site(outer, f"{label}.pin", far)
        _pin(model, label, f"{label}.pin")


def add_link(model: LegModel, end: str, pivot: Place, tip: Vec3) -> None:
    """Add a link of the V, from a pivot down to the foot's tip."""
    label, mass = f"{model.leg.name}.link.{end}", LINK * model.robot.foot.mass
    link = pivot[0].add_body(name=label, pos=pivot[1])
    parts.hinge(link, label, (0.0, 1.0, 0.0))
    parts.rod(link, (0, 0, 0), tip, THICK, mass=mass, rgba=parts.LINK, **parts.SEEN)
    parts.site(link, f"{label}.tip", tip)
    _pin(model, label, f"{model.leg.name}.tip")


def _pin(model: LegModel, name: str, site: str) -> None:
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
