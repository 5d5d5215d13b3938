"""The layout of a build: all parts, fasteners and bands of a chain, and where each is."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from stepwell.base import ByValue, Floats, InputError, Vec2, require
from stepwell.build import seats
from stepwell.build.build_file import BuildFile, mm
from stepwell.build.drive import drive_bar, drive_pin, drive_place
from stepwell.build.levers import lever_parts, stop_pins, stop_plate
from stepwell.build.part import Part
from stepwell.build.plates import Fastener, block_fasteners, block_parts, foot_parts
from stepwell.build.seats import INNER, BlockPlan, CellPlan
from stepwell.build.stack import Stack, stack_of
from stepwell.mechanism import Chain


@dataclass(frozen=True, slots=True, eq=False)
class BandPath(ByValue):
    """A stretched band between its hooks.

    Attributes:
        cell, number: of the cell and of the band in it, from 0.
        p, q: anchors in the frames of the inner and of the outer block, in plan [m].
        low, high: its z [m].
        width: of the loop around a hook, in plan [m].
        shift: the vector added to p and q in the frame of the cell [m].
        holes: names of the holes of both hooks.
    """

    cell: int
    number: int
    p: Vec2
    q: Vec2
    low: float
    high: float
    width: float
    shift: Vec2
    holes: tuple[str, str]


@dataclass(frozen=True, eq=False, repr=False)
class Layout(ByValue):
    """The parts of a chain in layers, and their places at any angles of its levers.

    The plan has x along the stroke and y across it, from the fixed block's pair of joints; z is up
    from the lowest sheet. Even blocks lie in one row, odd ones in the other.

    Attributes:
        chain, build_file: what it is made of.
        parts: flat parts, layer by layer from below.
        fasteners: bought parts: pins, hooks, screws, nuts, shims.
        bands: the bands, cell by cell.
        body: the rigid body of each part: ("block", i), ("lever", i, 0 or 1) or ("bar",).
    """

    chain: Chain
    build_file: BuildFile
    parts: tuple[Part, ...]
    fasteners: tuple[Fastener, ...]
    bands: tuple[BandPath, ...]
    cells: tuple[CellPlan, ...] = field(hash=False, compare=False)
    blocks: tuple[BlockPlan, ...] = field(hash=False, compare=False)
    stack: Stack
    body: dict[str, tuple[str | int, ...]] = field(hash=False)

    def __repr__(self):
        return (
            f"Layout({len(self.parts)} parts of {mm(self.stack.thickness)} mm, "
            f"{len(self.fasteners)} fasteners, {len(self.bands)} bands)"
        )

    def part(self, name: str) -> Part:
        """The part of this name; ValueError if there is none."""
        for one in self.parts:
            if one.name == name:
                return one
        raise InputError(f"{name}: no such part. Known: {', '.join(p.name for p in self.parts)}.")

    def angles(self, state: str) -> list[float]:
        """Angles of all cells [rad] in a state such as "01"."""
        if len(state) != len(self.cells) or set(state) - {"0", "1"}:
            raise InputError(
                f"state = {state!r}: must have 0 or 1 for each of {len(self.cells)} cells."
            )
        return [
            one.cell.limit * (1.0 if digit == "1" else -1.0)
            for one, digit in zip(self.cells, state, strict=True)
        ]

    def positions(self, angles: Sequence[float] | Floats) -> Floats:
        """(..., N + 1, 2) places of all blocks' frames [m] at angles (..., N) [rad]."""
        theta = np.asarray(angles, float)
        steps = np.zeros((*theta.shape[:-1], len(self.blocks), 2))
        for i, (one, offset) in enumerate(zip(self.cells, seats.offsets(self.blocks), strict=True)):
            steps[..., i + 1, 0] = offset + one.cell.lever * np.sin(theta[..., i])
            steps[..., i + 1, 1] = one.side * one.cell.lever * np.cos(theta[..., i])
        return np.cumsum(steps, axis=-2)

    def frames(self, angles: Sequence[float] | Floats) -> dict[str, tuple[float, float, float]]:
        """(x, y, angle) [m, m, rad] of every part at angles θ (N,) [rad] of all cells."""
        at = self.positions(angles)
        places = {name: self.frame(body, at, angles) for name, body in self.body.items()}
        return {part.name: places[part.name] for part in self.parts}

    def frame(
        self, body: tuple[str | int, ...], at: Floats, angles: Sequence[float] | Floats
    ) -> tuple[float, float, float]:
        """(x, y, angle) of a rigid body, with `at` as of `positions`."""
        kind = body[0]
        if kind == "block":
            x, y = at[int(body[1])]
            return float(x), float(y), 0.0
        if kind == "lever":
            cell = self.cells[int(body[1])]
            half = self.build_file.lever.spacing / 2.0
            offset = self.blocks[cell.number].seats[-1][2]
            x, y = at[cell.number] + (offset + (half if body[2] else -half), 0.0)
            theta = float(angles[cell.number])
            return float(x), float(y), math.atan2(cell.side * math.cos(theta), math.sin(theta))
        x, _ = at[-1]
        return float(x) + drive_place(self.cells, self.build_file)[0], self.bar_y, 0.0

    @property
    def bar_y(self) -> float:
        """y of the drive bar's frame [m], the same at all angles."""
        low, high = seats.ranges(self.cells)
        block = self.blocks[-1]
        return (low + high) / 2.0 + block.side * drive_place(self.cells, self.build_file)[1]


