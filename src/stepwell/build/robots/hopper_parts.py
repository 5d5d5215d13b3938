"""Frame, foot bar and sole of a hopper, and what its impacts ask of pins, levers and stops."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from stepwell.base import ByValue, Vec2
from stepwell.build.build_file import BuildFile
from stepwell.build.contour import Contour
from stepwell.build.layouts import Layout
from stepwell.build.limits import ExceededLimit, bed_findings, kerf_findings, webs_findings
from stepwell.build.part import Hole, Part
from stepwell.build.plates import STEEL
from stepwell.robot import Hopper, Impact, Task, bound_of, impacts, release

if TYPE_CHECKING:
    from stepwell.build.builds import Build

# Width of the sole across the way [m], and of a tab of the foot bar in it.
_SOLE, _TAB = 0.040, 0.015
_MARKS = {"frame-1": "H1", "frame-2": "H2", "foot-bar": "HB", "sole": "HS"}


@dataclass(frozen=True, slots=True, eq=False)
class ImpactLoad(ByValue):
    """An impact on one chain whose parts give way by 1 mm, as a pad does.

    Attributes:
        name: of the impact.
        energy: that the chain takes [J].
        force: mean force of the impact along the stroke [N].
        lever_force: in each of the two levers of the cell at its stop [N].
        bearing, web, pin: pressure of a pin on the holes of a lever, stress in the webs beside the
            hole, shear of the pin [Pa].
        face: pressure on the faces that stop the cell [Pa]; 0 for a slot.
        give: least way of the pad within the strengths of sheet and pin [m].
    """

    name: str
    energy: float
    force: float
    lever_force: float
    bearing: float
    web: float
    pin: float
    face: float
    give: float


@dataclass(frozen=True, slots=True, eq=False)
class HopperParts(ByValue):
    """The parts of a hopper besides its equal chains.

    Attributes:
        copies: number of chains to build, every second one mirrored.
        plates: two frame plates, the foot bar, and for a jump the sole.
        impacts: what each impact asks of one chain.
        body_mass, foot_mass: of the built parts and fasteners [kg].
        assumed_body_mass, assumed_foot_mass: of the hopper, with actuator and springs [kg].
    """

    copies: int
    plates: tuple[Part, ...]
    impacts: tuple[ImpactLoad, ...]
    body_mass: float
    foot_mass: float
    assumed_body_mass: float
    assumed_foot_mass: float

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader has to know, a sentence each."""
        return (
            f"Build {self.copies} of these chains, every second one turned over about the stroke; "
            f"the two frame plates between them join the inner blocks.",
            "The pins of the middle blocks run in the slots of the foot bar, which stands in the "
            "sole with its tabs, glued.",
            "Frame, foot bar and sole are not part of the sweep. Actuator, its mount, the rod "
            "between the drive bars, springs and pads are not built.",
        )


def hopper_parts(made: "Build", hopper: Hopper) -> HopperParts:
    """Plates, masses and impacts of a hopper whose chain is built."""
    plates = tuple(_plates(made.layout, hopper))
    density = made.build_file.sheet.density
    weights = [one.mass(density) for one in plates]
    blocks = _block_masses(made)
    foot = hopper.foot_after
    frame, rest = sum(weights[:2]), sum(weights[2:])
    return HopperParts(
        hopper.copies,
        plates,
        tuple(_impact_loads(made, hopper)),
        hopper.copies * (sum(blocks) - blocks[foot]) + frame,
        hopper.copies * blocks[foot] + rest,
        hopper.body_mass,
        hopper.foot_mass,
    )


class _Cut(NamedTuple):
    parts: tuple[Part, ...]
    build_file: BuildFile


def plate_findings(made: HopperParts, build_file: BuildFile) -> tuple[ExceededLimit, ...]:
    """Limits of material and machine that the plates exceed."""
    cut = _Cut(made.plates, build_file)
    return (*webs_findings(cut), *kerf_findings(cut), *bed_findings(cut))


