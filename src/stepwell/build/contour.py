"""Contours of flat parts: closed, of straight lines and circular arcs, with exact measures."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

from stepwell.base import UNITS, ByValue, Floats, InputError, Vec2, check

if TYPE_CHECKING:
    import shapely

# Millimetres in a metre, grams in a kilogram.
MM, GRAMS = UNITS["mm"].per_si, UNITS["g"].per_si
# Largest distance of an arc from the chords that stand for it [m].
SAGITTA = 1e-6
# Shortest edge of a contour [m]; kerf, cutters and files resolve micrometres.
SHORTEST = 1e-7
# Nodes of the quadrature of one edge. Integrands are trigonometric polynomials of degree 4 or less
# over one turn or less, for which 24 nodes are exact to rounding.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_NODES, _WEIGHTS = (_NODES + 1.0) / 2.0, _WEIGHTS / 2.0


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Contour(ByValue):
    """A closed contour, counter-clockwise, of straight lines and circular arcs.

    Edge i leads from point i to point i + 1, the last edge back to point 0. All files of a part are
    derived from this one value.

    Args:
        points: (n, 2) corners [m], n >= 2.
        bulges: (n,) tan(φ/4) of each edge with the arc's angle φ; 0 for a straight edge, positive
            for an arc that turns left. DXF has the same number.

    Raises:
        ValueError: points and bulges are not as many, an edge is shorter than 0.1 µm, a number is
            not finite, or the contour runs clockwise.

    Source: bulges as in the DXF reference, LWPOLYLINE, group code 42.
    """

    points: tuple[Vec2, ...]
    bulges: tuple[float, ...]

    def __post_init__(self):
        points = tuple(check.vector(f"points[{i}]", p) for i, p in enumerate(self.points))
        bulges = check.as_many("bulges", self.bulges, "1", "points", len(points))
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "bulges", bulges)
        if len(points) < 2:
            raise InputError(f"points has {len(points)} corners: a contour has 2 or more.")
        lengths = np.hypot(*(np.roll(self._xy, -1, axis=0) - self._xy).T)
        if (short := int(np.argmin(lengths))) >= 0 and lengths[short] < SHORTEST:
            raise InputError(
                f"points[{short}] = {points[short]} m equals the next corner within 0.1 µm: leave "
                f"one of them out."
            )
        if self.area <= 0.0:
            raise InputError(
                f"the contour with corner {points[0]} m has the area {self.area * 1e6:.4g} mm²: "
                f"it must be > 0. List the corners counter-clockwise."
            )

    def __repr__(self):
        x0, y0, x1, y1 = (MM * one for one in self.bounds)
        arcs = sum(bulge != 0.0 for bulge in self.bulges)
        return (
            f"Contour({len(self.points)} edges, {arcs} of them arcs, x {x0:.4g} to {x1:.4g} mm, "
            f"y {y0:.4g} to {y1:.4g} mm)"
        )

    @classmethod
    def of(cls, corners: Sequence[Vec2]) -> Self:
        """The polygon with these corners [m], in either direction."""
        return cls.rounded(corners, 0.0)

    @classmethod
    def circle(cls, centre: Vec2, radius: float) -> Self:
        """The circle around `centre` [m] with this radius [m]."""
        x, y = centre
        radius = check.positive("radius", radius, "m")
        return cls(((x + radius, y), (x - radius, y)), (1.0, 1.0))

    @classmethod
    def rounded(cls, corners: Sequence[Vec2], radius: float | Sequence[float]) -> Self:
        """The polygon with these corners [m], in either direction, each rounded.

        Args:
            corners: (n, 2) of the polygon before rounding [m].
            radius: of all corners, or (n,) of each [m]; 0 keeps a corner sharp.

        Raises:
            ValueError: an edge is too short for the roundings of its two corners.
        """
        at = np.array(corners, float)
        radii = np.broadcast_to(np.array(radius, float), len(at))
        if np.sum(at[:, 0] * (np.roll(at[:, 1], -1) - np.roll(at[:, 1], 1))) < 0.0:
            at, radii = at[::-1], radii[::-1]
        ahead = np.roll(at, -1, axis=0) - at
        length = np.hypot(*ahead.T)
        ahead = ahead / length[:, None]
        before = np.roll(ahead, 1, axis=0)
        turns = np.arctan2(_cross(before, ahead), np.sum(before * ahead, axis=1))
        cuts = radii * np.abs(np.tan(turns / 2.0))
        room = length - cuts - np.roll(cuts, -1)
        if (tight := int(np.argmin(room))) >= 0 and room[tight] < -SHORTEST:
            raise InputError(
                f"edge {tight} of {MM * length[tight]:.4g} mm is shorter than the roundings of "
                f"its corners, {MM * (length[tight] - room[tight]):.4g} mm: use smaller radii."
            )
        points: list[Vec2] = []
        bulges: list[float] = []
        for i in range(len(at)):
            ends = [at[i]]
            if cuts[i] > SHORTEST:
                ends = [at[i] - cuts[i] * before[i], at[i] + cuts[i] * ahead[i]]
                bulges.append(math.tan(turns[i] / 4.0))
            points += [(float(x), float(y)) for x, y in ends]
            bulges.append(0.0)
        return cls(*_without_short(points, bulges))

    @classmethod
    def slot(cls, start: Vec2, end: Vec2, width: float) -> Self:
        """A straight slot with round ends: `start` and `end` [m] are the centres of the ends."""
        (x0, y0), (x1, y1) = start, end
        reach = math.hypot(x1 - x0, y1 - y0)
        if reach < SHORTEST:
            return cls.circle(start, width / 2.0)
        half = check.positive("width", width, "m") / 2.0
        nx, ny = half * (y1 - y0) / reach, -half * (x1 - x0) / reach
        corners = (x0 + nx, y0 + ny), (x1 + nx, y1 + ny), (x1 - nx, y1 - ny), (x0 - nx, y0 - ny)
        return cls(corners, (0.0, 1.0, 0.0, 1.0))

    @classmethod
    def arc_slot(
        cls, centre: Vec2, radius: float, from_angle: float, to_angle: float, width: float
    ) -> Self:
        """A slot with round ends along an arc.

        Args:
            centre, radius: of the middle line [m].
            from_angle, to_angle: of the centres of the ends [rad], counter-clockwise from x;
                `from_angle` < `to_angle`.
            width: across the middle line [m], less than 2 `radius`.
        """
        half = check.positive("width", width, "m") / 2.0
        span = to_angle - from_angle
        if not 0.0 < span < math.tau or half >= radius:
            raise InputError(
                f"slot from {math.degrees(from_angle):.4g} to {math.degrees(to_angle):.4g} degrees "
                f"of width {2.0 * MM * half:.4g} mm on a radius of {MM * radius:.4g} mm: the "
                f"angles must rise by less than 360 degrees, and the width be less than two radii."
            )

        def on(reach: float, angle: float) -> Vec2:
            return centre[0] + reach * math.cos(angle), centre[1] + reach * math.sin(angle)

        long, short = radius + half, radius - half
        corners = (
            on(long, from_angle),
            on(long, to_angle),
            on(short, to_angle),
            on(short, from_angle),
        )
        bulge = math.tan(span / 4.0)
        return cls(corners, (bulge, 1.0, -bulge, 1.0))

    @property
    def _xy(self) -> Floats:
        return np.array(self.points)

    def edges(self) -> list[tuple[Vec2, Vec2, float]]:
        """Start, end and bulge of every edge."""
        ends = (*self.points[1:], self.points[0])
        return list(zip(self.points, ends, self.bulges, strict=True))

    def as_circle(self) -> tuple[Vec2, float] | None:
        """Centre and radius [m] of a contour of two half circles; None for any other."""
        if self.bulges != (1.0, 1.0):
            return None
        (x0, y0), (x1, y1) = self.points
        return ((x0 + x1) / 2.0, (y0 + y1) / 2.0), math.dist(*self.points) / 2.0

    def ring(self, sagitta: float = SAGITTA) -> Floats:
        """(m, 2) corners of a polygon for this contour [m], not closed.

        Its corners are on the contour; an arc is at most `sagitta` [m] away from its chords.
        """
        pieces = []
        for start, end, bulge in self.edges():
            if bulge == 0.0:
                pieces.append(np.array([start]))
                continue
            centre, radius, first, span = arc(start, end, bulge)
            step = 2.0 * math.acos(max(1.0 - sagitta / radius, 0.0))
            angles = first + span * np.arange(n := math.ceil(abs(span) / step)) / n
            points = centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])
            points[0] = start
            pieces.append(points)
        return np.concatenate(pieces)

    def polygon(self, sagitta: float = SAGITTA) -> "shapely.Polygon":
        """The polygon of `ring` as a value of shapely."""
        import shapely

        return shapely.Polygon(self.ring(sagitta))

    def moments(self, x: float = 0.0, y: float = 0.0) -> Floats:
        """(6,) integrals over the enclosed area of 1, u, v, u², v² and uv [m², m³, m⁴].

        u and v are measured from the point (x, y) [m]. Exact to rounding: Green's theorem, each
        edge by Gauss quadrature.
        """
        total = np.zeros(6)
        for start, end, bulge in self.edges():
            u, v, du, dv = _traced(start, end, bulge)
            u, v = u - x, v - y
            terms = (
                (u * dv - v * du) / 2.0,
                u * u * dv / 2.0,
                -v * v * du / 2.0,
                u**3 * dv / 3.0,
                -(v**3) * du / 3.0,
                u * u * v * dv / 2.0,
            )
            total += np.array([_WEIGHTS @ term for term in terms])
        return total

    @property
    def area(self) -> float:
        """Enclosed area [m²], exact."""
        (x, y), total = self.points[0], 0.0
        for (x0, y0), (x1, y1), bulge in self.edges():
            # The triangle with corner 0, so that a distant contour loses no digits.
            total += ((x0 - x) * (y1 - y) - (x1 - x) * (y0 - y)) / 2.0
            if bulge != 0.0:
                # The segment between arc and chord, r²/2 (φ - sin φ).
                angle = 4.0 * math.atan(bulge)
                radius = math.dist((x0, y0), (x1, y1)) * (1.0 + bulge * bulge) / (4.0 * bulge)
                total += radius * radius * (angle - math.sin(angle)) / 2.0
        return total

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Least x and y, greatest x and y [m], exact."""
        reached = list(self.points)
        for start, end, bulge in self.edges():
            if bulge != 0.0:
                (x, y), radius, first, span = arc(start, end, bulge)
                low, high = sorted((first, first + span))
                for quarter in range(
                    math.ceil(low / (math.pi / 2)), math.floor(high / (math.pi / 2)) + 1
                ):
                    dx, dy = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarter % 4]
                    reached.append((x + radius * dx, y + radius * dy))
        xs, ys = zip(*reached, strict=True)
        return min(xs), min(ys), max(xs), max(ys)

    def moved(self, x: float = 0.0, y: float = 0.0, angle: float = 0.0) -> "Contour":
        """The contour turned around the origin by `angle` [rad], then shifted by (x, y) [m]."""
        return Contour(tuple(placed(self._xy, x, y, angle)), self.bulges)

    def mirrored(self) -> "Contour":
        """The mirror image, x to -x."""
        points = tuple((-x, y) for x, y in reversed(self.points))
        # The edge that leads to a point now leads away from it.
        return Contour(points, (*self.bulges[-2::-1], self.bulges[-1]))

    def offset(self, dx: float, dy: float) -> "Contour":
        """The contour at a distance: the path of a beam's centre. `offset.offset` has the details.

        Args:
            dx, dy: along x and y [m]; positive outwards.
        """
        from stepwell.build.offset import offset

        return offset(self, dx, dy)


