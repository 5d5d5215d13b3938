"""How a snap of several moving cells begins: the direction in which the flow leaves its rest.

Where no law has a joint at the rest, and no cell that moves rubs, the flow is enclosed along a
curve that leaves the rest. Elsewhere it is enclosed in a cone. Let w be a unit vector in the metric
of mobilities, δ = p w + q with q ⟂ w, and J the symmetric matrix of the flow with slopes κ anywhere
in a box. Let w J w ≥ a, J ≤ b on all q ⟂ w, and let the part of J w across w be at most c. Then
|q|/p falls where it is above 2c/(a - b): so the flow is in this cone. Its velocities are in it too,
and keep their signs: then friction only shifts forces.
"""

import math
from functools import reduce
from typing import NamedTuple

import numpy as np
from flint import arb_poly  # pyright: ignore[reportMissingImports]

from stepwell.base import Floats
from stepwell.proof import balls
from stepwell.proof.balls import UNIT, Ball, UndecidedError, ball, high, hull
from stepwell.proof.motion import largest_across, length_of
from stepwell.proof.walk import FOLD, EnclosedWalk

# Distances from the rest, as fractions of the least travel, at which the flow is looked for: from a
# fold it leaves slowly.
_WAYS, _FROM_FOLD = (1e-6, 1e-4, 1e-8), (3e-3, 1e-3, 1e-4, 1e-5)
# Up to this many times as far, senses of sliding are looked for.
_FARTHER = 1e3, 100.0, 30.0, 10.0, 3.0, 1.0
# Degree of the curve, ends of it that are tried, and how near the flow has to be there.
_DEGREE, _ENOUGH = 12, 1e-11
_ALONG = (0.2, 0.1, 5e-2, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6)
# Largest distance of the flow to the curve, as a fraction of the way.
_NEAR = 1e-3
_CAUSE = "in which sense a snap begins"
# Cells that move, and those whose friction holds them.
_Cells = tuple[list[int], list[int]]


class Beginning(NamedTuple):
    """Where the flow of a snap is shortly behind its start.

    Attributes:
        places: travels of the cells that move.
        radius: the distance of the flow to them.
        box: travels within which each cell with friction slides on in its sense; None if it is
            known of none.
    """

    places: dict[int, Ball]
    radius: Ball
    box: dict[int, Ball] | None
    parts: "SplitRadius | None"


def leave(walk: EnclosedWalk, direction: int, leader: int) -> Beginning:
    """Travels shortly behind the start of a snap, and the distance of the flow to them.

    Cells that slide against friction, but that λ leaves behind at once, are held.

    Args:
        walk: cells at rest, where the snap begins.
        direction: of the drive.
        leader: the cell that moves with it.

    Raises:
        UndecidedError: the direction is not proved.
    """
    if not any(walk.cells[i].rubs for i in walk.active()):
        try:
            return _on_curve(walk, walk.active(), (leader, direction))
        except UndecidedError:
            pass
    moving, behind = _sliding_on(walk, (leader, direction))
    size = min(walk.cells[i].size for i in moving)
    for way in _FROM_FOLD if walk.due == FOLD else _WAYS:
        try:
            begun = _at(walk, (moving, behind), (leader, direction), way * size)
        except UndecidedError:
            continue
        for i in behind:
            walk.hold(i)
        return begun
    raise UndecidedError(_CAUSE)


def _sliding_on(walk: EnclosedWalk, lead: tuple[int, int]) -> _Cells:
    """Cells that move at the beginning, and those whose friction holds them: hints."""
    moving, behind = walk.active(), list[int]()
    while len(moving) > 1:
        w = _direction(walk, moving, _roots(walk, moving), lead)
        pairs = zip(moving, w.tolist(), strict=True)
        against = {i: x * walk.stands[i].sense for i, x in pairs if walk.stands[i].sense * x < 0.0}
        if not against:
            return moving, behind
        first = min(against, key=against.__getitem__)
        moving.remove(first)
        behind.append(first)
    raise UndecidedError(_CAUSE)