def layout(chain: Chain, build_file: BuildFile) -> Layout:
    """All parts of a chain of lever cells.

    Raises:
        ValueError: an element, too many cells (docs/limits.md), or levers too short for any plate.
    """
    require("built_cells", len(chain), "the chain has")
    cells, blocks = seats.plans(chain, build_file)
    slots = any(one.slotted for one in cells)
    stack = stack_of(build_file, slots=slots)
    levels = _levels(cells, build_file, stack)
    parts: list[Part] = []
    body: dict[str, tuple[str | int, ...]] = {}
    fasteners: list[Fastener] = []
    last = len(blocks) - 1

    def take(made: Iterator[Part] | list[Part], owner: tuple[str | int, ...]) -> None:
        for part in made:
            parts.append(part)
            body[part.name] = owner

    for block in blocks:
        owner = ("block", block.number)
        drive = drive_place(cells, build_file) if block.number == last else None
        take(block_parts(block, build_file, stack, drive), owner)
        fasteners += block_fasteners(block, build_file, stack, levels)
        for cell, role, offset in block.seats:
            if role == INNER and cell.slotted:
                take([stop_plate(cell, block, offset, build_file, stack)], owner)
            elif slots:
                take(foot_parts(block, cell, role, offset, build_file, stack), owner)
    for cell in cells:
        for index, part in enumerate(lever_parts(cell, build_file, stack)):
            take([part], ("lever", cell.number, index))
    fasteners += stop_pins(blocks, build_file, stack)
    take([drive_bar(cells, blocks[-1], build_file, stack)], ("bar",))
    fasteners.append(drive_pin(cells, blocks[-1], build_file, stack))
    parts.sort(key=lambda part: part.layer)
    bands = tuple(_band_paths(cells, blocks, build_file, levels))
    return Layout(
        chain, build_file, tuple(parts), tuple(fasteners), bands, cells, blocks, stack, body
    )


def _levels(
    cells: tuple[CellPlan, ...], build_file: BuildFile, stack: Stack
) -> list[tuple[float, float, float]]:
    """Lower and upper face of the bands of each level, and the top of their hooks, z [m]."""
    from stepwell.build.stack import pin_length

    levels: list[tuple[float, float, float]] = []
    low = stack.bands
    for _ in range(max(len(one.bands) for one in cells)):
        high = low + build_file.band.width
        top = stack.top + pin_length(high + build_file.hook.cap - stack.top)
        levels.append((low, high, top))
        low = top + build_file.hook.clearance
    return levels


def _band_paths(
    cells: tuple[CellPlan, ...],
    blocks: tuple[BlockPlan, ...],
    build_file: BuildFile,
    levels: list[tuple[float, float, float]],
) -> Iterator[BandPath]:
    from stepwell.build.plates import hook_names

    width = build_file.hook.diameter + 2.0 * build_file.band.thickness
    for cell in cells:
        inner, outer = blocks[cell.number], blocks[cell.number + 1]
        names = {role: hook_names(cell, role, build_file) for role in "pq"}
        for band in cell.bands:
            low, high, _ = levels[band.level]
            yield BandPath(
                cell=cell.number,
                number=band.number,
                p=inner.at(band.inner, inner.seats[-1][2]),
                q=outer.at(band.outer, 0.0),
                low=low,
                high=high,
                width=width,
                shift=band.shift,
                holes=(names["p"][band.inner], names["q"][band.outer]),
            )
