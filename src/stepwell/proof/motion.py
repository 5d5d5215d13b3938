"""The middle of a tube around a flow: Taylor polynomials of travels, their defect, and rates.

Rates are those at which two flows part at most: largest values of quadratic forms, proved.
"""

import math
from collections.abc import Mapping, Sequence
from functools import reduce
from typing import Any

import numpy as np
from flint import arb_series  # pyright: ignore[reportMissingImports]

from stepwell.proof import balls
from stepwell.proof.balls import UNIT, Ball, UndecidedError, ball, high, hull, low
from stepwell.proof.laws import EnclosedCell

# Degree of the polynomials.
DEGREE = 7
_QUARTER = ball(0.25)


class FlowMotion:
    """Taylor polynomials in time of the travels of cells that move, with float coefficients.

    Attributes:
        travel: the coefficients of each.
        force: those of λ.
        missed: a bound of what they miss of λ, of the last step that `defect` saw.
        slip: a bound of the sum of all velocities in it.
        off: a bound of what the sum of all travels misses of the stroke in it.
    """

    def __init__(
        self,
        cells: Sequence[EnclosedCell],
        mobility: Sequence[float],
        at: dict[int, float],
        shifts: Mapping[int, Ball],
    ):
        self.cells, self.m, self.shifts = cells, mobility, shifts
        mass = sum(mobility[i] for i in at)
        laws = {i: arb_series(self._taylor(i, ball(s)), DEGREE + 1) for i, s in at.items()}
        self._laws = laws
        self.travel: dict[int, list[float]] = {i: [0.0] for i in at}
        self.force: list[float] = []
        self.missed = self.slip = self.off = ball(0.0, math.inf)
        for k in range(DEGREE):
            now = {i: float(_composed(laws[i], self.travel[i], k + 1)[k].mid()) for i in at}
            level = sum(mobility[i] * f for i, f in now.items()) / mass
            self.force.append(level)
            for i, f in now.items():
                self.travel[i].append(mobility[i] * (level - f) / (k + 1))
        for i, s in at.items():
            self.travel[i][0] = s

    def _taylor(self, i: int, s: Ball) -> list[Ball]:
        """Taylor coefficients of a force in a ball without a joint."""
        found = self.cells[i].taylor(s, DEGREE)
        if found is None:
            raise UndecidedError("a joint of a law in a step of the flow")
        return [found[0] + self.shifts[i], *found[1:]]

    def spans(self, h: float) -> dict[int, Ball]:
        """The travels during a time."""
        time = hull(ball(0.0), ball(h))
        return {i: value(c, time) for i, c in self.travel.items()}

    def ends(self, h: float) -> dict[int, Ball]:
        """The travels after a time."""
        return {i: value(c, ball(h)) for i, c in self.travel.items()}

    def level(self, h: float) -> Ball:
        """λ during a time, of the last step that `defect` saw."""
        return value(self.force, hull(ball(0.0), ball(h))) + self.missed * UNIT

    def line(self, h: float) -> dict[int, Ball]:
        """The travels after a time at the speed of the beginning, at most up to the stops."""
        out = {}
        for i, c in self.travel.items():
            x, a, b = ball(c[0]) + ball(h) * ball(c[1]), self.cells[i].low, self.cells[i].high
            out[i] = x if x >= a and x <= b else a if abs(x - a) < abs(x - b) else b
        return out

    def stays_within(self, spans: Mapping[int, Ball], h: float) -> bool:
        """Whether all travels are proved to stay within the stops, at which they may start."""
        for i, c in self.travel.items():
            a, b, span = self.cells[i].low, self.cells[i].high, spans[i]
            if span >= a and span <= b:
                continue
            speed, end = derivative([*map(ball, c)], 1, hull(ball(0.0), ball(h))), value(c, ball(h))
            one_way = speed > 0 or speed < 0
            if not (one_way and a <= c[0] and b >= c[0] and end >= a and end <= b):
                return False
        return True

    def defect(self, spans: Mapping[int, Ball], h: float, drift: Ball) -> Ball | None:
        """A bound of the distance of the velocities to those of the flow; None at a joint.

        Args:
            spans: the travels during the time.
            h: the time [s].
            drift: by how much the sum of the travels misses the stroke at the beginning [m].
        """
        series = self._series(spans, h)
        if series is None:
            return None
        square, mass = ball(0.0), sum((ball(self.m[i]) for i in series), ball(0.0))
        levels = [
            sum((self.m[i] * f[k] for i, f in series.items()), ball(0.0)) / mass
            for k in range(DEGREE + 1)
        ]
        off, power = ball(0.0), ball(1.0)
        for level, known in zip(levels, [*self.force, 0.0], strict=True):
            off, power = off + high(abs(level - known)) * power, power * h
        self.missed = off
        for i, f in series.items():
            c, off, power = [*self.travel[i], 0.0], ball(0.0), ball(1.0)
            for k in range(DEGREE + 1):
                own = ball(c[k + 1]) * (k + 1) - self.m[i] * (levels[k] - f[k])
                off, power = off + high(abs(own)) * power, power * h
            square = square + off * off / self.m[i]
        return high(high(square).sqrt() + self._slip(spans, h, drift))

    def _series(self, spans: Mapping[int, Ball], h: float) -> dict[int, list[Ball]] | None:
        """Taylor coefficients of the forces on the way, the last one anywhere in the time."""
        time, order = hull(ball(0.0), ball(h)), DEGREE + 1
        out: dict[int, list[Ball]] = {}
        for i, c in self.travel.items():
            row = [ball(x) for x in c]
            around = self.cells[i].taylor(spans[i], DEGREE)
            if around is None:
                return None
            thin = _composed(self._laws[i], [ball(0.0), *row[1:]], order)
            moved = [ball(0.0), *(derivative(row, k, time) for k in range(1, order))]
            last = _composed(arb_series(around, order), moved, order)
            out[i] = [*(thin[k] for k in range(DEGREE)), last[DEGREE]]
        return out

    def _slip(self, spans: Mapping[int, Ball], h: float, drift: Ball) -> Ball:
        """What the defect misses since the sum of the polynomials is not exactly the stroke.

        The first cell takes up the rest of the stroke.
        """
        off, rate, power = drift, ball(0.0), ball(1.0)
        for k in range(1, DEGREE + 1):
            total = high(abs(sum((ball(c[k]) for c in self.travel.values()), ball(0.0))))
            off, rate = off + total * power * h, rate + k * total * power
            power = power * h
        i, self.slip, self.off = next(iter(self.travel)), high(rate), high(off)
        slope = self.cells[i].law(spans[i] + off * UNIT)[1]
        return high((rate + self.m[i] * abs(slope) * off) / ball(self.m[i]).sqrt())

    def across(self, tube: Mapping[int, Ball], h: float, now: Ball, most: tuple[Ball, Ball]):
        """The radius after a time, of differences perpendicular to the way.

        Each place of the flow is compared with the place of the middle whose plane across the way
        it is in. None if these planes are not crossed one by one.

        Args:
            tube: the travels within the largest radius.
            h: the time [s].
            now: the radius at the beginning.
            most: the largest radius, and the defect.
        """
        time, (radius, defect) = hull(ball(0.0), ball(h)), most
        way, bend = self._derivative(1, time), self._derivative(2, time)
        square: Any = sum((x * x for x in way), ball(0.0))
        speed = low(low(square).sqrt())
        slopes = [self.m[i] * self.cells[i].narrow(tube[i])[1] for i in self.travel]
        pace = high(reduce(hull, [abs(x) for x in slopes]))
        if not (speed > 0 and pace.is_finite()):
            return None
        turn = radius * 2 * length_of(bend) / (speed * speed)
        off = (pace * radius + defect) / speed
        if not (turn < _QUARTER and off < _QUARTER):
            return None
        rate = self._rate_across(slopes, way, square.sqrt())
        # Time passes faster or slower by these factors than for the middle.
        factor = (1 + turn) / (1 - off) if rate > 0 else (1 - turn) / (1 + off)
        rate, more = high(rate * factor), defect * (1 + turn) / (1 - off)
        return high((ball(h) * rate).exp() * now * (1 + 2 * off) + kernel(rate, ball(h)) * more)

    def _derivative(self, k: int, time: Ball) -> list[Ball]:
        """The k-th derivatives over k!, in the metric of mobilities."""
        pairs = self.travel.items()
        return [derivative([*map(ball, c)], k, time) / ball(self.m[i]).sqrt() for i, c in pairs]

    def _rate_across(self, slopes: list[Ball], way: list[Ball], length: Ball) -> Ball:
        middles = [balls.middle(x) for x in way]
        size = length_of(middles)
        unit = [x / size for x in middles]
        lean = length_of([x / length - y for x, y in zip(way, unit, strict=True)])
        roots = [ball(self.m[i]).sqrt() for i in self.travel]
        size = length_of(roots)
        return largest_across(slopes, ([x / size for x in roots], unit), lean)