def _roots(walk: EnclosedWalk, moving: list[int]) -> Floats:
    return np.sqrt([walk.mobility[i] for i in moving])


def _enclosed(root: Floats) -> list[Ball]:
    """Balls around doubles of roots, which are off by half their last digit."""
    return [ball(r, 2.3e-16 * r) for r in root.tolist()]


def _on_curve(walk: EnclosedWalk, moving: list[int], lead: tuple[int, int]) -> Beginning:
    """`leave` on a curve, at the end that is the farthest one with the flow near enough."""
    root = _roots(walk, moving)
    w = None if walk.due == FOLD else _direction(walk, moving, root, lead)
    curve, best = _Curve(walk, moving, lead, w), None
    size = min(walk.cells[i].size for i in moving)
    for way in _ALONG:
        try:
            end = curve.end(way * size)
        except UndecidedError:
            continue
        if best is None or end.part < best.part:
            best = end
        if best.part < _ENOUGH:
            break
    if best is None:
        raise UndecidedError(_CAUSE)
    return Beginning(best.places, best.radius, None, None)


def _at(walk: EnclosedWalk, cells: _Cells, lead: tuple[int, int], way: float) -> Beginning:
    """`leave` at one distance."""
    moving, behind = cells
    root = _roots(walk, moving)
    w = _direction(walk, moving, root, lead)
    laws, cone = _cone_up_to(walk, moving, w, way)
    # Every travel leaves to the side of its component of w.
    if not cone.width < ball(0.25) or not all(cone.width < abs(float(x)) / 2 for x in w):
        raise UndecidedError(_CAUSE)
    if not (cone.growth > 0 or (not behind and _bends_out(laws, root, w, cone.width))):
        raise UndecidedError(_CAUSE)
    level = reduce(hull, [law[0] + walk.offset(i) for i, law in zip(moving, laws, strict=True)])
    held = [i for i in range(len(walk.cells)) if i not in (*moving, *behind)]
    if not all(walk.stays(i, level) for i in held):
        raise UndecidedError("a third cell is released at the beginning of the snap")
    if behind:
        _stay_behind(walk, cells, cone, level)
    ways, radius, off = _nearer(walk, moving, w, cone, way)
    places, box = _places(walk, moving, ways), None
    if any(walk.cells[i].rubs for i in moving):
        box = _box(walk, moving, w, way)
    return Beginning(places, radius, box, SplitRadius(moving, root, w, (off, radius)))


class SplitRadius:
    """A radius in two parts: along w, and across it, where a flow falls back.

    For two flows that part by p w + q, |p|' ≤ a |p| + c |q| and |q|' ≤ b |q| + c |p|.
    """

    def __init__(self, cells: list[int], root: Floats, w: Floats, parts: tuple[Ball, Ball]):
        self.cells, self._root, self._w = cells, root, w
        self.along, self.across = parts

    def later(self, kappas: list[Ball], h: float, most: tuple[Ball, Ball]) -> "SplitRadius":
        """The parts after a time.

        Args:
            kappas: all slopes in the tube.
            h: the time [s].
            most: the radius of the tube, and the defect.
        """
        cone, (radius, defect) = Cone(kappas, self._root, self._w), most
        if not cone.fall < 0:
            raise UndecidedError(_CAUSE)
        gone = cone.across * radius + defect
        least, most_along = self.across + h * gone, high(self.along + h * gone)
        grown = (max(high(cone.growth), ball(0.0)) * h).exp()
        along = high(grown * (self.along + h * (cone.across * least + defect)))
        fallen = (cone.fall * h).exp()
        across = fallen * self.across + h * (cone.across * grown * most_along + defect)
        return SplitRadius(self.cells, self._root, self._w, (along, high(across)))

    def wider(self, by: Ball) -> "SplitRadius":
        """Both parts larger by a way."""
        parts = high(self.along + by), high(self.across + by)
        return SplitRadius(self.cells, self._root, self._w, parts)

    def has_fallen(self) -> bool:
        """Whether the part across w is no longer the larger one."""
        return bool(self.across < self.along)

    def radius(self) -> Ball:
        """Of both parts together."""
        return length_of([self.along, self.across])


