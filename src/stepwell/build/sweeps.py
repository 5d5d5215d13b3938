"""The sweep: proof that no two parts touch at any angles, or which parts meet, where and how far.

Branch and bound over the angles of the cells that move two bodies relative to each other. At the
middle of a box of angles their distance is computed; it can shrink by no more than the motion to
the edge of the box, which is bounded by lever lengths. A box whose distance exceeds this bound is
free at all its angles; other boxes are divided.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations, product
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import ByValue, Floats
from stepwell.build.bodies import SweptChain
from stepwell.build.layouts import Layout
from stepwell.build.rigid import (
    BodyPoses,
    Freedom,
    Overlap,
    Piece,
    RigidBody,
    SweptMechanism,
    area,
    layers,
)

if TYPE_CHECKING:
    import shapely

# Overlaps up to this depth count as touching [m]: stops touch, and arcs are chords in the sweep.
TOUCH = 10e-6
_SHRUNK = TOUCH - 2e-6 - 2e-6
# Clearances below this are computed, to the resolution [m]; larger ones are only proved larger.
NEAR, _RESOLUTION = 1.5e-3, 0.1e-3
# Boxes of one pair of bodies in one layer.
_MOST_BOXES = 200_000
# Angles of a pair of which all states are looked at first.
_MOST_CORNERS = 3
# Samples of each angle that describe a collision, by the number of angles.
_SAMPLES = {1: 91, 2: 21}
_FEW_SAMPLES = 7


@dataclass(frozen=True, slots=True, eq=False)
class Clearance(ByValue):
    """The least distance of two bodies over all angles, if it is below `NEAR`.

    Attributes:
        parts: names of the two bodies.
        distance: least distance seen [m]; nowhere is it smaller by more than 0.1 mm. Zero for
            stops, which touch.
        low, high: z of the layer [m].
    """

    parts: tuple[str, str]
    distance: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, eq=False)
class Collision(Overlap):
    """Two parts of a chain that overlap at some angles.

    Attributes:
        cells: numbers from 0 of the cells whose angles decide.
        travels: least and largest travel [m] of each of these cells while they overlap.
        stroke: least and largest stroke [m] at which they can overlap.
        states: states such as "01" in which they overlap; "?" for cells that do not matter.
        angles: (N,) of all cells [rad] at the deepest overlap.
    """

    cells: tuple[int, ...]
    travels: tuple[tuple[float, float], ...]
    stroke: tuple[float, float]
    states: tuple[str, ...]
    angles: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False)
class MotionSweep(ByValue):
    """Result of a sweep over all angles of all cells.

    Attributes:
        free: whether no two parts overlap at any angles, proved.
        collisions: the parts that overlap, deepest first.
        undecided: pairs of bodies for which the search ended before a result.
        clearances: pairs that come close, closest first.
        pairs, poses: number of compared pairs of bodies, and of computed distances.
    """

    free: bool
    collisions: tuple[Any, ...]
    undecided: tuple[tuple[str, str], ...]
    clearances: tuple[Clearance, ...]
    pairs: int
    poses: int


def swept_of(layout: Layout | SweptMechanism) -> SweptMechanism:
    """A layout of a chain as a mechanism for sweeps; others are one."""
    return SweptChain(layout) if isinstance(layout, Layout) else layout


def sweep(
    layout: Layout | SweptMechanism, progress: Callable[[int, int], None] | None = None
) -> MotionSweep:
    """Compare all bodies of a layout over all angles of its cells.

    The angles of all cells are independent here, so all reachable states are among them. Of the
    drive bar any place along its slot counts.

    Args:
        layout: of a chain, or the bodies of another mechanism.
        progress: called with (done, total) pairs of bodies.
    """
    layout = swept_of(layout)
    pairs = list(combinations(layout.bodies(), 2))
    collisions: list[Overlap] = []
    clearances: list[Clearance] = []
    undecided: list[tuple[str, str]] = []
    poses = 0
    for done, (a, b) in enumerate(pairs):
        if progress is not None:
            progress(done, len(pairs))
        for result in compare(layout, a, b):
            poses += result.poses
            found = list(describe(layout, result)) if result.hit is not None else []
            collisions += found
            if result.undecided or (result.hit is not None and not found):
                undecided.append((a.name, b.name))
            elif result.hit is None and result.least < NEAR:
                clearances.append(
                    Clearance((a.name, b.name), max(result.least, 0.0), result.low, result.high)
                )
    deepest = _deepest(collisions)
    nearest: dict[tuple[str, str], Clearance] = {}
    for one in sorted(clearances, key=lambda one: one.distance):
        nearest.setdefault(one.parts, one)
    return MotionSweep(
        free=not deepest and not undecided,
        collisions=deepest,
        undecided=tuple(undecided),
        clearances=tuple(nearest.values()),
        pairs=len(pairs),
        poses=poses,
    )


def _deepest(collisions: list[Overlap]) -> tuple[Overlap, ...]:
    """One collision for every two parts, the deepest first."""
    kept: dict[tuple[str, str], Overlap] = {}
    for one in sorted(collisions, key=lambda one: -one.overlap):
        kept.setdefault(one.parts, one)
    return tuple(kept.values())


@dataclass(slots=True)
class Compared:
    """Two bodies in one layer: least distance seen, a hit, and the number of distances."""

    low: float
    high: float
    freedom: Freedom
    distances: "Distances"
    least: float = np.inf
    hit: Floats | None = None
    undecided: bool = False
    poses: int = 0


def compare(layout: Layout | SweptMechanism, a: RigidBody, b: RigidBody) -> Iterator[Compared]:
    """Results for two bodies, one for each layer in which both have parts."""
    layout = swept_of(layout)
    moves: Any = None
    seen: set[Any] = set()
    for low, high in layers(a, b):
        distances = Distances.of(layout, a, b, low, high)
        if distances is None or distances.key in seen:
            continue
        seen.add(distances.key)
        moves = moves or layout.freedom(a, b)
        result = Compared(low, high, moves, distances)
        _bounded(result)
        yield result


def _bounded(result: Compared) -> None:
    """Divide the box of all angles until every part of it is free, or one pose overlaps."""
    moves = result.freedom
    low, high = moves.low[None], moves.high[None]
    if len(moves.low) <= _MOST_CORNERS:
        # Most bodies are closest where cells are at their stops.
        corners = np.array(list(product(*zip(moves.low, moves.high, strict=True))))
        distance = result.distances(result.distances.swept.poses(moves, corners))
        result.poses += len(corners)
        result.least = float(distance.min()) - _SHRUNK
        if not distance.all():
            result.hit = corners[int(np.argmin(distance))]
            return
    while len(low):
        middle, half = (low + high) / 2.0, (high - low) / 2.0
        distance = result.distances(result.distances.swept.poses(moves, middle))
        result.poses += len(middle)
        result.least = min(result.least, float(distance.min()) - _SHRUNK)
        if not distance.all():
            result.hit = middle[int(np.argmin(distance))]
            return
        left = distance - half @ moves.reach
        enough = min(result.least + _SHRUNK - _RESOLUTION, NEAR)
        open_ = ~((left > 0.0) & (left >= enough))
        if result.poses > _MOST_BOXES:
            result.undecided = True
            return
        low, high = low[open_], high[open_]
        half = half[open_]
        if not len(low):
            return
        axis = np.argmax(half * moves.reach, axis=1)
        rows = np.arange(len(low))
        cut = (low[rows, axis] + high[rows, axis]) / 2.0
        upper, lower = low.copy(), high.copy()
        upper[rows, axis] = lower[rows, axis] = cut
        low, high = np.concatenate([low, upper]), np.concatenate([lower, high])


@dataclass(slots=True)
class Distances:
    """Distances of two bodies in one layer: one stands, shrunk a little, the other moves."""

    swept: SweptMechanism
    still: RigidBody
    moving: RigidBody
    pieces: tuple[list[Piece], list[Piece]]  # of both
    still_area: "shapely.Geometry | None"
    rings: list[Floats]

    @classmethod
    def of(
        cls, swept: SweptMechanism, a: RigidBody, b: RigidBody, low: float, high: float
    ) -> "Distances | None":
        """For two bodies between two heights; None if one has nothing there."""
        import shapely

        if a.name == b.name:  # two pieces of one cord
            return None
        still, moving = sorted((a, b), key=lambda one: one.rank)
        of_still = still.between(low, high, moving)
        of_moving = moving.between(low, high, still)
        if (not of_still and still.path is None) or (not of_moving and moving.path is None):
            return None
        area = rings = None
        if still.path is None:
            # Sharp corners, so that faces stay faces.
            area = shapely.buffer(still.section(of_still), -_SHRUNK, join_style="mitre")
            shapely.prepare(area)
        if moving.path is None:
            union = moving.section(of_moving)
            rings = [shapely.get_coordinates(one.exterior) for one in shapely.get_parts(union)]
        return cls(swept, still, moving, (of_still, of_moving), area, rings or [])

    @property
    def key(self) -> Any:
        """Equal for layers with the same pieces."""
        return tuple(frozenset(f"{one.name} {one.low}" for one in pieces) for pieces in self.pieces)

    def __call__(self, poses: BodyPoses) -> Floats:
        """(n,) distances [m] at these poses; 0 for an overlap."""
        import shapely

        if self.still.path is not None:
            assert self.moving.path
            one, other = (poses.line(body) for body in (self.still, self.moving))
            width = (self.still.path.width + self.moving.path.width) / 2.0 - _SHRUNK
            gaps = shapely.distance(lines_of(one), lines_of(other))
            return np.maximum(gaps - width, 0.0)
        at, angle = poses.of(self.still)
        c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]

        def within(points: Floats) -> Floats:
            """Points (n, m, 2) in the frame of the body that stands."""
            x, y = np.moveaxis(points - at[:, None], 2, 0)
            return np.stack([c * x + s * y, c * y - s * x], axis=-1)

        if self.moving.path is not None:
            lines = lines_of(within(poses.line(self.moving)))
            gaps = shapely.distance(self.still_area, lines) - self.moving.path.width / 2.0
            return np.maximum(gaps, 0.0)
        to, turn = poses.of(self.moving)
        cos, sin = np.cos(turn)[:, None], np.sin(turn)[:, None]
        gaps = []
        for ring in self.rings:
            x, y = ring.T
            moved = np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1) + to[:, None]
            gaps.append(shapely.distance(self.still_area, shapely.polygons(within(moved))))
        return np.min(gaps, axis=0)


def lines_of(ends: Floats) -> Any:
    """The lines with these ends (n, 2, 2), an (n,) array of shapely."""
    import shapely

    return np.asarray(shapely.linestrings(ends))


def describe(swept: SweptMechanism, found: Compared) -> Iterator[Overlap]:
    """The collisions of two bodies in one layer, part by part."""
    moves, distances = found.freedom, found.distances
    count = _SAMPLES.get(len(moves.low), _FEW_SAMPLES)
    axes = [np.linspace(low, high, count) for low, high in zip(moves.low, moves.high, strict=True)]
    every = np.array(list(product(*axes)))
    assert found.hit is not None
    every = np.concatenate([found.hit[None], every])
    at_hit = every[distances(swept.poses(moves, every)) == 0.0]
    for first, second in _piece_pairs(distances):
        rows, depths = _depths(
            swept.poses(moves, at_hit), at_hit, (distances.still, first), (distances.moving, second)
        )
        if not len(rows):
            continue
        worst = rows[int(np.argmax(depths))]
        parts = first.name, second.name
        yield swept.collision(moves, rows, worst, float(depths.max()), parts)


def _piece_pairs(distances: Distances) -> Iterator[tuple[Piece, Piece]]:
    still, moving = distances.pieces
    yield from product(
        still or [_band_piece(distances.still)], moving or [_band_piece(distances.moving)]
    )


def _band_piece(body: RigidBody) -> Piece:
    from stepwell.build.contour import Contour

    assert body.path is not None
    return Piece(
        body.name,
        Contour.circle((0.0, 0.0), body.path.width / 2.0),
        (),
        body.path.low,
        body.path.high,
    )


_MOST_DEPTHS = 40


def _depths(
    poses: BodyPoses, rows: Floats, first: tuple[RigidBody, Piece], second: tuple[RigidBody, Piece]
) -> tuple[Floats, Floats]:
    """The rows at which two pieces overlap, and by how much [m]."""
    import shapely

    shapes = [_placed(poses, *one) for one in (first, second)]
    hit = shapely.distance(*shapes) == 0.0
    chosen = np.flatnonzero(hit)
    chosen = chosen[:: max(1, len(chosen) // _MOST_DEPTHS)]
    depths = np.array([_depth(shapes[0][i], shapes[1][i]) for i in chosen])
    deep = depths > TOUCH if len(depths) else np.zeros(0, bool)
    return rows[chosen][deep], depths[deep]


def _placed(poses: BodyPoses, body: RigidBody, piece: Piece) -> Any:
    """The areas of a piece at all poses."""
    import shapely

    if body.path is not None:
        return shapely.buffer(lines_of(poses.line(body)), body.path.width / 2.0)
    at, angle = poses.of(body)
    shape = area(piece)

    def ring(points: Floats, i: int) -> Floats:
        c, s = np.cos(angle[i]), np.sin(angle[i])
        return points @ np.array([[c, s], [-s, c]]) + at[i]

    rings = [shapely.get_coordinates(one) for one in (shape.exterior, *shape.interiors)]
    return np.array(
        [
            shapely.Polygon(ring(rings[0], i), [ring(r, i) for r in rings[1:]])
            for i in range(len(at))
        ]
    )


def _depth(a: "shapely.Geometry", b: "shapely.Geometry") -> float:
    """How far two areas overlap [m]: the diameter of the largest circle in what they share."""
    import shapely

    shared: Any = shapely.intersection(a, b)
    if shared.is_empty or shared.area == 0.0:
        return 0.0
    radius: Any = shapely.maximum_inscribed_circle(shared)
    return 2.0 * float(shapely.length(radius))
