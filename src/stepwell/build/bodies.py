"""Rigid bodies of a chain for a sweep, and how far two of them can move apart."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import Floats
from stepwell.build import drive, seats
from stepwell.build.contour import Contour
from stepwell.build.layouts import BandPath, Layout
from stepwell.build.rigid import Freedom, Piece, RigidBody

if TYPE_CHECKING:
    from stepwell.build.sweeps import Collision


@dataclass(eq=False, kw_only=True)
class ChainBody(RigidBody):
    """A rigid body of a chain, or a band.

    Attributes:
        kind: "block", "lever", "band" or "bar".
        number: of the block, or of the cell.
        index: of the lever or the band in its cell.
    """

    kind: str
    number: int
    index: int = 0

    @property
    def key(self) -> tuple[str | int, ...]:
        """The body's name in `Layout.body`."""
        return (self.kind, self.number, self.index)[: {"block": 2, "lever": 3}.get(self.kind, 1)]


# The bar has a slot; blocks stand, levers and bands move.
_RANKS = {"bar": -1.0, "block": 0.0, "lever": 1e3, "band": 1e6}


def _body(kind: str, number: int, index: int = 0, **more: Any) -> ChainBody:
    names = {
        "block": f"block {number}",
        "bar": "drive-bar",
        "lever": f"lever-{number + 1}{'ab'[index % 2]}",
        "band": f"band {index + 1} of cell {number + 1}",
    }
    rank = _RANKS[kind] + (number if kind == "block" else 0.0)
    joints = frozenset([(number, index)] if kind == "lever" else [])
    return ChainBody(
        name=names[kind], kind=kind, number=number, index=index, rank=rank, joints=joints, **more
    )


def _hooks(path: BandPath) -> frozenset[str]:
    """Names of the pieces that hold a band."""
    ends = zip((path.cell, path.cell + 1), path.holes, strict=True)
    return frozenset(
        f"{use} {hole} of block {block}" for block, hole in ends for use in ("hook", "pin")
    )


def bodies_of(layout: Layout) -> list[ChainBody]:
    """All bodies of a layout: blocks, levers, bands, the bar. Round holes count as solid."""
    pieces: dict[tuple[str | int, ...], list[Piece]] = {}
    for part in layout.parts:
        one = Piece(part.name, part.outline, part.cutouts, part.base, part.top)
        pieces.setdefault(layout.body[part.name], []).append(one)
    # Shims of joints no wider than a lever, and than its length, have the room of the lever.
    widest = min([layout.build_file.lever.width, *(one.cell.lever for one in layout.cells)])
    for one in layout.fasteners:
        if one.use == "shim" and one.joint is not None and one.diameter <= widest:
            continue
        outline = Contour.circle(one.centre, one.diameter / 2.0)
        name = f"{one.use} {one.name} of block {one.block}"
        piece = Piece(name, outline, (), one.low, one.high, one.joint)
        pieces[("block", int(one.block))].append(piece)
    made = [
        _body(
            str(key[0]), *(int(one) for one in key[1:] or (len(layout.cells),)), pieces=tuple(own)
        )
        for key, own in pieces.items()
    ]
    bands = [
        _body("band", one.cell, one.number, path=one, hooks=_hooks(one)) for one in layout.bands
    ]
    return made + bands


@dataclass(frozen=True, slots=True, kw_only=True)
class ChainFreedom(Freedom):
    """What moves two bodies of a chain relative to each other.

    Attributes:
        cells: cells between the two bodies, or theirs.
        slides: whether the bar's place along its slot counts too; it is the last parameter.
    """

    cells: tuple[int, ...]
    slides: bool


def freedom(layout: Layout, a: ChainBody, b: ChainBody) -> ChainFreedom:
    """The parameters of two bodies. Levers turn around joints, blocks shift along arcs of radius r.

    Both motions are measured from a block between the bodies, so cells outside never count.
    """
    reach: dict[int, float] = {}
    first, second = sorted((a, b), key=_order)
    half = layout.build_file.lever.width / 2.0

    def add(cell: int, amount: float) -> None:
        reach[cell] = reach.get(cell, 0.0) + amount

    def own(body: ChainBody) -> None:
        if body.kind in ("lever", "band"):
            more = half if body.kind == "lever" else 0.0
            add(body.number, layout.cells[body.number].cell.lever + more)

    own(first)
    own(second)
    inside = first.kind in ("lever", "band") and _order(second) >= first.number + 1
    start = first.number + 1 if inside else first.number
    for cell in range(start, second.number):
        add(cell, layout.cells[cell].cell.lever)
    slides = second.kind == "bar"
    cells = tuple(sorted(reach))
    limits = [layout.cells[cell].cell.limit for cell in cells]
    scale = [reach[cell] for cell in cells]
    if slides:
        limits.append(drive.slot_reach(layout.cells) / 2.0)
        scale.append(1.0)
    return ChainFreedom(
        np.array(scale), -np.array(limits), np.array(limits), cells=cells, slides=slides
    )