def kernel(rate: Ball, time: Ball) -> Ball:
    """∫ exp(μ t) dt, an upper bound."""
    return time * high((time * rate).exp()) if rate > 0 else time


def value(c: list[float], x: Ball) -> Ball:
    """A polynomial on a ball: between its values at both ends where it is monotone there."""
    row = [ball(k) for k in c]
    slope = derivative(row, 1, x)
    if slope > 0 or slope < 0:
        return hull(_horner(row, low(x)), _horner(row, high(x)))
    at = balls.middle(x)
    return _horner(row, at) + slope * (x - at)


def _horner(c: list[Ball], x: Ball) -> Ball:
    total = ball(0.0)
    for one in reversed(c):
        total = total * x + one
    return total


def derivative(c: list[Ball], k: int, x: Ball) -> Ball:
    """The k-th derivative of a polynomial over k!."""
    return _horner([math.comb(n, k) * c[n] for n in range(k, len(c))], x)


def _composed(law, way: list[Any], order: int):
    """A power series of another one without a constant term."""
    # python-flint takes the zero series for one with a constant term.
    still = all(x == 0 for x in way)
    return arb_series([law[0]], order) if still else law(arb_series(way, order))


def when(c: list[float], mark: float, h: float) -> float | None:
    """The first time up to h at which a polynomial is at a mark, about; None if it is not."""
    begin = c[0] - mark

    def gone(t: float) -> float:
        total = 0.0
        for one in reversed(c[1:]):
            total = (total + one) * t
        return begin + total

    a = 0.0
    for k in range(1, 5):
        b = h * k / 4.0
        if begin * gone(b) < 0.0:
            for _ in range(60):
                middle = 0.5 * (a + b)
                if begin * gone(middle) < 0.0:
                    b = middle
                else:
                    a = middle
            return b
        a = b
    return None