def _nearer(
    walk: EnclosedWalk, moving: list[int], w: Floats, cone: "Cone", way: float
) -> tuple[Floats, Ball, Ball]:
    """Ways to a place at a distance along w, how far the flow is from it, and how far along w.

    At the place the velocity is about along w. That of the flow is in the cone: so they differ by
    little, and where the flow falls back across w, the places do too.
    """
    root, at = _roots(walk, moving), w * way
    # A double of a way is off by its last digit.
    off = cone.off + 1e-15
    known = at * root, high((cone.width + off) * way), high(off * way)
    if len(moving) < 3 or not cone.fall < 0:
        return known
    across = np.linalg.svd(np.vstack([root / np.linalg.norm(root), w]))[2][2:].T
    begin = [walk.stands[i].travel for i in moving]
    for _ in range(4):
        ways = [s + ball(x) for s, x in zip(begin, (at * root).tolist(), strict=True)]
        rates = np.array([balls.number(x) for x in _pulls(walk, moving, ways)]) * root
        slopes = [balls.number(walk.cells[i].law(s)[1]) for i, s in zip(moving, ways, strict=True)]
        matrix = across.T @ np.diag(root**2 * slopes) @ across
        if not (np.all(np.isfinite(matrix)) and np.linalg.det(matrix)):
            return known
        at = at + across @ np.linalg.solve(matrix, across.T @ rates)
    place = cone.at(at, way)
    unit = _enclosed(root)
    ways = [s + r * x for s, r, x in zip(begin, unit, place, strict=True)]
    pulls = zip(unit, _pulls(walk, moving, ways), strict=True)
    radius = cone.distance(place, [r * x for r, x in pulls], way)
    off = length_of([x - ball(y) for x, y in zip(place, at.tolist(), strict=True)])
    off = high(off + 1e-15 * way)
    radius = high(radius + off)
    return (at * root, radius, off) if radius < known[1] else known


def _pulls(walk: EnclosedWalk, moving: list[int], travels: list[Ball]) -> list[Ball]:
    """The forces of the start less those of cells."""
    pairs = zip(moving, travels, strict=True)
    return [walk.force - walk.offset(i) - walk.cells[i].law(s)[0] for i, s in pairs]


def _cone_up_to(walk: EnclosedWalk, moving: list[int], w: Floats, way: float):
    """Laws of cells on the way along w, on the sides to which they go, and the cone there."""
    root = _roots(walk, moving)
    spans = _spans(walk, moving, w * root * way * 1.5)
    sides = np.where(w > 0, 1, -1).tolist()
    laws = [walk.cells[i].law(spans[i], side) for i, side in zip(moving, sides, strict=True)]
    return laws, Cone([law[1] for law in laws], root, w)


def _spans(walk: EnclosedWalk, moving: list[int], ways: Floats) -> dict[int, Ball]:
    """Travels from the start on."""
    pairs = zip(moving, ways.tolist(), strict=True)
    return {i: walk.stands[i].travel + hull(ball(0.0), ball(way)) for i, way in pairs}


def _stay_behind(walk: EnclosedWalk, cells: _Cells, cone: "Cone", level: Ball) -> None:
    """Prove that λ leaves cells behind at the edges of their friction, and no other way is open."""
    for i in cells[1]:
        sense = walk.stands[i].sense
        other = walk.window(i)[0 if sense > 0 else 1]
        if not (sense * cone.rise < 0 and (other is None or sense * (level - other) > 0)):
            raise UndecidedError(_CAUSE)
    slopes = [walk.cells[i].law(walk.stands[i].travel)[1] for i in cells[1]]
    if not cone.is_only(slopes, _roots(walk, cells[1])):
        raise UndecidedError(_CAUSE)