def _block_masses(made: "Build") -> list[float]:
    """Mass of each block with its fasteners, and of half of the levers on either side [kg]."""
    masses, density = list(made.block_masses), made.build_file.sheet.density
    for one in made.layout.fasteners:
        if one.use != "cap":
            volume = math.pi / 4.0 * one.diameter**2 * (one.high - one.low)
            masses[int(one.block)] += STEEL * volume
    for part in made.layout.parts:
        kind, *number = made.layout.body[part.name]
        half = part.mass(density) / 2.0
        if kind == "lever":
            masses[int(number[0])] += half
            masses[int(number[0]) + 1] += half
        elif kind == "bar":
            masses[-1] += 2.0 * half
    return masses


def _plates(layout: Layout, hopper: Hopper) -> Iterator[Part]:
    """Frame plates, foot bar and sole, in the plan of the first chain; y = 0 is the mirror line.

    The chains lie back to back with the plates between them. The frame plates together leave the
    foot bar, between them, half a thickness on either side for the heads of screws.
    """
    build_file = layout.build_file
    sheet, edge = build_file.sheet, build_file.block.edge
    foot = hopper.foot_after
    # Pins of the foot along and across, at all angles of the cells before it.
    pins, reach = [*_pins(layout, foot)], _sideways(layout, foot)
    width = build_file.pin.diameter + build_file.pin.lever_fit
    middle = max(y for _, y in pins) + reach + width / 2.0 + edge
    yield from _frame_plates(layout, middle)
    slots = [
        Contour.slot((x, sign * (y - middle)), (x, sign * (y - middle - reach)), width)
        for sign in (1.0, -1.0)
        for x, y in pins
    ]
    wide = max(abs(y - middle - reach) for _, y in pins) + width / 2.0 + edge
    near = min(x for x, _ in pins) - width / 2.0 - edge
    end = _reach_of_drive(layout, foot) + edge
    slope = math.tan(hopper.tilt)
    tabs = _tabs(end, wide, sheet.thickness, slope)
    # Rails of twice the edge beside a window between slots and sole.
    begin, inner = max(x for x, _ in pins) + width / 2.0 + edge, wide - 2.0 * edge
    if (stop := end - slope * wide - 2.0 * edge) - begin > 2.0 * edge:
        slots.append(Contour.rounded(_box(begin, stop, inner), sheet.corner))
    yield _plate(build_file, "foot-bar", [(near, -wide), *tabs, (near, wide)], [], slots)
    if hopper.task is Task.JUMP:
        yield _plate(build_file, "sole", *_sole(hopper, wide, sheet.thickness))


def _frame_plates(layout: Layout, middle: float) -> Iterator[Part]:
    """Two plates that are screwed to the first block of both chains."""
    build_file = layout.build_file
    edge = build_file.block.edge
    x0, y0 = layout.positions(layout.angles("0" * len(layout.cells)))[0].tolist()
    first = layout.part("block-0-bottom")
    mounts = [hole.centre for hole in first.holes if hole.name.startswith("mount")]
    placed = [(x0 + x, y0 + y - middle) for x, y in mounts]
    far = max(abs(y) for _, y in placed) + edge
    left, right = (sign * edge + placed[0][0] for sign in (-1.0, 1.0))
    both = [(x, sign * y) for sign in (1.0, -1.0) for x, y in placed]
    holes = [Hole(at, build_file.screw.hole, f"m{k + 1}", "screw") for k, at in enumerate(both)]
    for k in (1, 2):
        yield _plate(build_file, f"frame-{k}", _box(left, right, far), holes, [])


def _plate(
    build_file: BuildFile, name: str, corners: list[Vec2], holes: list[Hole], cutouts: list[Contour]
) -> Part:
    sheet = build_file.sheet
    outline = Contour.rounded(corners, 0.0 if name == "foot-bar" else sheet.corner)
    openings = tuple(holes), tuple(cutouts)
    return Part(name, sheet.material, sheet.thickness, outline, *openings, _MARKS[name])


def _box(left: float, right: float, high: float) -> list[Vec2]:
    return [(left, -high), (right, -high), (right, high), (left, high)]