# Rates.


def length_of(x: list[Ball]) -> Ball:
    """An upper bound of the length of a vector."""
    return high(high(sum((a * a for a in x), ball(0.0))).sqrt())


def parting_rate(d: list[Ball], m: list[float]) -> Ball:
    """The largest value of -D on all vectors with Σ √m x = 0, a bound; infinite without one.

    Args:
        d: lower bounds of m κ.
        m: the mobilities.
    """
    if not all(x.is_finite() for x in d):
        return ball(0.0, math.inf)
    if len(d) == 1:
        return ball(0.0)
    least, second = sorted(float(x) for x in d)[:2]
    a, b = -second, -least
    pace = max(abs(float(x)) for x in d)
    if pace == 0.0 and all(x >= 0 for x in d):
        # All forces are constant: slack bands, say.
        return ball(0.0)
    while b - a > 1e-3 * pace:
        middle = 0.5 * (a + b)
        a, b = (a, middle) if _bounds(d, m, ball(middle)) else (middle, b)
    rate = ball(b + 1e-9 * pace)
    if not _bounds(d, m, rate):
        raise UndecidedError("a rate of the flow")
    return rate


def _bounds(d: list[Ball], m: list[float], rate: Ball) -> bool:
    """Whether D + μ is proved to be positive where Σ √m x = 0."""
    rows = [x + rate for x in d]
    below = [x for x in rows if not x > 0]
    if not below:
        return True
    if len(below) > 1 or not below[0] < 0:
        return False
    return bool(sum((one / x for one, x in zip(m, rows, strict=True)), ball(0.0)) < 0)


def largest_across(d: list[Ball], off: tuple[list[Ball], list[Ball]], lean: Ball) -> Ball:
    """A bound of -D on all vectors perpendicular to two unit vectors.

    Args:
        d: the diagonal of D.
        off: the unit vectors.
        lean: the second one may be off by this length.
    """
    least = [balls.low(x) for x in d]
    pace = max(float(high(abs(x))) for x in d)
    far = ball(20.0 * pace + 1e-9)
    rows = np.diag([-float(x) for x in least])
    for v in off:
        at = np.array([balls.number(x) for x in v])
        rows = rows - float(far) * np.outer(at, at)
    bound = ball(float(np.linalg.eigvalsh(rows)[-1]) + 1e-6 * pace)
    n = len(d)
    matrix = [
        [
            (bound + least[i] if i == k else ball(0.0))
            + far * sum((v[i] * v[k] for v in off), ball(0.0))
            for k in range(n)
        ]
        for i in range(n)
    ]
    if not is_positive(matrix):
        raise UndecidedError("a rate of the flow")
    return high(bound + far * lean * lean)


def is_positive(matrix: list[list[Ball]]) -> bool:
    """Whether a symmetric matrix of balls is proved positive definite, by elimination."""
    a = [list(row) for row in matrix]
    n = len(a)
    for k in range(n):
        if not a[k][k] > 0:
            return False
        for i in range(k + 1, n):
            factor = a[i][k] / a[k][k]
            for c in range(k, n):
                a[i][c] = a[i][c] - factor * a[k][c]
    return True