def _box(walk: EnclosedWalk, moving: list[int], w: Floats, way: float) -> dict[int, Ball]:
    """The travels up to which velocities stay in a cone in which no sense changes."""
    root = _roots(walk, moving)
    rubs = [float(abs(x)) for i, x in zip(moving, w, strict=True) if walk.cells[i].rubs]
    for factor in _FARTHER:
        ways = w * root * way * factor
        try:
            _places(walk, moving, ways * 1.5)
            cone = _cone_up_to(walk, moving, w, way * factor)[1]
        except UndecidedError:
            continue
        if all(cone.width < x for x in rubs):
            return _spans(walk, moving, ways * 1.5)
    raise UndecidedError(_CAUSE)


def _places(walk: EnclosedWalk, moving: list[int], ways: Floats) -> dict[int, Ball]:
    """Travels behind the start, between the stops."""
    pairs = zip(moving, ways.tolist(), strict=True)
    places = {i: walk.stands[i].travel + ball(way) for i, way in pairs}
    if not all(s > walk.cells[i].low and s < walk.cells[i].high for i, s in places.items()):
        raise UndecidedError(_CAUSE)
    return places


def _direction(
    walk: EnclosedWalk, moving: list[int], root: Floats, lead: tuple[int, int]
) -> Floats:
    """The direction of the largest rate, by the slopes on the sides to which it goes."""
    j, direction = moving.index(lead[0]), lead[1]
    sides = np.full(len(moving), -float(direction))
    sides[j] = direction
    for _ in range(4):
        pairs = zip(moving, sides.tolist(), strict=True)
        slopes = [
            balls.number(walk.cells[i].law(walk.stands[i].travel, int(side))[1])
            for i, side in pairs
        ]
        values, vectors = np.linalg.eigh(_matrix(slopes, root))
        w = vectors[:, int(np.argmax(values))]
        w = w * np.sign(w[j]) * direction
        if np.array_equal(np.sign(w), sides) or not np.all(w):
            return w
        sides = np.sign(w)
    raise UndecidedError(_CAUSE)


def _bends_out(laws: list[tuple[Ball, ...]], root: Floats, w: Floats, width: Ball) -> bool:
    """Whether the flow grows along w where its rate is 0 at the rest, as at a fold.

    Then w v = -1/2 Σ w_i √m_i κ_i' δ_i², with δ_i = √m_i w_i p to a fraction 2 |q|/(p |w_i|).
    """
    total = ball(0.0)
    for (_, _, bend), r, x in zip(laws, _enclosed(root), w.tolist(), strict=True):
        part = x * r * (1 + UNIT * (2 * width / abs(x)))
        total = total - bend * part * part * part
    return bool(total > 0)


def _matrix(kappas: list[float], root: Floats) -> Floats:
    """-P diag(m κ) P with P = 1 - n nᵀ, and a far negative value for n itself."""
    n = root / np.linalg.norm(root)
    p = np.eye(len(root)) - np.outer(n, n)
    far = 10.0 * max(1e-300, *(abs(k) for k in kappas)) * float(np.max(root)) ** 2
    return -p @ np.diag(root**2 * kappas) @ p - far * np.outer(n, n)