def _pins(layout: Layout, foot: int) -> Iterator[Vec2]:
    """Places of the pins of the foot's joints with the next cell, all cells at 0 [m].

    These are farther from the body than its other pins, so that the bar does not reach the frame.
    """
    at = layout.positions(layout.angles("0" * len(layout.cells)))[foot]
    names = [f"{foot + 1}{letter}" for letter in "ab"]
    for hole in layout.part(f"block-{foot}-bottom").holes:
        if hole.name in names:
            yield float(at[0]) + hole.centre[0], float(at[1]) + hole.centre[1]


def _sideways(layout: Layout, foot: int) -> float:
    """How far the foot moves across the stroke [m]."""
    cells = layout.cells[:foot]
    return sum(one.cell.lever * (1.0 - math.cos(one.cell.limit)) for one in cells)


def _reach_of_drive(layout: Layout, foot: int) -> float:
    """Largest x of the last block and its drive bar, with the foot at its place [m]."""
    far = layout.angles("0" * foot + "1" * (len(layout.cells) - foot))
    bar = layout.part("drive-bar")
    at = layout.frame(layout.body[bar.name], layout.positions(far), far)
    return at[0] + bar.outline.bounds[2]


def _tabs(end: float, wide: float, thick: float, slope: float) -> list[Vec2]:
    """The end of the foot bar with two tabs through the sole, square to a sole at a slope."""

    def at(y: float, out: float) -> Vec2:
        return end + out - slope * y, y

    half = _TAB / 2.0
    corners = [at(-wide, 0.0)]
    for middle in (-wide / 2.0, wide / 2.0):
        corners += [at(middle - half, 0.0), at(middle - half, thick)]
        corners += [at(middle + half, thick), at(middle + half, 0.0)]
    return [*corners, at(wide, 0.0)]


def _sole(
    hopper: Hopper, wide: float, thick: float
) -> tuple[list[Vec2], list[Hole], list[Contour]]:
    """The sole with its holes for the tabs; x is along the way."""
    # A tab passes a tilted sole at a slant.
    length = hopper.foot_length / 2.0
    half = (_TAB + thick * math.sin(hopper.tilt)) / 2.0 / math.cos(hopper.tilt)
    places = [sign * wide / 2.0 / math.cos(hopper.tilt) for sign in (-1.0, 1.0)]
    boxes = [Contour.of([(at + x, y) for x, y in _box(-half, half, thick / 2.0)]) for at in places]
    return _box(-length, length, _SOLE / 2.0), [], boxes


def _impact_loads(made: "Build", hopper: Hopper) -> Iterator[ImpactLoad]:
    """Each impact, shared equally by all chains and by the two levers of a cell."""
    snap = release(hopper.whole, hopper.foot_after, hopper.load)
    if snap is None:
        return
    for impact in impacts(hopper, bound_of(hopper, snap)):
        yield _load(made, Impact(impact.name, impact.energy / hopper.copies))


def _load(made: "Build", impact: Impact) -> ImpactLoad:
    build_file, plan = made.build_file, made.layout.cells[0]
    thick, pin = build_file.sheet.thickness, build_file.pin.diameter
    force, limit = impact.mean_force, plan.cell.limit
    # Two levers at ±θc and faces across the stroke balance a force along it.
    lever = force / (2.0 * math.sin(limit))
    overlap = 2.0 * plan.half - plan.cell.full_travel / 2.0
    face = 0.0 if plan.slotted else force / math.tan(limit) / (2.0 * thick * overlap)
    bearing = lever / (pin * thick)
    web = lever / ((build_file.lever.width - pin - build_file.pin.lever_fit) * thick)
    shear = lever / (math.pi / 2.0 * pin**2)
    of_sheet = max(bearing, web, face) / build_file.sheet.strength
    # The mean force is inverse to the way.
    way = impact.energy / force if force else 0.0
    give = way * max(of_sheet, shear / build_file.pin.strength)
    stresses = bearing, web, shear, face, give
    return ImpactLoad(impact.name, impact.energy, force, lever, *stresses)
