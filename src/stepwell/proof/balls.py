"""Balls of real numbers, and proofs about functions on them: signs, first zeros, roots.

A function here takes a ball and returns balls that contain its value and its slope everywhere on
it. Ball arithmetic is that of Arb (Johansson 2017), as of python-flint: it rounds outwards.
"""

from collections.abc import Callable
from typing import Any

from stepwell import base

base.need("proof")

from flint import arb, ctx  # noqa: E402  # pyright: ignore[reportMissingImports]

# Bits of the midpoints; rounding is then 1e-14 of that of doubles.
ctx.prec = 100
# Terms of power series: without it, python-flint leaves out those from the tenth on.
ctx.cap = 32
# Boxes narrower than this fraction of the first one are not divided.
_NARROW = 1e-22
# Widest ball around a kink or a jump, in these: turns of a force are known to 1e-13 of the travel.
_JUMP = 1e11
# Largest number of boxes of one cover.
_MOST_BOXES = 4000

Ball = Any
Smooth = Callable[[Ball], tuple[Ball, Ball]]


class UndecidedError(Exception):
    """A condition that is not proved.

    Args:
        cause: the condition.
        size: by how much it is missed, in its own unit; None if it has no size.
    """

    def __init__(self, cause: str, size: float | None = None):
        super().__init__(cause)
        self.cause, self.size = cause, size


def ball(value: float, radius: float = 0.0) -> Ball:
    """The ball of all numbers within a radius of a value."""
    return arb(value, radius) if radius else arb(value)


# All numbers from -1 to 1.
UNIT = ball(0.0, 1.0)


def hull(a: Ball, b: Ball) -> Ball:
    """The least ball around two."""
    return a.union(b)


def low(x: Ball) -> Ball:
    """Its lower end, exact."""
    return x.lower().mid()


def high(x: Ball) -> Ball:
    """Its upper end, exact."""
    return x.upper().mid()


def middle(x: Ball) -> Ball:
    """Its middle, exact."""
    return x.mid()


def number(x: Ball) -> float:
    """The double nearest to its middle."""
    return float(x.mid())


def distance(x: Ball, value: float) -> float:
    """An upper bound of the distance of any number of the ball to a value."""
    return float((x - value).abs_upper()) * (1.0 + 1e-15)


def positive(f: Smooth, a: Ball, b: Ball) -> bool:
    """Whether f > 0 is proved on [a, b]; False where a value is proved not to be."""
    waiting, seen, least = [(low(a), high(b))], 0, abs(b - a) * _NARROW
    while waiting:
        a, b = waiting.pop()
        seen += 1
        if _is_positive(f, a, b):
            continue
        centre = middle((a + b) / 2)
        if f(centre)[0] <= 0:
            return False
        if seen > _MOST_BOXES or not b - a > least:
            raise UndecidedError("a sign is too near to zero")
        waiting += [(centre, b), (a, centre)]
    return True


def _is_positive(f: Smooth, a: Ball, b: Ball) -> bool:
    value, slope = f(hull(a, b))
    if value > 0:
        return True
    if slope >= 0:
        return bool(f(a)[0] > 0)
    return bool(slope <= 0 and f(b)[0] > 0)


def covered(holds: Callable[[Ball], bool], a: Ball, b: Ball) -> bool:
    """Whether [a, b] is covered by boxes on each of which a condition holds."""
    waiting, seen = [(a, b)], 0
    while waiting:
        a, b = waiting.pop()
        seen += 1
        if holds(hull(a, b)):
            continue
        if seen > _MOST_BOXES:
            return False
        centre = middle((a + b) / 2)
        waiting += [(centre, b), (a, centre)]
    return True


def first_zero(f: Smooth, a: Ball, b: Ball) -> Ball | None:
    """The first zero of a function that is positive at a; None if it is positive on [a, b].

    Proved: f > 0 before the ball, f < 0 just after it; f falls on it, so it holds one zero. At a
    kink or a jump of f it may hold more, within 1e-11 of the way.
    """
    waiting, seen, least = [(a, b)], 0, abs(b - a) * _NARROW
    while waiting:
        a, b = waiting.pop()
        seen += 1
        value, slope = f(hull(a, b))
        if value > 0 or (slope >= 0 and f(a)[0] > 0):
            continue
        if slope < 0:
            end = f(b)[0]
            if end > 0:
                continue
            if end < 0 and f(a)[0] > 0:
                return _narrowed(f, a, b)
        narrow = not b - a > least
        if narrow and (end := _after_jump(f, a, least)) is not None:
            return hull(a, end)
        if narrow or seen > _MOST_BOXES:
            raise UndecidedError("a zero is not single, or its sign is too near to zero")
        centre = middle((a + b) / 2)
        waiting += [(centre, b), (a, centre)]
    return None


def _after_jump(f: Smooth, a: Ball, least: Ball) -> Ball | None:
    """A place shortly behind a, up to which f is positive, where f < 0 is proved; None without."""
    if not least > 0:
        return None
    way = least
    while way < least * _JUMP:
        if f(middle(a + way))[0] < 0:
            return middle(a + way)
        way = way * 8
    return None


def _narrowed(f: Smooth, a: Ball, b: Ball) -> Ball:
    """Interval Newton for a falling f with f(a) > 0 > f(b); bisection where it does not help."""
    inside, least = hull(a, b), abs(b - a) * _NARROW
    for _ in range(200):
        centre = middle(inside)
        value, slope = f(centre)[0], f(inside)[1]
        image = centre - value / slope
        if slope < 0 and image.is_finite() and image.rad() < inside.rad() / 2:
            inside = image.intersection(inside)
        elif value > 0 and inside.rad() > least:
            inside = hull(centre, high(inside))
        elif value < 0 and inside.rad() > least:
            inside = hull(low(inside), centre)
        else:
            break
    return inside