class Cone:
    """The cone around w in which the flow is, for all slopes in balls.

    Attributes:
        growth: w J w.
        across, fall: upper bounds of the part of J w across w, and of J across w.
        width: an upper bound of |q|/p.
        off: the distance of w to the unit vector that is used.
    """

    def __init__(self, kappas: list[Ball], root: Floats, w: Floats):
        if not all(k.is_finite() for k in kappas):
            raise UndecidedError(_CAUSE)
        unit = _enclosed(root)
        d = [x * x * k for x, k in zip(unit, kappas, strict=True)]
        normal = _scaled(unit)
        # w within Σ √m w = 0, of length 1.
        given = [ball(float(x)) for x in w]
        along = _scaled(_without(given, normal))
        self.off = length_of([x - y for x, y in zip(given, along, strict=True)])
        turned = _without([-x * y for x, y in zip(d, along, strict=True)], normal)
        self.growth = _dot(turned, along)
        self.across = length_of(_without(turned, along))
        self.fall = largest_across(d, (normal, along), ball(0.0))
        gap = self.growth - self.fall
        if not gap > 2 * self.across:
            raise UndecidedError(_CAUSE)
        self.width = high(2 * self.across / gap)
        self._along, self._normal, self._unit, self._d = along, normal, unit, d
        # The rate of λ along p, to a positive factor.
        rows = zip(d, unit, along, strict=True)
        self.rise = sum((x * r * (y + self.width * UNIT) for x, r, y in rows), ball(0.0))

    def is_only(self, kappas: list[Ball], root: Floats) -> bool:
        """Whether the flow falls back in all directions but w, with further cells too."""
        more = _enclosed(root)
        d = [*self._d, *(r * r * k for r, k in zip(more, kappas, strict=True))]
        normal, along = _scaled([*self._unit, *more]), [*self._along, *(ball(0.0) for _ in more)]
        return bool(largest_across(d, (normal, along), ball(0.0)) < 0)

    def at(self, near: Floats, p: float) -> list[Ball]:
        """The place next to a given one whose distance along w is exact, and whose sum is 0."""
        q = _without(_without([ball(x) for x in near.tolist()], self._normal), self._along)
        return [ball(p) * x + y for x, y in zip(self._along, q, strict=True)]

    def distance(self, place: list[Ball], rates: list[Ball], p: float) -> Ball:
        """How far the flow is from a place at the same distance along w; infinite if not known.

        Args:
            place: from `at`.
            rates: the velocity there, to a part along the normal.
            p: the distance along w.
        """
        if not length_of(_without(place, self._along)) <= self.width * p:
            return ball(math.inf)
        inside = _without(rates, self._normal)
        along, across = _dot(inside, self._along), length_of(_without(inside, self._along))
        rest = -self.fall - self.width * self.across
        return high((self.width * abs(along) + across) / rest) if rest > 0 else ball(math.inf)

    def apart(self, rates: list[Ball]) -> Ball:
        """An upper bound of |q|/p of a vector; infinite where p may be 0."""
        inside = _without(rates, self._normal)
        p = balls.low(abs(_dot(inside, self._along)))
        if not p > 0:
            return ball(math.inf)
        return high(length_of(_without(inside, self._along)) / p)


def slowest(kappas: list[float], root: Floats) -> Floats:
    """The unit vector of the largest rate of a flow with given slopes."""
    values, vectors = np.linalg.eigh(_matrix(kappas, root))
    return vectors[:, int(np.argmax(values))]


def _dot(a: list[Ball], b: list[Ball]) -> Ball:
    return sum((x * y for x, y in zip(a, b, strict=True)), ball(0.0))


def _scaled(a: list[Ball]) -> list[Ball]:
    length = _dot(a, a).sqrt()
    return [x / length for x in a]


def _without(a: list[Ball], unit: list[Ball]) -> list[Ball]:
    """A vector without its part along a unit vector."""
    part = _dot(a, unit)
    return [x - part * y for x, y in zip(a, unit, strict=True)]


# Along a curve.


class _End(NamedTuple):
    """A place on the curve, and the distance of the flow to it, as a fraction of the way too."""

    places: dict[int, Ball]
    radius: Ball
    part: Ball


