"""Offset contours: the path of a beam's centre that leaves the drawn contour."""

import math
from collections.abc import Callable

from stepwell.base import InputError, Vec2, check
from stepwell.build.contour import MM, SHORTEST, Contour, arc

# Straight edges and arcs as start, end and bulge.
Edge = tuple[Vec2, Vec2, float]
# Largest deviation of the arcs that stand for an elliptical offset [m], and smallest turn at a
# corner [rad].
_DEVIATION, _SMOOTH = 1e-6, 1e-7


def offset(contour: Contour, dx: float, dy: float) -> Contour:
    """The contour at a distance, outside it for positive and inside it for negative distances.

    Each point moves by the half axes of an ellipse, (`dx`, `dy`) along x and y: the path of the
    centre of a beam with these half widths. With `dx` = `dy` the distance is the same everywhere
    and straight edges and arcs are exact. Otherwise straight edges are exact, and arcs deviate by
    1 µm at most. Outside a corner the path is an arc around it, inside a corner the edges are cut
    where they meet.

    Args:
        contour: of the finished part.
        dx, dy: along x and y [m]; both 0, or both of one sign.

    Raises:
        ValueError: the signs differ, or the contour has a feature smaller than the distance.
    """
    dx, dy = check.finite("dx", dx, "m"), check.finite("dy", dy, "m")
    if dx == dy == 0.0:
        return contour
    if dx * dy <= 0.0:
        raise InputError(
            f"offset of {MM * dx:.4g} mm in x and {MM * dy:.4g} mm in y: both must be 0, or both "
            f"of one sign. A kerf has a width in both directions: measure it with the coupon."
        )
    beam = _Beam(dx, dy)
    sides = [beam.beside(edge) for edge in contour.edges()]
    kept = [(edge, side) for edge, side in zip(contour.edges(), sides, strict=True) if side]
    joined: list[list[Edge]] = []
    for i, (edge, side) in enumerate(kept):
        before, last = kept[i - 1]
        turn = _turn(_heading(before, end=True), _heading(edge, end=False))
        meet = math.dist(last[-1][1], side[0][0]) < SHORTEST
        if not meet and turn * beam.sign > 0.0:
            joined.append(beam.around(edge[0], _heading(before, end=True), turn))
        elif not meet:
            _trim(last, side, edge[0])
        joined.append(side)
    return _closed([one for side in joined for one in side], contour)


class _Beam:
    """An elliptical beam that passes a contour on its outside (sign 1) or its inside (-1)."""

    def __init__(self, dx: float, dy: float):
        self.a, self.b, self.sign = abs(dx), abs(dy), math.copysign(1.0, dx)

    def shift(self, angle: float) -> Vec2:
        """Displacement [m] of a point whose outward normal has this angle [rad]."""
        nx, ny = math.cos(angle), math.sin(angle)
        scale = self.sign / math.hypot(self.a * nx, self.b * ny)
        return scale * self.a * self.a * nx, scale * self.b * self.b * ny

    def beside(self, edge: Edge) -> list[Edge]:
        """The path beside an edge; none for an arc that has no radius left."""
        start, end, bulge = edge
        if bulge == 0.0:
            dx, dy = self.shift(_heading(edge, end=False) - math.pi / 2)
            return [((start[0] + dx, start[1] + dy), (end[0] + dx, end[1] + dy), 0.0)]
        (x, y), radius, first, span = arc(start, end, bulge)
        inwards = self.sign * span < 0.0
        if inwards and radius <= max(self.a**2 / self.b, self.b**2 / self.a):
            if self.a == self.b:
                return []
            raise InputError(
                f"corner at ({MM * x:.4g}, {MM * y:.4g}) mm has a radius of {MM * radius:.4g} "
                f"mm: a beam with half axes of {MM * self.a:.4g} and {MM * self.b:.4g} mm does "
                f"not follow it. Use a larger radius."
            )
        normal = 0.0 if span > 0.0 else math.pi

        def at(share: float) -> Vec2:
            angle = first + share * span
            dx, dy = self.shift(angle + normal)
            return x + radius * math.cos(angle) + dx, y + radius * math.sin(angle) + dy

        if self.a == self.b:
            return [(at(0.0), at(1.0), bulge)]
        return _arcs(at)

    def around(self, corner: Vec2, heading: float, turn: float) -> list[Edge]:
        """The path around a corner at which the heading [rad] changes by `turn` [rad]."""

        def at(share: float) -> Vec2:
            dx, dy = self.shift(heading + share * turn - math.pi / 2)
            return corner[0] + dx, corner[1] + dy

        if self.a == self.b:
            return [(at(0.0), at(1.0), math.tan(turn / 4.0))]
        return _arcs(at)