def _order(body: ChainBody) -> float:
    """Place in the chain: blocks at whole numbers, levers and bands between, the bar last."""
    return body.number + (0.5 if body.kind in ("lever", "band") else 0.0) + (body.kind == "bar") / 4


class Poses:
    """Places of bodies at many sets of parameters; cells that do not count stand at angle 0."""

    def __init__(self, layout: Layout, freedom: ChainFreedom, parameters: Floats):
        self.layout = layout
        self.angles = np.zeros((len(parameters), len(layout.cells)))
        self.angles[:, freedom.cells] = parameters[:, : len(freedom.cells)]
        self.slide = parameters[:, -1] if freedom.slides else np.zeros(len(parameters))
        self.at = layout.positions(self.angles)

    def of(self, body: ChainBody) -> tuple[Floats, Floats]:
        """(n, 2) places [m] and (n,) angles [rad] of a body's frame."""
        number, layout = body.number, self.layout
        turned = np.zeros(len(self.angles))
        if body.kind == "block":
            return self.at[:, number], turned
        if body.kind == "bar":
            block = layout.blocks[-1]
            x, y = block.at(drive.drive_place(layout.cells, layout.build_file), 0.0)
            return self.at[:, -1] + np.column_stack([turned + x, y + self.slide]), turned
        cell = layout.cells[number]
        half = layout.build_file.lever.spacing / 2.0
        offset = seats.offsets(layout.blocks)[number] + (half if body.index else -half)
        theta = self.angles[:, number]
        angle = np.arctan2(cell.side * np.cos(theta), np.sin(theta))
        return self.at[:, number] + (offset, 0.0), angle

    def line(self, body: ChainBody) -> Floats:
        """(n, 2, 2) ends of a band [m]."""
        path = body.path
        assert isinstance(path, BandPath)
        cell = path.cell
        return np.stack([self.at[:, cell] + path.p, self.at[:, cell + 1] + path.q], axis=1)


@dataclass(frozen=True)
class SweptChain:
    """The bodies of a layout for a sweep over the angles of all cells."""

    layout: Layout

    def bodies(self) -> list[ChainBody]:
        """All blocks, levers, bands and the bar."""
        return bodies_of(self.layout)

    def freedom(self, a: ChainBody, b: ChainBody) -> ChainFreedom:
        """The parameters of two bodies."""
        return freedom(self.layout, a, b)

    def poses(self, moves: ChainFreedom, parameters: Floats) -> Poses:
        """Places of all bodies at parameters (n, k)."""
        return Poses(self.layout, moves, parameters)

    def collision(
        self,
        moves: ChainFreedom,
        rows: Floats,
        worst: Floats,
        overlap: float,
        parts: tuple[str, str],
    ) -> "Collision":
        """The collision of two parts that overlap at `rows`, deepest at `worst`."""
        from stepwell.build.sweeps import Collision

        layout = self.layout
        cells = [layout.cells[i].cell for i in moves.cells]
        count = len(cells)
        travels = [
            cell.travel(np.clip(rows[:, k], -cell.limit, cell.limit))
            for k, cell in enumerate(cells)
        ]
        total = np.sum(travels, axis=0) if travels else np.zeros(len(rows))
        others = sum(
            one.cell.full_travel for i, one in enumerate(layout.cells) if i not in moves.cells
        )
        states = dict.fromkeys(
            state for row in rows if (state := _state(layout, moves, row[:count])) is not None
        )
        angles = np.zeros(len(layout.cells))
        angles[list(moves.cells)] = worst[:count]
        return Collision(
            parts=parts,
            cells=moves.cells,
            travels=tuple((float(one.min()), float(one.max())) for one in travels),
            stroke=(float(total.min()), float(total.max()) + others),
            states=tuple(states),
            overlap=overlap,
            angles=tuple(float(one) for one in angles),
        )


def _state(layout: Layout, moves: ChainFreedom, row: Floats) -> str | None:
    """The state of a row of angles, if all its cells are at a stop."""
    digits = ["?"] * len(layout.cells)
    for i, theta in zip(moves.cells, row, strict=True):
        limit = layout.cells[i].cell.limit
        if abs(abs(theta) - limit) > 1e-9:
            return None
        digits[i] = "1" if theta > 0 else "0"
    return "".join(digits)
