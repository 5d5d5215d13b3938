"""How a snap of several moving cells begins: the direction in which the flow leaves its rest.

Let w be a unit vector in the metric of mobilities, δ = p w + q with q ⟂ w, and J the symmetric
matrix of the flow with slopes κ anywhere in a box. Let w J w ≥ a, J ≤ b on all q ⟂ w, and let the
part of J w across w be at most c. Then |q|/p falls where it is above 2c/(a - b): so the flow is in
this cone.
"""

import math
from functools import reduce

import numpy as np

from stepwell.base import Floats
from stepwell.proof import balls
from stepwell.proof.balls import Ball, UndecidedError, ball, high, hull
from stepwell.proof.motion import largest_across
from stepwell.proof.walk import FOLD, EnclosedWalk

# Distances from the rest, as fractions of the least travel, at which the flow is looked for: from a
# fold it leaves slowly.
_WAYS, _FROM_FOLD = (1e-6, 1e-4, 1e-8), (3e-3, 1e-3, 1e-4, 1e-5)
_UNIT = ball(0.0, 1.0)
_CAUSE = "in which sense a snap begins"


def leave(walk: EnclosedWalk, direction: int, leader: int) -> tuple[dict[int, Ball], Ball]:
    """Travels shortly behind the start of a snap, and the distance of the flow to them.

    Args:
        walk: cells at rest, where the snap begins.
        direction: of the drive.
        leader: the cell that moves with it.

    Raises:
        UndecidedError: the direction is not proved.
    """
    moving = walk.active()
    if any(walk.cells[i].rubs for i in moving):
        raise UndecidedError("the landing of a snap of several cells with friction")
    size = min(walk.cells[i].size for i in moving)
    for way in _FROM_FOLD if walk.due == FOLD else _WAYS:
        try:
            return _at(walk, moving, (leader, direction), way * size)
        except UndecidedError:
            continue
    raise UndecidedError(_CAUSE)


def _at(walk: EnclosedWalk, moving: list[int], lead: tuple[int, int], way: float):
    """`leave` at one distance."""
    root = np.sqrt([walk.mobility[i] for i in moving])
    w = _direction(walk, moving, root, lead)
    spans = [hull(ball(0.0), ball(float(x * r * way * 1.5))) for x, r in zip(w, root, strict=True)]
    sides = np.where(w > 0, 1, -1).tolist()
    rows = zip(moving, spans, sides, strict=True)
    laws = [walk.cells[i].law(walk.stands[i].travel + span, side) for i, span, side in rows]
    cone = Cone([law[1] for law in laws], root, w)
    # Every travel leaves to the side of its component of w.
    if not cone.width < ball(0.25) or not all(cone.width < abs(float(x)) / 2 for x in w):
        raise UndecidedError(_CAUSE)
    if not (cone.growth > 0 or _bends_out(laws, root, w, cone.width)):
        raise UndecidedError(_CAUSE)
    level = reduce(hull, [law[0] for law in laws])
    if not all(walk.stays(i, level) for i in range(len(walk.cells)) if i not in moving):
        raise UndecidedError("a third cell is released at the beginning of the snap")
    return _places(walk, moving, w * root * way), high(cone.width * way)


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
    """

    def __init__(self, kappas: list[Ball], root: Floats, w: Floats):
        unit = [ball(float(r)) for r in root]
        d = [x * x * k for x, k in zip(unit, kappas, strict=True)]
        normal = _scaled(unit)
        # w within Σ √m w = 0, of length 1.
        along = _scaled(_without([ball(float(x)) for x in w], normal))
        turned = _without([-x * y for x, y in zip(d, along, strict=True)], normal)
        self.growth = _dot(turned, along)
        across = _length(_without(turned, along))
        gap = self.growth - largest_across(d, (normal, along), ball(0.0))
        if not gap > 2 * across:
            raise UndecidedError(_CAUSE)
        self.width = high(2 * across / gap)
        self._along, self._normal = along, normal

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
