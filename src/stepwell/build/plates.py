"""Plates and spacers of the blocks with all their holes, and the fasteners in them."""

import math
import string
from collections.abc import Iterator
from dataclasses import dataclass

from stepwell.base import ByValue, Vec2
from stepwell.build.build_file import BuildFile, mm
from stepwell.build.contour import Contour
from stepwell.build.hooks import SAME, on_grid
from stepwell.build.part import Hole, Part
from stepwell.build.seats import BlockPlan, CellPlan
from stepwell.build.stack import Stack, pin_length, screw_length

# Density of fasteners [kg/m³], steel.
STEEL = 7850.0


@dataclass(frozen=True, slots=True, eq=False)
class Fastener(ByValue):
    """A bought part that is round in plan.

    Attributes:
        name: unique in its block.
        use: "pin", "hook", "cap", "screw", "head", "nut" or "shim"; heads belong to screws.
        size: for a parts list, such as "ISO 8734 3 x 10".
        diameter: in plan [m].
        block: number of the block that carries it; of a robot the name of the body.
        centre: in the frame of the block [m]; of a robot in the frame of its body.
        low, high: its z [m].
        joint: cell and lever that turn on a joint's pin; None for all others.
        upright: whether it lies along y: `centre` is then (x, z), and `low`, `high` are y.
    """

    name: str
    use: str
    size: str
    diameter: float
    block: int | str
    centre: Vec2
    low: float
    high: float
    joint: tuple[int | str, int] | None = None
    upright: bool = False


Levels = list[tuple[float, float, float]]
BOTTOM, SPACER, TOP = "bottom", "spacer", "top"


def ends(block: BlockPlan, build_file: BuildFile) -> tuple[float, float]:
    """Least and largest x of the plates of a block without its drive end [m]."""
    first, _, begin = block.seats[0]
    last, _, end = block.seats[-1]
    mount = 2.0 * build_file.block.edge if block.number == 0 else 0.0
    return begin - first.half - mount, end + last.half


def block_parts(
    block: BlockPlan, build_file: BuildFile, stack: Stack, drive: Vec2 | None
) -> list[Part]:
    """Bottom plate, spacer and top plate; `drive` is the place of the drive pin, if it has one."""
    edge = build_file.block.edge
    left, right = ends(block, build_file)
    far = right if drive is None else drive[0] + build_file.pin.diameter / 2.0 + edge
    outline = _plate_outline(block, build_file, left, far)
    front = build_file.lever.width / 2.0 + build_file.lever.clearance
    back = block.back + edge
    spacer = [(left, front), (right, front), (right, back), (left, back)]
    clamps = [*_screw_holes(block, build_file), *_mount_holes(block, build_file)]
    joints = [*_joint_holes(block, build_file)]
    if drive is not None:
        hole = build_file.pin.diameter + build_file.pin.plate_fit
        joints.append(Hole(block.at(drive, 0.0), hole, "drive", "pin"))
    stops = [*_stop_holes(block, build_file)]
    grid = [*_hook_holes(block, build_file)]
    sheet = build_file.sheet

    def made(kind: str, base: float, contour: Contour, holes: list[Hole]) -> Part:
        return Part(
            name=f"block-{block.number}-{kind}",
            material=sheet.material,
            thickness=sheet.thickness,
            outline=contour,
            holes=tuple(holes),
            mark=f"{block.number}{kind[0].upper()}",
            layer=stack.layer(base),
            base=base,
        )

    # A hook on a joint is the joint's own pin: one hole.
    own = {hole.centre for hole in joints}
    upper = [one for one in grid if all(math.dist(one.centre, at) > SAME for at in own)]
    return [
        made(BOTTOM, stack.bottom, outline, [*joints, *clamps, *stops]),
        made(SPACER, stack.middle, _contour(block, spacer, build_file), clamps),
        made(TOP, stack.top, outline, [*joints, *clamps, *upper]),
    ]


def _plate_outline(block: BlockPlan, build_file: BuildFile, left: float, right: float) -> Contour:
    """A rectangle, with a step in front where the faces of the two cells differ."""
    back = block.back + build_file.block.edge
    first, last = block.seats[0][0], block.seats[-1][0]
    front = [(left, -first.front), (right, -last.front)]
    if abs(first.front - last.front) > 1e-7:
        # Halfway between the blocks of the other row where they come closest.
        at = first.half + first.cell.full_travel / 2.0 + build_file.block.clearance / 2.0
        front[1:1] = [(at, -first.front), (at, -last.front)]
    return _contour(block, [*front, (right, back), (left, back)], build_file)


def _contour(block: BlockPlan, corners: list[Vec2], build_file: BuildFile) -> Contour:
    at = [block.at(corner, 0.0) for corner in corners]
    radii = [
        build_file.sheet.corner if i in (0, *range(len(at) - 3, len(at))) else 0.0
        for i in range(len(at))
    ]
    return Contour.rounded(at, radii)