def _arcs(at: Callable[[float], Vec2]) -> list[Edge]:
    """Arcs that follow a smooth curve of a parameter from 0 to 1, within `_DEVIATION`."""
    count = 1
    while count <= 1024:
        places = [at(i / (4.0 * count)) for i in range(4 * count + 1)]
        edges = [
            (start, end, _bulge(start, middle, end))
            for start, middle, end in zip(places[:-1:4], places[2::4], places[4::4], strict=True)
        ]
        between = zip(edges, places[1::4], places[3::4], strict=True)
        if all(max(_off(edge, one), _off(edge, two)) < _DEVIATION for edge, one, two in between):
            return edges
        count *= 2
    raise InputError("the offset has too small a radius for arcs: use a smaller offset.")


def _bulge(start: Vec2, middle: Vec2, end: Vec2) -> float:
    """Bulge of the arc through three points."""
    (ax, ay), (bx, by) = ((one[0] - middle[0], one[1] - middle[1]) for one in (start, end))
    # The inscribed angle at the middle is π - φ/2.
    return 1.0 / math.tan(math.atan2(ax * by - ay * bx, ax * bx + ay * by) / 2.0)


def _off(edge: Edge, point: Vec2) -> float:
    """Distance of a point from the circle of an arc [m]."""
    centre, radius, *_ = arc(*edge)
    return abs(math.dist(centre, point) - radius)


def _heading(edge: Edge, *, end: bool) -> float:
    """Direction of an edge at its start or end [rad], counter-clockwise from x."""
    (x0, y0), (x1, y1), bulge = edge
    # The chord is turned from both tangents by half the arc's angle.
    half = 2.0 * math.atan(bulge)
    return math.atan2(y1 - y0, x1 - x0) + (half if end else -half)


def _turn(first: float, second: float) -> float:
    """Change of heading [rad], from -π to π; 0 where the edges are tangential."""
    turn = math.remainder(second - first, math.tau)
    return turn if abs(turn) > _SMOOTH else 0.0


def _trim(before: list[Edge], after: list[Edge], corner: Vec2) -> None:
    """Cut two paths where they meet, as near to their common corner as possible."""
    for i in reversed(range(len(before))):
        for j in range(len(after)):
            if points := _meetings(before[i], after[j]):
                point = min(points, key=lambda one: math.dist(one, corner))
                before[i:] = [_part(before[i], 0.0, _place(before[i], point), point)]
                after[: j + 1] = [_part(after[j], _place(after[j], point), 1.0, point)]
                return
    raise InputError(
        f"corner at ({MM * corner[0]:.4g}, {MM * corner[1]:.4g}) mm has an edge or a gap that is "
        f"narrower than the beam. Use a smaller kerf or a larger feature."
    )


def _part(edge: Edge, low: float, high: float, point: Vec2) -> Edge:
    """The stretch of an edge between two places on it, one of which is `point`."""
    start, end, bulge = edge
    bulge = math.tan((high - low) * math.atan(bulge))
    return (start, point, bulge) if low == 0.0 else (point, end, bulge)


