"""Values with slopes by several parameters, in balls, and the largest value over a box.

The bound over a box is that of the mean value form (Moore 1966). A parameter whose slope has one
sign stands at one end of its span.
"""

import heapq
import math
from collections.abc import Callable, Sequence
from itertools import count
from typing import Any, NamedTuple

from stepwell.proof import balls
from stepwell.proof.balls import Ball, ball, hull

Span = tuple[Ball, Ball]
# Largest number of boxes of one search.
_MOST_BOXES = 3000


class Sloped:
    """A ball with balls of its slopes by parameters."""

    __slots__ = ("slopes", "value")

    def __init__(self, value: Ball, slopes: list[Ball]):
        self.value, self.slopes = value, slopes

    def __add__(self, other):
        if isinstance(other, Sloped):
            pairs = zip(self.slopes, other.slopes, strict=True)
            return Sloped(self.value + other.value, [a + b for a, b in pairs])
        return Sloped(self.value + other, self.slopes)

    __radd__ = __add__

    def __neg__(self):
        return Sloped(-self.value, [-a for a in self.slopes])

    def __sub__(self, other):
        return self + (-other)

    def __rsub__(self, other):
        return -self + other

    def __mul__(self, other):
        if isinstance(other, Sloped):
            a, b = self.value, other.value
            pairs = zip(self.slopes, other.slopes, strict=True)
            return Sloped(a * b, [x * b + a * y for x, y in pairs])
        return Sloped(self.value * other, [a * other for a in self.slopes])

    __rmul__ = __mul__

    def __truediv__(self, other):
        if isinstance(other, Sloped):
            ratio = self.value / other.value
            pairs = zip(self.slopes, other.slopes, strict=True)
            return Sloped(ratio, [(x - ratio * y) / other.value for x, y in pairs])
        return Sloped(self.value / other, [a / other for a in self.slopes])

    def __rtruediv__(self, other):
        ratio = other / self.value
        return Sloped(ratio, [-ratio * a / self.value for a in self.slopes])

    def by(self, value: Ball, slope: Ball) -> "Sloped":
        """A function of it, by the value and the slope of the function."""
        return Sloped(value, [slope * a for a in self.slopes])

    def sqrt(self) -> "Sloped":
        """Its square root."""
        root = self.value.sqrt()
        return self.by(root, 1 / (2 * root))

    def cos(self) -> "Sloped":
        """Its cosine."""
        return self.by(self.value.cos(), -self.value.sin())

    def sin(self) -> "Sloped":
        """Its sine."""
        return self.by(self.value.sin(), self.value.cos())


def parameters_in(values: Sequence[Ball]) -> list[Sloped]:
    """Each of the values as a parameter of its own."""
    n = len(values)
    ones = [[ball(float(k == i)) for k in range(n)] for i in range(n)]
    return [Sloped(value, slopes) for value, slopes in zip(values, ones, strict=True)]


class LargestValue(NamedTuple):
    """The largest value of a function over a box."""

    bound: Ball  # no value is above it
    attained: Ball  # a value, a ball around it
    at: list[float]  # the parameters there


Function = Callable[[Sequence[Ball]], Sloped | Ball]


def largest(f: Function, spans: Sequence[Span], enough: float) -> LargestValue:
    """The largest value of a function of parameters over spans, to `enough` where boxes suffice.

    Args:
        f: balls of the parameters to a value, with slopes by all parameters if it is `Sloped`.
        spans: the ends of each parameter, exact.
        enough: difference of bound and attained value at which the search ends.
    """
    search, number = _Search(f, spans), count()
    search.look(list(spans))
    while True:
        top, box, widest = search.waiting[0][2:]
        best = search.best
        assert best is not None
        spare = widest < 0 or not box[widest][1] > box[widest][0]
        if spare or top - balls.low(best) <= enough or next(number) > _MOST_BOXES:
            tops = [one[2] for one in search.waiting]
            return LargestValue(max([*tops, balls.high(best)]), best, search.at)
        heapq.heappop(search.waiting)
        a, b = box[widest]
        centre = balls.middle((a + b) / 2)
        for half in ((a, centre), (centre, b)):
            search.look([*box[:widest], half, *box[widest + 1 :]])


class _Search:
    """Boxes of parameters, that with the largest bound first, and the best value of a middle."""

    def __init__(self, f: Function, spans: Sequence[Span]):
        self._f, self._spans, self._number = f, spans, count()
        self.best: Ball | None = None
        self.at = [balls.number((a + b) / 2) for a, b in spans]
        self.waiting: list[tuple[float, int, Ball, list[Span], int]] = []

    def look(self, box: list[Span]) -> None:
        """Bound the values in a box, by its own ball and by the mean value form."""
        box, value = _collapsed(self._f, box)
        inside = self._centre(box)
        plain, steps = _value(value), list[float]()
        top = balls.high(plain) if plain.is_finite() else ball(math.inf)
        if isinstance(value, Sloped):
            pieces = [
                slope * ((b - a) / 2) * balls.UNIT
                for (a, b), slope in zip(box, value.slopes, strict=True)
            ]
            mean: Any = sum(pieces, inside)
            if mean.is_finite():
                top = min(top, balls.high(mean))
                steps = [float(piece.rad()) for piece in pieces]
        if not any(steps):
            whole = zip(box, self._spans, strict=True)
            steps = [float((b - a) / (q - p)) if q > p else 0.0 for (a, b), (p, q) in whole]
        widest = max(range(len(box)), key=steps.__getitem__) if box else -1
        heapq.heappush(self.waiting, (-float(top), next(self._number), top, box, widest))

    def _centre(self, box: list[Span]) -> Ball:
        """The value in the middle of a box, kept if it is the best."""
        middles = [balls.middle((a + b) / 2) for a, b in box]
        inside = _value(self._f(middles))
        best = self.best
        if best is None or inside > best or balls.number(inside) > balls.number(best):
            self.best, self.at = inside, [balls.number(middle) for middle in middles]
        return inside


def _value(value: Sloped | Ball) -> Ball:
    return value.value if isinstance(value, Sloped) else value


def _collapsed(f: Function, box: list[Span]) -> tuple[list[Span], Sloped | Ball]:
    """The part of a box that holds its largest value, by the signs of slopes, and f there."""
    while True:
        value = f([hull(a, b) for a, b in box])
        if not isinstance(value, Sloped):
            return box, value
        ends: list[Span] = []
        for (a, b), slope in zip(box, value.slopes, strict=True):
            ends.append(
                (b, b) if b > a and slope >= 0 else (a, a) if b > a and slope <= 0 else (a, b)
            )
        if ends == box:
            return box, value
        box = ends
