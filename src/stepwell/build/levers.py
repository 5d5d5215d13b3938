"""Levers of the cells, and the plates with arc slots that stop a cell at other angles."""

import math
from collections.abc import Iterator, Sequence

from stepwell.build.build_file import BuildFile, mm
from stepwell.build.contour import Contour
from stepwell.build.part import Hole, Part
from stepwell.build.plates import Fastener, screw_places
from stepwell.build.seats import BlockPlan, CellPlan
from stepwell.build.stack import Stack, pin_length_below


def lever_parts(cell: CellPlan, build_file: BuildFile, stack: Stack) -> Iterator[Part]:
    """The two levers of a cell: x from the inner to the outer joint."""
    hole = build_file.pin.diameter + build_file.pin.lever_fit
    r, number = cell.cell.lever, cell.number + 1
    for letter in "ab":
        yield Part(
            name=f"lever-{number}{letter}",
            material=build_file.sheet.material,
            thickness=build_file.sheet.thickness,
            outline=Contour.slot((0.0, 0.0), (r, 0.0), build_file.lever.width),
            holes=(Hole((0.0, 0.0), hole, "inner"), Hole((r, 0.0), hole, "outer")),
            mark=f"{number}",
            layer=stack.layer(stack.middle),
            base=stack.middle,
        )


def slot_limit(cell: CellPlan, build_file: BuildFile) -> float:
    """Angle [rad] of the centre of a slot's round end: the pin touches it at θc."""
    return cell.cell.limit - build_file.pin.lever_fit / (2.0 * cell.cell.lever)


def stop_plate(
    cell: CellPlan, block: BlockPlan, offset: float, build_file: BuildFile, stack: Stack
) -> Part:
    """The plate under the inner block of a cell, with the slot for a pin of the outer block."""
    assert stack.stop is not None
    r, edge = cell.cell.lever, build_file.block.edge
    width = build_file.pin.diameter + build_file.pin.lever_fit
    out, near, far = cell.half, block.back + edge, -(r + width / 2.0 + edge)
    corners = [(-out, far), (out, far), (out, near), (-out, near)]
    toward = -block.side * math.pi / 2.0
    end = slot_limit(cell, build_file)
    centre = block.at((0.0, 0.0), offset)
    return Part(
        name=f"stop-{cell.number + 1}",
        material=build_file.sheet.material,
        thickness=build_file.sheet.thickness,
        outline=Contour.rounded(
            [block.at(corner, offset) for corner in corners], build_file.sheet.corner
        ),
        holes=tuple(
            Hole(block.at(place, offset), build_file.screw.hole, f"p-s{index + 1}", "screw")
            for index, place in enumerate(screw_places(cell, block, build_file))
        ),
        cutouts=(Contour.arc_slot(centre, r, toward - end, toward + end, width),),
        mark=f"{cell.number + 1}X",
        layer=stack.layer(stack.stop),
        base=stack.stop,
    )


def stop_pins(
    blocks: Sequence[BlockPlan], build_file: BuildFile, stack: Stack
) -> Iterator[Fastener]:
    """The pins that run in the arc slots: in the bottom plates, flush with their upper faces."""
    if stack.stop is None:
        return
    pin = build_file.pin.diameter
    high = stack.bottom + stack.thickness
    length = pin_length_below(high - stack.stop)
    for block in blocks:
        for cell, role, offset in block.seats:
            if cell.slotted and role == "q":
                yield Fastener(
                    "stop",
                    "pin",
                    f"ISO 8734 {mm(pin)} x {mm(length)}",
                    pin,
                    block.number,
                    block.at((0.0, 0.0), offset),
                    high - length,
                    high,
                )