class _Curve:
    """The curve p w + φ(p) behind a rest, with φ a polynomial across w; coordinates are δ_i/√m_i.

    Let D be its defect across w. Let J ≤ b on all vectors across w, and let the part of J w across
    w be at most c, for all slopes in a box. Then the flow is within D(p)/β of the curve, with
    β = -b - c |φ'|, as long as p rises (theory page, "Proofs").

    Args:
        walk: cells without friction at rest, where the snap begins.
        moving: the cells that move.
        lead: one of them, and the direction in which it moves.
        w: the direction of the largest rate; None at a fold.
    """

    def __init__(self, walk: EnclosedWalk, moving: list[int], lead, w: Floats | None):
        self.walk, self.moving, self.fold = walk, moving, w is None
        self.cells = [walk.cells[i] for i in moving]
        self.rest = [walk.stands[i].travel for i in moving]
        self.m = [ball(walk.mobility[i]) for i in moving]
        self.root = [m.sqrt() for m in self.m]
        self.normal = _scaled(self.root)
        self.w = self._null_vector(lead) if w is None else self._unit(w)
        self.thin = [self._taylor(i, s) for i, s in enumerate(self.rest)]
        self.phi = [self._across([ball(x) for x in row]) for row in self._series()]

    def _taylor(self, i: int, s: Ball) -> list[Ball]:
        terms = self.cells[i].taylor(s, _DEGREE + 1)
        if terms is None or not all(x.is_finite() for x in terms):
            raise UndecidedError("a joint of a law at the beginning of a snap")
        return terms

    def _null_vector(self, lead: tuple[int, int]) -> list[Ball]:
        """w at a fold: there Σ 1/κ = 0, and travels by 1/κ leave all forces equal."""
        j, direction = self.moving.index(lead[0]), lead[1]
        ways = [1 / cell.law(s)[1] for cell, s in zip(self.cells, self.rest, strict=True)]
        ways[j] = -sum((x for i, x in enumerate(ways) if i != j), ball(0.0))
        if not all(x > 0 or x < 0 for x in ways):
            raise UndecidedError(_CAUSE)
        sign = direction if ways[j] > 0 else -direction
        return _scaled([sign * x / r for x, r in zip(ways, self.root, strict=True)])

    def _unit(self, w: Floats) -> list[Ball]:
        return _scaled(_without([ball(float(x)) for x in w], self.normal))

    def _across(self, x: list[Ball]) -> list[Ball]:
        """The part of a vector across w, with a sum of travels of zero."""
        return _without(_without(x, self.normal), self.w)

    def _series(self) -> list[list[float]]:
        """The coefficients of φ from the second one on, nearly: those that leave no defect."""
        root, w, n = (np.array([*map(balls.number, x)]) for x in (self.root, self.w, self.normal))
        laws = [[balls.number(x) for x in law] for law in self.thin]
        slopes = root**2 * [law[1] for law in laws]
        rate = -float(np.sum(w * slopes * w))
        q = np.eye(len(w)) - np.outer(n, n) - np.outer(w, w)
        jacobian = -q @ np.diag(slopes) @ q - (np.eye(len(w)) - q) * float(np.max(abs(slopes)))
        phi = np.zeros((_DEGREE + 1, len(w)))
        phi[1] = w
        growth = np.zeros(_DEGREE + 1)
        growth[1] = rate
        for k in range(2, _DEGREE + 1):
            rows = [_composed(law, phi[: k + 1, i] * root[i])[k] for i, law in enumerate(laws)]
            forces = -root * rows
            growth[k] = float(w @ forces)
            known = sum((j * phi[j] * growth[k - j + 1] for j in range(2, k)), np.zeros(len(w)))
            try:
                phi[k] = np.linalg.solve(jacobian - k * rate * q, known - q @ forces)
            except np.linalg.LinAlgError:
                raise UndecidedError(_CAUSE) from None
        return phi[2:].tolist()

    def end(self, way: float) -> _End:
        """The end of the curve at a way p."""
        p = ball(way)
        within, near = hull(ball(0.0), p), high(p * _NEAR)
        rows = [[ball(0.0), x, *bend] for x, *bend in zip(self.w, *self.phi, strict=True)]
        ways = [arb_poly([r * c for c in row]) for r, row in zip(self.root, rows, strict=True)]
        box = [
            s + along(within) + near * r * UNIT
            for s, along, r in zip(self.rest, ways, self.root, strict=True)
        ]
        fall, across = self._fall(rows, box, p)
        defect, growth = self._defect(rows, ways, box)
        first = 2 if self.fold else 1
        radius = high(_size_of(defect, p) / fall)
        less = [abs(g) * p ** (k - first) for k, g in enumerate(growth) if k > first]
        if not (growth[first] > sum(less, across * radius / p**first) and radius < near):
            raise UndecidedError(_CAUSE)
        self._stays_between(rows, box, p, radius / p)
        self._holds(box)
        places = {i: s + along(p) for i, s, along in zip(self.moving, self.rest, ways, strict=True)}
        return _End(places, radius, high(radius / p))

    def _fall(self, rows: list[list[Ball]], box: list[Ball], p: Ball) -> tuple[Ball, Ball]:
        """β, proved to be positive, and c, for all slopes in a box."""
        slopes = [m * c.law(s)[1] for m, c, s in zip(self.m, self.cells, box, strict=True)]
        if not all(x.is_finite() for x in slopes):
            raise UndecidedError(_CAUSE)
        turned = [-k * x for k, x in zip(slopes, self.w, strict=True)]
        across = length_of(self._across(turned))
        # |φ'| up to p.
        turn = p * _size_of([[k * c for k, c in enumerate(row)][2:] for row in rows], p)
        fall = -largest_across(slopes, (self.normal, self.w), ball(0.0)) - across * turn
        if not fall > 0:
            raise UndecidedError(_CAUSE)
        return fall, across

    def _defect(self, rows, ways, box) -> tuple[list[list[Ball]], list[Ball]]:
        """The coefficients of D for each cell, and those of p' on the curve.

        Nothing moves at the rest, and at a fold the first slopes are those of a flow without rate.
        """
        forces = []
        for i, (thin, way) in enumerate(zip(self.thin, ways, strict=True)):
            total = arb_poly([self._taylor(i, box[i])[-1]])
            for c in reversed(thin[1:-1]):
                total = total * way + c
            forces.append(total * way * -self.root[i])
        none = arb_poly([])
        mean = sum((f * n for f, n in zip(forces, self.normal, strict=True)), none)
        growth = sum((f * w for f, w in zip(forces, self.w, strict=True)), none)
        out = []
        for f, n, row in zip(forces, self.normal, rows, strict=True):
            out.append(_coefficients(f - mean * n - growth * arb_poly(row).derivative()))
        growth = _coefficients(growth)
        if self.fold:
            growth[1] = ball(0.0)
            for one in out:
                one[1] = ball(0.0)
        return out, growth

    def _stays_between(self, rows, box, p: Ball, part: Ball) -> None:
        """Prove that no cell touches a stop on the way; one that starts there leaves it."""
        for cell, s, row, at in zip(self.cells, self.rest, rows, box, strict=True):
            if at > cell.low and at < cell.high:
                continue
            if not (s >= cell.low and s <= cell.high):
                raise UndecidedError(_CAUSE)
            bends = sum((abs(c) * p ** (k - 1) for k, c in enumerate(row) if k > 1), part)
            inside = (at < cell.high and row[1] > bends) or (at > cell.low and -row[1] > bends)
            if not inside:
                raise UndecidedError(_CAUSE)

    def _holds(self, box: list[Ball]) -> None:
        level = reduce(hull, [cell.law(s)[0] for cell, s in zip(self.cells, box, strict=True)])
        walk = self.walk
        if not all(walk.stays(i, level) for i in range(len(walk.cells)) if i not in self.moving):
            raise UndecidedError("a third cell is released at the beginning of the snap")


def _composed(law: list[float], way: Floats) -> Floats:
    """A power series of another one without a constant term, as long as that one."""
    total = np.zeros(len(way))
    for c in reversed(law):
        total = np.convolve(total, way)[: len(way)]
        total[0] += c
    return total


def _coefficients(poly) -> list[Ball]:
    out = [poly[k] for k in range(len(poly))]
    return out + [ball(0.0)] * (2 - len(out))


def _size_of(rows: list[list[Ball]], p: Ball) -> Ball:
    """A bound of the length of a vector of polynomials, up to p."""
    sizes = [sum((abs(c) * p**k for k, c in enumerate(row)), ball(0.0)) for row in rows]
    return length_of([high(x) for x in sizes])