def _joint_holes(block: BlockPlan, build_file: BuildFile) -> Iterator[Hole]:
    diameter = build_file.pin.diameter + build_file.pin.plate_fit
    for cell, _, offset in block.seats:
        for index, place in enumerate(joint_places(build_file)):
            name = f"{cell.number + 1}{'ab'[index]}"
            yield Hole(block.at(place, offset), diameter, name, "pin")


def joint_places(build_file: BuildFile) -> tuple[Vec2, Vec2]:
    """The two joints of a seat [m]."""
    half = build_file.lever.spacing / 2.0
    return (-half, 0.0), (half, 0.0)


def screw_places(cell: CellPlan, block: BlockPlan, build_file: BuildFile) -> tuple[Vec2, Vec2]:
    """The two screws behind a seat [m]."""
    out = cell.half - build_file.block.edge
    return (-out, block.back), (out, block.back)


def _screw_holes(block: BlockPlan, build_file: BuildFile) -> Iterator[Hole]:
    for cell, role, offset in block.seats:
        for index, place in enumerate(screw_places(cell, block, build_file)):
            at = block.at(place, offset)
            yield Hole(at, build_file.screw.hole, f"{role}-s{index + 1}", "screw")


def _mount_holes(block: BlockPlan, build_file: BuildFile) -> Iterator[Hole]:
    if block.number:
        return
    edge = build_file.block.edge
    x = ends(block, build_file)[0] + edge
    near = build_file.lever.width / 2.0 + build_file.lever.clearance + edge
    for index, y in enumerate((near, block.back)):
        yield Hole(block.at((x, y), 0.0), build_file.screw.hole, f"mount{index + 1}", "screw")


def _stop_holes(block: BlockPlan, build_file: BuildFile) -> Iterator[Hole]:
    diameter = build_file.pin.diameter + build_file.pin.plate_fit
    for cell, role, offset in block.seats:
        if cell.slotted and role == "q":
            yield Hole(block.at((0.0, 0.0), offset), diameter, "stop", "pin")


def hook_names(cell: CellPlan, role: str, build_file: BuildFile) -> dict[Vec2, str]:
    """Names of the holes of all hooks of a seat: grid names, or X1, X2 off the grid."""
    names: dict[Vec2, str] = {}
    others = 0
    joints = joint_places(build_file)
    for place in cell.hooks[role]:
        beside = [index for index, at in enumerate(joints) if math.dist(at, place) < SAME]
        if beside:
            names[place] = f"{cell.number + 1}{'ab'[beside[0]]}"
            continue
        named = grid_name(place, build_file)
        if named is None:
            others += 1
            named = f"X{others}"
        names[place] = role + named
    return names


def grid_name(place: Vec2, build_file: BuildFile) -> str | None:
    """The name of a place of the grid: a letter along the stroke, a number across; else None."""
    grid = build_file.grid
    if not on_grid(place, grid.pitch):
        return None
    column = round(place[0] / grid.pitch) + _columns(build_file)
    row = round(place[1] / grid.pitch)
    if not (0 <= column <= 2 * _columns(build_file) and 0 <= row <= _rows(build_file)):
        return None
    letters = string.ascii_uppercase
    if column < len(letters):
        return f"{letters[column]}{row + 1}"
    return f"{letters[column // 26 - 1]}{letters[column % 26]}{row + 1}"


def _columns(build_file: BuildFile) -> int:
    return int(build_file.grid.side / build_file.grid.pitch + 1e-9)


def _rows(build_file: BuildFile) -> int:
    return int(build_file.grid.depth / build_file.grid.pitch + 1e-9)


def grid_places(build_file: BuildFile) -> list[Vec2]:
    """All places of the grid of a seat [m]."""
    pitch, columns = build_file.grid.pitch, _columns(build_file)
    return [
        (column * pitch, row * pitch)
        for row in range(_rows(build_file) + 1)
        for column in range(-columns, columns + 1)
    ]


def _hook_holes(block: BlockPlan, build_file: BuildFile) -> Iterator[Hole]:
    """Holes of the hooks, then of all other places of the grid that have room."""
    diameter = build_file.hook.diameter + build_file.pin.plate_fit
    pin = build_file.pin.diameter + build_file.pin.plate_fit
    bridge = build_file.sheet.bridge
    for cell, role, offset in block.seats:
        taken = [(at, pin) for at in joint_places(build_file)]
        for place, name in hook_names(cell, role, build_file).items():
            taken.append((place, diameter))
            if name[0] in "pq":
                yield Hole(block.at(place, offset), diameter, name, "hook")
        for place in grid_places(build_file):
            if (
                all(
                    math.dist(place, at) >= (diameter + other) / 2.0 + bridge - SAME
                    for at, other in taken
                )
                and place[1] >= -cell.front + diameter / 2.0 + bridge
            ):
                name = f"{role}{grid_name(place, build_file)}"
                yield Hole(block.at(place, offset), diameter, name, "grid")


