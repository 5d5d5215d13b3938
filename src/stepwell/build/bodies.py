"""Rigid bodies of a layout, their cross-sections in each layer, and how far two can move apart."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import Floats
from stepwell.build import drive, seats
from stepwell.build.contour import Contour
from stepwell.build.layouts import BandPath, Layout

if TYPE_CHECKING:
    import shapely

# Arcs in cross-sections are at most this far from their chords [m].
SAGITTA = 2e-6
# Layers thinner than this are rounding [m].
_THINNEST = 1e-6


@dataclass(frozen=True, slots=True)
class Piece:
    """A part or a fastener of a body: its contours in the body's frame, and its z [m]."""

    name: str
    outline: Contour
    cutouts: tuple[Contour, ...]
    low: float
    high: float
    joint: tuple[int, int] | None = None


@dataclass(eq=False)
class RigidBody:
    """Parts that move as one.

    Attributes:
        kind: "block", "lever", "band" or "bar".
        number: of the block, or of the cell.
        index: of the lever or the band in its cell.
        pieces: parts and fasteners; none for a band.
        path: of a band.
    """

    kind: str
    number: int
    index: int = 0
    pieces: tuple[Piece, ...] = ()
    path: BandPath | None = None
    _sections: dict[frozenset[str], Any] = field(default_factory=dict, repr=False)

    @property
    def name(self) -> str:
        """Its name in messages."""
        if self.kind == "block":
            return f"block {self.number}"
        if self.kind == "bar":
            return "drive-bar"
        if self.kind == "lever":
            return f"lever-{self.number + 1}{'ab'[self.index]}"
        return f"band {self.index + 1} of cell {self.number + 1}"

    @property
    def key(self) -> tuple[str | int, ...]:
        """The body's name in `Layout.body`."""
        return (self.kind, self.number, self.index)[: {"block": 2, "lever": 3}.get(self.kind, 1)]

    @cached_property
    def heights(self) -> list[float]:
        """z of all lower and upper faces [m]."""
        if self.path is not None:
            return [self.path.low, self.path.high]
        return sorted({z for one in self.pieces for z in (one.low, one.high)})

    def between(self, low: float, high: float, exempt: tuple[int, int] | None) -> list[Piece]:
        """Pieces that cover the heights from `low` to `high`, without those of a joint."""
        return [
            one
            for one in self.pieces
            if one.low <= low + _THINNEST
            and one.high >= high - _THINNEST
            and (exempt is None or one.joint != exempt)
        ]

    def section(self, pieces: Iterable[Piece]) -> "shapely.Geometry":
        """Union of the areas of some of its pieces, in its frame."""
        import shapely

        pieces = list(pieces)
        key = frozenset(f"{one.name} {one.low} {one.high}" for one in pieces)
        if key not in self._sections:
            self._sections[key] = shapely.union_all([area(one) for one in pieces])
        return self._sections[key]


def area(piece: Piece) -> "shapely.Polygon":
    """The area of a piece, slots left open."""
    import shapely

    return shapely.Polygon(
        piece.outline.ring(SAGITTA), [cutout.ring(SAGITTA) for cutout in piece.cutouts]
    )


def bodies_of(layout: Layout) -> list[RigidBody]:
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
        pieces[("block", one.block)].append(piece)
    made = [
        RigidBody(
            str(key[0]), *(int(one) for one in key[1:] or (len(layout.cells),)), pieces=tuple(own)
        )
        for key, own in pieces.items()
    ]
    bands = [RigidBody("band", one.cell, one.number, path=one) for one in layout.bands]
    return made + bands


@dataclass(frozen=True, slots=True)
class Freedom:
    """What moves two bodies relative to each other.

    Attributes:
        cells: cells between the two bodies, or theirs.
        slides: whether the bar's place along its slot counts too; it is the last parameter.
        reach: (k,) largest relative displacement of any two points per rad or m of each parameter.
        low, high: (k,) ranges of the parameters [rad, m].
    """

    cells: tuple[int, ...]
    slides: bool
    reach: Floats
    low: Floats
    high: Floats


def freedom(layout: Layout, a: RigidBody, b: RigidBody) -> Freedom:
    """The parameters of two bodies. Levers turn around joints, blocks shift along arcs of radius r.

    Both motions are measured from a block between the bodies, so cells outside never count.
    """
    reach: dict[int, float] = {}
    first, second = sorted((a, b), key=_order)
    half = layout.build_file.lever.width / 2.0

    def add(cell: int, amount: float) -> None:
        reach[cell] = reach.get(cell, 0.0) + amount

    def own(body: RigidBody) -> None:
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
    return Freedom(cells, slides, np.array(scale), -np.array(limits), np.array(limits))


def _order(body: RigidBody) -> float:
    """Place in the chain: blocks at whole numbers, levers and bands between, the bar last."""
    return body.number + (0.5 if body.kind in ("lever", "band") else 0.0) + (body.kind == "bar") / 4


class Poses:
    """Places of bodies at many sets of parameters; cells that do not count stand at angle 0."""

    def __init__(self, layout: Layout, freedom: Freedom, parameters: Floats):
        self.layout = layout
        self.angles = np.zeros((len(parameters), len(layout.cells)))
        self.angles[:, freedom.cells] = parameters[:, : len(freedom.cells)]
        self.slide = parameters[:, -1] if freedom.slides else np.zeros(len(parameters))
        self.at = layout.positions(self.angles)

    def of(self, body: RigidBody) -> tuple[Floats, Floats]:
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

    def line(self, path: BandPath) -> Floats:
        """(n, 2, 2) ends of a band [m]."""
        cell = path.cell
        return np.stack([self.at[:, cell] + path.p, self.at[:, cell + 1] + path.q], axis=1)


def layers(a: RigidBody, b: RigidBody) -> list[tuple[float, float]]:
    """Heights shared by two bodies, cut at all faces of either [m]."""
    heights = sorted({*a.heights, *b.heights})
    low, high = max(a.heights[0], b.heights[0]), min(a.heights[-1], b.heights[-1])
    return [
        (z0, z1)
        for z0, z1 in pairwise(heights)
        if z1 - z0 > _THINNEST and z0 >= low - _THINNEST and z1 <= high + _THINNEST
    ]
