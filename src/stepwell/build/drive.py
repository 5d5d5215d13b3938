"""The drive end: a bar with a transverse slot, since the last block swings across the stroke."""

from collections.abc import Sequence

from stepwell.base import Vec2
from stepwell.build.build_file import BuildFile, mm
from stepwell.build.contour import Contour
from stepwell.build.part import Hole, Part
from stepwell.build.plates import Fastener
from stepwell.build.seats import BlockPlan, CellPlan, ranges
from stepwell.build.stack import Stack, pin_length


def drive_place(cells: Sequence[CellPlan], build_file: BuildFile) -> Vec2:
    """The drive pin on the last block, as a place of its seat [m].

    The bar begins behind the reach of the block before it, so that it may swing over both rows.
    """
    last = cells[-1]
    reach = last.half + last.cell.full_travel / 2.0 + build_file.block.clearance
    return (
        reach + build_file.block.edge + build_file.pin.diameter / 2.0,
        (last.back + build_file.block.edge - last.front) / 2.0,
    )


def slot_reach(cells: Sequence[CellPlan]) -> float:
    """How far the drive pin moves along the slot [m], over all angles of all cells."""
    low, high = ranges(tuple(cells))
    return high - low


def drive_bar(
    cells: Sequence[CellPlan], block: BlockPlan, build_file: BuildFile, stack: Stack
) -> Part:
    """The bar between the plates of the last block; its frame is in the middle of the slot."""
    edge = build_file.block.edge
    width = build_file.pin.diameter + build_file.pin.lever_fit
    reach = slot_reach(cells)
    half = (reach + width) / 2.0 + edge
    left = -(width / 2.0 + edge) + build_file.pin.lever_fit / 2.0
    # Its far end stands out of the plates, with the hole for the actuator.
    hole_x = build_file.pin.diameter / 2.0 + 2.0 * edge + build_file.screw.hole / 2.0
    right = hole_x + build_file.screw.hole / 2.0 + edge
    corners = [(left, -half), (right, -half), (right, half), (left, half)]
    return Part(
        name="drive-bar",
        material=build_file.sheet.material,
        thickness=build_file.sheet.thickness,
        outline=Contour.rounded(corners, build_file.sheet.corner),
        holes=(Hole((hole_x, 0.0), build_file.screw.hole, "actuator", "screw"),),
        cutouts=(Contour.slot((0.0, -reach / 2.0), (0.0, reach / 2.0), width),),
        mark="D",
        layer=stack.layer(stack.middle),
        base=stack.middle,
    )


def drive_pin(
    cells: Sequence[CellPlan], block: BlockPlan, build_file: BuildFile, stack: Stack
) -> Fastener:
    """The pin of the last block in the slot of the bar."""
    pin = build_file.pin.diameter
    length = pin_length(stack.roof - stack.bottom)
    return Fastener(
        "drive",
        "pin",
        f"ISO 8734 {mm(pin)} x {mm(length)}",
        pin,
        block.number,
        block.at(drive_place(cells, build_file), 0.0),
        stack.bottom,
        stack.bottom + length,
    )