def foot_parts(
    block: BlockPlan, cell: CellPlan, role: str, offset: float, build_file: BuildFile, stack: Stack
) -> Iterator[Part]:
    """Round feet under the screws of a seat, in the layer of the arc slots."""
    assert stack.stop is not None
    screw = build_file.screw
    for index, place in enumerate(screw_places(cell, block, build_file)):
        at = block.at(place, offset)
        yield Part(
            name=f"foot-{block.number}-{role}{index + 1}",
            material=build_file.sheet.material,
            thickness=build_file.sheet.thickness,
            outline=Contour.circle(at, build_file.foot_radius),
            holes=(Hole(at, screw.hole, "s1", "screw"),),
            mark="F",
            layer=stack.layer(stack.stop),
            base=stack.stop,
        )


def block_fasteners(
    block: BlockPlan, build_file: BuildFile, stack: Stack, levels: Levels
) -> list[Fastener]:
    """Pins, hooks, screws, nuts and shims of a block."""
    made: list[Fastener] = []
    for cell, role, offset in block.seats:
        tops = _hook_tops(cell, role, levels)
        made += _pins(block, (cell, role, offset), build_file, stack, tops)
        made += _hooks(block, (cell, role, offset), build_file, stack, tops)
        for index, place in enumerate(screw_places(cell, block, build_file)):
            at = block.at(place, offset)
            made += _clamp(f"{role}-s{index + 1}", block.number, at, build_file, stack)
    return made


def _hook_tops(cell: CellPlan, role: str, levels: Levels) -> dict[Vec2, float]:
    """z of the top of each hook of a seat [m], the highest of its bands."""
    tops: dict[Vec2, float] = {}
    for band in cell.bands:
        place = band.inner if role == "p" else band.outer
        tops[place] = max(tops.get(place, 0.0), levels[band.level][2])
    return tops


def _pins(
    block: BlockPlan,
    seat: tuple[CellPlan, str, float],
    build_file: BuildFile,
    stack: Stack,
    tops: dict[Vec2, float],
) -> Iterator[Fastener]:
    """Pins and shims of the joints of a seat; a hook on a joint is a longer pin."""
    cell, _, offset = seat
    pin = build_file.pin.diameter
    for index, place in enumerate(joint_places(build_file)):
        name, at = f"{cell.number + 1}{'ab'[index]}", block.at(place, offset)
        joint = (cell.number, index)
        hooked = [z for spot, z in tops.items() if math.dist(spot, place) < SAME]
        low, length = stack.bottom, pin_length(max([stack.roof, *hooked]) - stack.bottom)
        size = f"ISO 8734 {mm(pin)} x {mm(length)}"
        yield Fastener(name, "pin", size, pin, block.number, at, low, low + length, joint)
        if hooked:
            yield _cap(name, block.number, at, low + length, build_file)
        if stack.shim > 0.0:
            size = f"DIN 988 {mm(pin)} x {mm(2 * pin)} x {mm(stack.shim)}"
            for base in (stack.middle - stack.shim, stack.middle + stack.thickness):
                yield Fastener(
                    name, "shim", size, 2 * pin, block.number, at, base, base + stack.shim, joint
                )


def _hooks(
    block: BlockPlan,
    seat: tuple[CellPlan, str, float],
    build_file: BuildFile,
    stack: Stack,
    tops: dict[Vec2, float],
) -> Iterator[Fastener]:
    cell, role, offset = seat
    hook = build_file.hook.diameter
    for place, name in hook_names(cell, role, build_file).items():
        if name[0] not in "pq":
            continue
        length = tops[place] - stack.top
        size = f"ISO 8734 {mm(hook)} x {mm(length)}"
        at = block.at(place, offset)
        high = stack.top + length
        yield Fastener(name, "hook", size, hook, block.number, at, stack.top, high)
        yield _cap(name, block.number, at, high, build_file)


def _cap(name: str, block: int, at: Vec2, top: float, build_file: BuildFile) -> Fastener:
    """The piece of tube on a hook that keeps the band on it."""
    hook = build_file.hook
    size = f"tube {mm(hook.diameter)} x {mm(hook.cap_width)}, {mm(hook.cap)} long"
    return Fastener(name, "cap", size, hook.cap_width, block, at, top - hook.cap, top)


def _clamp(
    name: str, block: int, at: Vec2, build_file: BuildFile, stack: Stack
) -> Iterator[Fastener]:
    """A screw from below, its nut on the top plate, and a shim in each gap."""
    screw = build_file.screw
    low, length = stack.floor, screw_length(stack.roof - stack.floor + screw.nut)
    size = f"M{mm(screw.diameter)}"
    yield Fastener(
        name,
        "screw",
        f"ISO 7380-1 {size} x {mm(length)}",
        screw.diameter,
        block,
        at,
        low,
        low + length,
    )
    yield Fastener(name, "head", "", screw.head_width, block, at, low - screw.head, low)
    yield Fastener(
        name,
        "nut",
        f"ISO 4032 {size}",
        screw.nut_width,
        block,
        at,
        stack.roof,
        stack.roof + screw.nut,
    )
    gaps = [stack.bottom, stack.middle, stack.top]
    for base in gaps if stack.stop is not None else gaps[1:]:
        if stack.shim > 0.0:
            d = screw.diameter
            size = f"DIN 988 {mm(d)} x {mm(2 * d)} x {mm(stack.shim)}"
            yield Fastener(name, "shim", size, 2 * d, block, at, base - stack.shim, base)
