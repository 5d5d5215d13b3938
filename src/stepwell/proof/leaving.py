"""How a snap of several moving cells begins: the direction in which the flow leaves its rest.

Let w be a unit vector in the metric of mobilities, δ = p w + q with q ⟂ w, and J the symmetric
matrix of the flow with slopes κ anywhere in a box. Let w J w ≥ a, J ≤ b on all q ⟂ w, and let the
part of J w across w be at most c. Then |q|/p falls where it is above 2c/(a - b): so the flow is in
this cone. Its velocities are in it too, and keep their signs: then friction only shifts forces.
"""

import math
from functools import reduce
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats
from stepwell.proof import balls
from stepwell.proof.balls import Ball, UndecidedError, ball, high, hull
from stepwell.proof.motion import largest_across
from stepwell.proof.walk import FOLD, EnclosedWalk

# Distances from the rest, as fractions of the least travel, at which the flow is looked for: from a
# fold it leaves slowly.
_WAYS, _FROM_FOLD = (1e-6, 1e-4, 1e-8), (3e-3, 1e-3, 1e-4, 1e-5)
# Up to this many times as far, senses of sliding are looked for.
_FARTHER = 1e3, 100.0, 30.0, 10.0, 3.0, 1.0
_UNIT = ball(0.0, 1.0)
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
    places, box = _places(walk, moving, w * root * way), None
    if any(walk.cells[i].rubs for i in moving):
        box = _box(walk, moving, w, way)
    return Beginning(places, high((cone.width + cone.off) * way), box)


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
    for (_, _, bend), r, x in zip(laws, root.tolist(), w.tolist(), strict=True):
        part = ball(x) * r * (1 + _UNIT * (2 * width / abs(x)))
        total = total - ball(x) * r * (1 + _UNIT * (2 * width / abs(x))) * bend * part * part
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
        width: an upper bound of |q|/p.
        off: the distance of w to the unit vector that is used.
    """

    def __init__(self, kappas: list[Ball], root: Floats, w: Floats):
        if not all(k.is_finite() for k in kappas):
            raise UndecidedError(_CAUSE)
        unit = [ball(float(r)) for r in root]
        d = [x * x * k for x, k in zip(unit, kappas, strict=True)]
        normal = _scaled(unit)
        # w within Σ √m w = 0, of length 1.
        given = [ball(float(x)) for x in w]
        along = _scaled(_without(given, normal))
        self.off = _length([x - y for x, y in zip(given, along, strict=True)])
        turned = _without([-x * y for x, y in zip(d, along, strict=True)], normal)
        self.growth = _dot(turned, along)
        across = _length(_without(turned, along))
        gap = self.growth - largest_across(d, (normal, along), ball(0.0))
        if not gap > 2 * across:
            raise UndecidedError(_CAUSE)
        self.width = high(2 * across / gap)
        self._along, self._normal, self._unit, self._d = along, normal, unit, d
        # The rate of λ along p, to a positive factor.
        rows = zip(d, unit, along, strict=True)
        self.rise = sum((x * r * (y + self.width * _UNIT) for x, r, y in rows), ball(0.0))

    def is_only(self, kappas: list[Ball], root: Floats) -> bool:
        """Whether the flow falls back in all directions but w, with further cells too."""
        more = [ball(float(r)) for r in root]
        d = [*self._d, *(r * r * k for r, k in zip(more, kappas, strict=True))]
        normal, along = _scaled([*self._unit, *more]), [*self._along, *(ball(0.0) for _ in more)]
        return bool(largest_across(d, (normal, along), ball(0.0)) < 0)

    def apart(self, rates: list[Ball]) -> Ball:
        """An upper bound of |q|/p of a vector; infinite where p may be 0."""
        inside = _without(rates, self._normal)
        p = balls.low(abs(_dot(inside, self._along)))
        if not p > 0:
            return ball(math.inf)
        return high(_length(_without(inside, self._along)) / p)


def slowest(kappas: list[float], root: Floats) -> Floats:
    """The unit vector of the largest rate of a flow with given slopes."""
    values, vectors = np.linalg.eigh(_matrix(kappas, root))
    return vectors[:, int(np.argmax(values))]


def _dot(a: list[Ball], b: list[Ball]) -> Ball:
    return sum((x * y for x, y in zip(a, b, strict=True)), ball(0.0))


def _length(a: list[Ball]) -> Ball:
    return high(high(_dot(a, a)).sqrt())


def _scaled(a: list[Ball]) -> list[Ball]:
    length = _dot(a, a).sqrt()
    return [x / length for x in a]


def _without(a: list[Ball], unit: list[Ball]) -> list[Ball]:
    """A vector without its part along a unit vector."""
    part = _dot(a, unit)
    return [x - part * y for x, y in zip(a, unit, strict=True)]