def placed(points: "Floats | Sequence[Vec2]", x: float, y: float, angle: float) -> list[Vec2]:
    """Points (n, 2) [m] turned around the origin by `angle` [rad], then shifted by (x, y) [m]."""
    c, s = math.cos(angle), math.sin(angle)
    return [(float(x + c * a - s * b), float(y + s * a + c * b)) for a, b in points]


def arc(start: Vec2, end: Vec2, bulge: float) -> tuple[Vec2, float, float, float]:
    """Centre and radius [m] of an arc, angle of its start and signed angle of turning [rad]."""
    (x0, y0), (x1, y1) = start, end
    # Distance of the centre from the chord's middle over the chord, to the left: (1 - b²) / 4b.
    left = (1.0 - bulge * bulge) / (4.0 * bulge)
    centre = (x0 + x1) / 2.0 - left * (y1 - y0), (y0 + y1) / 2.0 + left * (x1 - x0)
    radius = math.hypot(x1 - x0, y1 - y0) * (1.0 + bulge * bulge) / (4.0 * abs(bulge))
    return centre, radius, math.atan2(y0 - centre[1], x0 - centre[0]), 4.0 * math.atan(bulge)


def _traced(start: Vec2, end: Vec2, bulge: float) -> tuple[Floats, Floats, Floats, Floats]:
    """x, y and their derivatives along an edge at the nodes of the quadrature."""
    if bulge == 0.0:
        (x0, y0), (x1, y1) = start, end
        steady = np.ones_like(_NODES)
        x, y = x0 + (x1 - x0) * _NODES, y0 + (y1 - y0) * _NODES
        return x, y, (x1 - x0) * steady, (y1 - y0) * steady
    (x, y), radius, first, span = arc(start, end, bulge)
    angles = first + span * _NODES
    dx, dy = radius * np.cos(angles), radius * np.sin(angles)
    return x + dx, y + dy, -span * dy, span * dx


def _cross(a: Floats, b: Floats) -> Floats:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _without_short(
    points: list[Vec2], bulges: list[float]
) -> tuple[tuple[Vec2, ...], tuple[float, ...]]:
    """The corners without straight edges of no length, where two roundings meet."""
    ends = [*points[1:], points[0]]
    kept = [
        (start, bulge)
        for start, end, bulge in zip(points, ends, bulges, strict=True)
        if bulge != 0.0 or math.dist(start, end) >= SHORTEST
    ]
    return tuple(start for start, _ in kept), tuple(bulge for _, bulge in kept)