def _place(edge: Edge, point: Vec2) -> float:
    """Place of a point on the line or circle of an edge: 0 at its start, 1 at its end."""
    (x0, y0), (x1, y1), bulge = edge
    if bulge == 0.0:
        dx, dy = x1 - x0, y1 - y0
        return ((point[0] - x0) * dx + (point[1] - y0) * dy) / (dx * dx + dy * dy)
    (x, y), _, first, span = arc(*edge)
    ahead = math.atan2(point[1] - y, point[0] - x) - first
    # The turn that is nearest to the arc's own stretch.
    return (math.remainder(ahead - span / 2.0, math.tau) + span / 2.0) / span


def _meetings(one: Edge, two: Edge) -> list[Vec2]:
    """Common points of two edges."""
    if one[2] == 0.0 and two[2] == 0.0:
        points = _on_line_and_line(one, two)
    elif one[2] == 0.0 or two[2] == 0.0:
        points = _on_line_and_circle(*((one, two) if one[2] == 0.0 else (two, one)))
    else:
        points = _on_circles(one, two)
    slack = 1e-9
    return [
        point
        for point in points
        if all(-slack <= _place(edge, point) <= 1.0 + slack for edge in (one, two))
    ]


def _on_line_and_line(one: Edge, two: Edge) -> list[Vec2]:
    (x0, y0), (x1, y1), _ = one
    (u0, v0), (u1, v1), _ = two
    across = (x1 - x0) * (v1 - v0) - (y1 - y0) * (u1 - u0)
    if abs(across) < 1e-20:
        return []
    share = ((u0 - x0) * (v1 - v0) - (v0 - y0) * (u1 - u0)) / across
    return [(x0 + share * (x1 - x0), y0 + share * (y1 - y0))]


def _on_line_and_circle(line: Edge, curve: Edge) -> list[Vec2]:
    (x0, y0), (x1, y1), _ = line
    (x, y), radius, *_ = arc(*curve)
    length = math.dist(*line[:2])
    tx, ty = (x1 - x0) / length, (y1 - y0) / length
    along = (x - x0) * tx + (y - y0) * ty
    foot = x0 + along * tx, y0 + along * ty
    reach = _leg(radius, math.dist(foot, (x, y)))
    return [(foot[0] + way * tx, foot[1] + way * ty) for way in reach]


def _on_circles(one: Edge, two: Edge) -> list[Vec2]:
    (x0, y0), r0, *_ = arc(*one)
    (x1, y1), r1, *_ = arc(*two)
    apart = math.dist((x0, y0), (x1, y1))
    if apart < SHORTEST:
        return []
    tx, ty = (x1 - x0) / apart, (y1 - y0) / apart
    along = (apart * apart + r0 * r0 - r1 * r1) / (2.0 * apart)
    foot = x0 + along * tx, y0 + along * ty
    return [(foot[0] - way * ty, foot[1] + way * tx) for way in _leg(r0, abs(along))]


def _leg(radius: float, distance: float) -> list[float]:
    """Both half lengths of a chord at a distance from the centre; a touching chord has none."""
    square = (radius - distance) * (radius + distance)
    return (
        []
        if square < -1e-12 * radius * radius
        else [w * math.sqrt(max(square, 0.0)) for w in (1.0, -1.0)]
    )


def _closed(edges: list[Edge], contour: Contour) -> Contour:
    """The contour of these edges, if it is simple."""
    kept = [edge for edge in edges if math.dist(edge[0], edge[1]) >= SHORTEST]
    try:
        path = Contour(tuple(edge[0] for edge in kept), tuple(edge[2] for edge in kept))
    except InputError:
        path = None
    if path is None or not path.polygon(1e-5).is_valid:
        raise InputError(
            f"{contour!r} has an edge or a gap that is narrower than the beam. Use a smaller kerf "
            f"or a larger feature."
        )
    return path
