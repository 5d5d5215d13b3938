"""Rigid bodies of flat parts, their cross-sections, and what a sweep needs of a mechanism."""

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Protocol

from stepwell.base import ByValue, Floats
from stepwell.build.contour import Contour

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
    joint: Hashable = None


@dataclass(eq=False, kw_only=True)
class RigidBody:
    """Parts that move as one, or a stretched band.

    Attributes:
        name: in messages.
        pieces: parts and fasteners; none for a band.
        path: of a band or a cord, with z of its faces `low` and `high`, and its `width` [m].
        rank: of two bodies, the one with the lower rank stands; it has the slots.
        joints: pieces with these joints turn in holes of this body.
        hooks: names of the pieces that hold a band.
    """

    name: str
    pieces: tuple[Piece, ...] = ()
    path: Any = None
    rank: float = 0.0
    joints: frozenset[Hashable] = frozenset()
    hooks: frozenset[str] = frozenset()
    _sections: dict[frozenset[str], Any] = field(default_factory=dict, repr=False)

    @cached_property
    def heights(self) -> list[float]:
        """z of all lower and upper faces [m]."""
        if self.path is not None:
            return [self.path.low, self.path.high]
        return sorted({z for one in self.pieces for z in (one.low, one.high)})

    def between(self, low: float, high: float, other: "RigidBody") -> list[Piece]:
        """Pieces that cover the heights from `low` to `high`, without those that hold `other`."""
        return [
            one
            for one in self.pieces
            if one.low <= low + _THINNEST
            and one.high >= high - _THINNEST
            and (one.joint is None or one.joint not in other.joints)
            and one.name not in other.hooks
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


def layers(a: RigidBody, b: RigidBody) -> list[tuple[float, float]]:
    """Heights shared by two bodies, cut at all faces of either [m]."""
    heights = sorted({*a.heights, *b.heights})
    low, high = max(a.heights[0], b.heights[0]), min(a.heights[-1], b.heights[-1])
    return [
        (z0, z1)
        for z0, z1 in pairwise(heights)
        if z1 - z0 > _THINNEST and z0 >= low - _THINNEST and z1 <= high + _THINNEST
    ]


@dataclass(frozen=True, slots=True)
class Freedom:
    """What moves two bodies relative to each other.

    Attributes:
        reach: (k,) largest relative displacement of any two points per rad or m of each parameter.
        low, high: (k,) ranges of the parameters [rad, m].
    """

    reach: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Overlap(ByValue):
    """Two parts that overlap at some pose.

    Attributes:
        parts: names of the two parts.
        overlap: depth [m]: by how much each has to shrink on all sides together to be free.
    """

    parts: tuple[str, str]
    overlap: float


class BodyPoses(Protocol):
    """Places of bodies at n sets of parameters."""

    def of(self, body: Any) -> tuple[Floats, Floats]:
        """(n, 2) places [m] and (n,) angles [rad] of a body's frame."""
        ...

    def line(self, body: Any) -> Floats:
        """(n, 2, 2) ends of a band [m]."""
        ...


class SweptMechanism(Protocol):
    """A mechanism of flat parts whose bodies a sweep compares."""

    def bodies(self) -> list[Any]:
        """All rigid bodies and bands."""
        ...

    def freedom(self, a: Any, b: Any) -> Any:
        """The parameters of two bodies, a `Freedom`."""
        ...

    def poses(self, moves: Any, parameters: Floats) -> BodyPoses:
        """Places of all bodies at parameters (n, k)."""
        ...

    def collision(
        self, moves: Any, rows: Floats, worst: Floats, overlap: float, parts: tuple[str, str]
    ) -> Overlap:
        """The collision of two parts that overlap at `rows` (n, k), deepest at `worst`."""
        ...
