"""Sizes of the blocks: where the joints of all cells are and how far the plates reach."""

import math
from dataclasses import dataclass, field
from itertools import pairwise

from stepwell.base import InputError, Vec2
from stepwell.build import hooks
from stepwell.build.build_file import BuildFile, mm
from stepwell.build.hooks import HookedBand
from stepwell.mechanism import Cell, Chain

INNER, OUTER = "p", "q"


@dataclass(frozen=True, slots=True)
class CellPlan:
    """The sizes of one cell in plan [m].

    Attributes:
        cell: the unit cell; `number` is its place from 0, the innermost.
        side: direction across the stroke from the inner to the outer block, 1 or -1.
        slotted: whether an arc slot stops it, and not the faces of its blocks.
        front: from the joints to the edge that faces the other block.
        half: from the midpoint of the joints to the ends of the plates along the stroke.
        back: from the joints to the row of screws.
        bands: the hooks of its bands.
    """

    cell: Cell
    number: int
    side: float
    slotted: bool
    front: float
    half: float
    back: float
    bands: tuple[HookedBand, ...] = field(repr=False)

    @property
    def hooks(self) -> dict[str, tuple[Vec2, ...]]:
        """Places of the hooks on either seat, each once."""
        inner = tuple(dict.fromkeys(band.inner for band in self.bands))
        outer = tuple(dict.fromkeys(band.outer for band in self.bands))
        return {INNER: inner, OUTER: outer}


@dataclass(frozen=True, slots=True)
class BlockPlan:
    """The pairs of joints of one block, in the block's frame: x along the stroke, y across.

    Attributes:
        number: place in the chain, 0 for the fixed block.
        side: direction of y away from the other row, 1 or -1.
        seats: for each pair of joints its cell, "p" or "q", and x of its midpoint [m].
    """

    number: int
    side: float
    seats: tuple[tuple[CellPlan, str, float], ...]

    def at(self, place: Vec2, offset: float) -> Vec2:
        """A place of a seat in the frame of the block [m]."""
        return offset + place[0], self.side * place[1]

    @property
    def back(self) -> float:
        """From the joints to the row of screws [m]."""
        return max(cell.back for cell, _, _ in self.seats)


def plans(
    chain: Chain, build_file: BuildFile
) -> tuple[tuple[CellPlan, ...], tuple[BlockPlan, ...]]:
    """The plans of all cells and of all blocks, inner first.

    Raises:
        ValueError: the chain has an element, or a lever so short that no plate has an edge between
            the joints and the other block.
    """
    cells = tuple(_cell_plan(cell, i, build_file) for i, cell in enumerate(chain.levers))
    blocks = [BlockPlan(0, -1.0, ((cells[0], INNER, 0.0),))]
    for i, cell in enumerate(cells):
        seats = [(cell, OUTER, 0.0)]
        if i + 1 < len(cells):
            seats.append((cells[i + 1], INNER, span(cell, cells[i + 1], build_file)))
        blocks.append(BlockPlan(i + 1, cell.side, tuple(seats)))
    return cells, tuple(blocks)


def span(inner: CellPlan, outer: CellPlan, build_file: BuildFile) -> float:
    """From one pair of joints of a middle block to the other [m]: blocks of a row never meet."""
    travels = (inner.cell.full_travel + outer.cell.full_travel) / 2.0
    return travels + inner.half + outer.half + build_file.block.clearance


def _cell_plan(cell: Cell, number: int, build_file: BuildFile) -> CellPlan:
    stop, edge, grid = build_file.stop, build_file.block.edge, build_file.grid
    slotted = not stop.faces_from - 1e-9 <= cell.limit <= stop.faces_to + 1e-9
    least = cell.lever * math.cos(cell.limit) / 2.0
    front = least - stop.gap / 2.0 if slotted else least
    if front <= 0.0:
        name = cell.name or f"cell {number + 1}"
        raise InputError(
            f"{name}: lever {mm(cell.lever)} mm and limit {math.degrees(cell.limit):.4g} "
            f"degrees leave {mm(2.0 * least)} mm between the joints of its two blocks at the "
            f"stops, and stop.gap_mm is {mm(stop.gap)}: use a longer lever or a smaller θc."
        )
    if slotted:
        front = min(front, max(edge, build_file.lever.width / 2.0))
    at = hooks.seat(build_file, front)
    bands = tuple(hooks.place_bands(cell, build_file, (at, at)))
    along = [abs(place[0]) for one in bands for place in (one.inner, one.outer)]
    across = [place[1] for one in bands for place in (one.inner, one.outer)]
    reach = [grid.side, build_file.lever.spacing / 2.0, *along]
    back = max(grid.depth, *across) + edge
    if slotted:
        reach.append((cell.full_travel + build_file.pin.diameter) / 2.0)
        # The plate with the slot never reaches the feet of the outer block.
        plate = cell.lever - 2.0 * least + build_file.pin.diameter / 2.0 + edge
        back = max(back, plate + build_file.foot_radius + build_file.block.clearance)
    return CellPlan(
        cell=cell,
        number=number,
        side=-1.0 if number % 2 else 1.0,
        slotted=slotted,
        front=front,
        half=max(reach) + edge,
        back=back,
        bands=bands,
    )


def ranges(cells: tuple[CellPlan, ...]) -> tuple[float, float]:
    """Least and largest y [m] of the last block's frame over all angles of all cells."""
    near = [one.side * one.cell.lever * math.cos(one.cell.limit) for one in cells]
    far = [one.side * one.cell.lever for one in cells]
    pairs = list(zip(near, far, strict=True))
    return math.fsum(map(min, pairs)), math.fsum(map(max, pairs))


def offsets(blocks: tuple[BlockPlan, ...]) -> list[float]:
    """From the outer to the inner pair of joints of each middle block [m]."""
    return [block.seats[-1][2] for block, _ in pairwise(blocks)]
