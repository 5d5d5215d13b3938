"""Enclosed force laws of cells: force, slopes and energy over a ball of travel, and their turns.

The law is the engine's, with its numbers: the doubles of levers, sines of limits, d = q - p and
rows of cubics. Each cubic is tilted by its rounding error (about 1e-16 of the force) so that the
next one begins where it ends: the law is then continuous.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

from flint import arb_series  # pyright: ignore[reportMissingImports]

from stepwell import mechanism as mech
from stepwell.base import Floats
from stepwell.mechanism import Laws
from stepwell.proof import balls
from stepwell.proof.balls import Ball, UndecidedError, ball, high, hull, low
from stepwell.proof.slopes import Sloped
from stepwell.statics import DrivenChain

# Half the width of the ball of a turning point, as a fraction of the travel.
TURN = 1e-13
_ZERO, _ANY = balls.ball(0.0), balls.ball(0.0, math.inf)


class EnclosedReach(NamedTuple):
    """Length ℓ of a band, and g = ℓ ℓ' with its first two slopes by travel."""

    length: Ball
    g: Ball
    g1: Ball
    g2: Ball


class EnclosedCurve:
    """T of an extension: a cubic on each row, zero below the first one if it can be slack."""

    def __init__(self, rows: Floats, scale: float | Ball, slack: bool):
        self._starts: list[float] = rows[:, 0].tolist()
        self._first = -1 if slack else 0
        self._k = ball(scale)
        cubics = [[ball(value) for value in row[:5]] for row in rows.tolist()]
        for row, after in pairwise(cubics):
            x = after[0] - row[0]
            row[2] += (after[1] - row[1] - x * (row[2] + x * (row[3] + x * row[4]))) / x
        self._rows, areas = cubics, [_ZERO]
        for row, after in pairwise(cubics):
            areas.append(areas[-1] + _area(row, after[0] - row[0]))
        self._areas = areas
        self._plain = len(cubics) == 1 and not slack

    def rows_at(self, e: Ball) -> tuple[int, int]:
        """First and last row that an extension may be on; -1 is slack."""
        if self._plain:
            return 0, 0
        below = math.nextafter(float(low(e)), -math.inf)
        above = math.nextafter(float(high(e)), math.inf)
        one, two = bisect_right(self._starts, below) - 1, bisect_right(self._starts, above) - 1
        return max(one, self._first), max(two, self._first)

    def at(self, e: Ball, lean: int = 0) -> tuple[Ball, Ball, Ball]:
        """T, T' and T''; with `lean` at a joint, those of the row before (-1) or after it (1)."""
        one, two = self.rows_at(e)
        if lean and one < two:
            if two - one > 1:
                raise UndecidedError("several joints of a law are in one box")
            one = two = one if lean < 0 else two
        out = self._on(one, e)
        for k in range(one + 1, two + 1):
            on = self._on(k, e)
            # At a joint T' may jump, so T'' is not bounded.
            out = hull(out[0], on[0]), hull(out[1], on[1]), _ANY
        return out

    def _on(self, k: int, e: Ball) -> tuple[Ball, Ball, Ball]:
        if k < 0:
            return _ZERO, _ZERO, _ZERO
        x0, c0, c1, c2, c3 = self._rows[k]
        x, scale = e - x0, self._k
        return (
            scale * (c0 + x * (c1 + x * (c2 + x * c3))),
            scale * (c1 + x * (2 * c2 + 3 * c3 * x)),
            scale * (2 * c2 + 6 * c3 * x),
        )

    def series(self, k: int, e: Any) -> Any:
        """T on a row as a power series, by that of the extension."""
        x0, c0, c1, c2, c3 = self._rows[k]
        x = e - x0
        return self._k * (c0 + x * (c1 + x * (c2 + x * c3)))

    def tension(self, e: Any) -> Any:
        """T alone, of a ball or of one with slopes."""
        if not isinstance(e, Sloped):
            return self.at(e)[0]
        value, slope, _ = self.at(e.value)
        return e.by(value, slope)

    def area(self, e: Ball) -> Ball:
        """∫ T from the first row on."""
        one, two = self.rows_at(e)
        out = self._area_on(one, e)
        return out if one == two else hull(out, self._area_on(two, e))

    def _area_on(self, k: int, e: Ball) -> Ball:
        if k < 0:
            return _ZERO
        return self._k * (self._areas[k] + _area(self._rows[k], e - self._rows[k][0]))


def _area(row: Sequence[Ball], x: Ball) -> Ball:
    return x * (row[1] + x * (row[2] / 2 + x * (row[3] / 3 + x * row[4] / 4)))


class EnclosedBand:
    """One band of a lever cell; its numbers are balls, for `force` alone maybe with slopes.

    Args:
        d: q - p [m].
        rest: ℓ0 [m].
        lever: r [m].
        curve: tension by extension.
    """

    def __init__(self, d: tuple[Any, Any], rest: Any, lever: Any, curve: EnclosedCurve):
        self._dx, self._dy = dx, dy = d
        self._r, self._rest, self.curve = lever, rest, curve
        # The 1e-30 m² are those of the engine's length.
        self._square = lever * lever + dx * dx + dy * dy + ball(1e-30)

    def reach(self, sin: Ball, cos: Ball) -> EnclosedReach:
        """Length and slopes."""
        dx, dy, r = self._dx, self._dy, self._r
        length = (self._square + 2 * r * (dx * cos + dy * sin)).sqrt()
        rc3 = r * cos * cos * cos
        return EnclosedReach(
            length, dy - dx * sin / cos, -dx / rc3, -3 * dx * sin / (r * cos * cos * rc3)
        )

    def law(self, sin: Ball, cos: Ball, lean: int) -> tuple[Ball, Ball, Ball, bool]:
        """F, κ, dκ/ds, and whether a joint of the law is in the box."""
        length, g, g1, g2 = self.reach(sin, cos)
        e = length - self._rest
        one, two = self.curve.rows_at(e)
        if one < two:
            length = self._near_middle(sin, length, g)
            e = length - self._rest
            one, two = self.curve.rows_at(e)
        if two < 0:
            return _ZERO, _ZERO, _ZERO, False
        if lean and one < two:
            if g < 0:
                lean = -lean
            elif not g > 0:
                raise UndecidedError("a band is longest or shortest at a joint of its law")
        t, t1, t2 = self.curve.at(e, lean)
        first, ratio = g / length, t / length
        h = (t1 - ratio) / length
        square = first * first
        bend = first * (t2 * square + 3 * h * (g1 - square)) + ratio * g2
        return ratio * g, h * first * g + ratio * g1, bend, one < two

    def _near_middle(self, sin: Ball, length: Ball, g: Ball) -> Ball:
        """The lengths by the mean value form, where sin and cos as balls of their own are wider."""
        at = balls.middle(sin)
        mean = self.reach(at, (1 - at * at).sqrt()).length + self._r * g / length * (sin - at)
        return length.intersection(mean) if mean.is_finite() else length

    def taylor(self, sin: Any, cos: Any, s: tuple[Ball, Ball]) -> Any:
        """F as a power series, by those of sin and cos; None at a joint of the law.

        None too where the balls are so wide that the length may be 0.

        Args:
            sin, cos: power series.
            s: balls of sin and cos.
        """
        reach, g, _, _ = self.reach(*s)
        one, two = self.curve.rows_at(reach - self._rest)
        if one < two:
            reach = self._near_middle(s[0], reach, g)
            one, two = self.curve.rows_at(reach - self._rest)
        if one < two or not (reach > 0 and s[1] > 0):
            return None
        dx, dy = self._dx, self._dy
        if one < 0:
            return sin * 0
        length = (2 * self._r * (dx * cos + dy * sin) + self._square).sqrt()
        # Without the exact relation of sin and cos the first terms are wider than `reach`.
        if not (length[0] > 0 and cos[0] > 0):
            return None
        return self.curve.series(one, length - self._rest) * (dy - dx * (sin / cos)) / length

    def force(self, sin: Any, cos: Any) -> Any:
        """F alone, with slopes where numbers have them."""
        length, g, _, _ = self.reach(sin, cos)
        return self.curve.tension(length - self._rest) * g / length

    def energy(self, sin: Ball, cos: Ball) -> Ball:
        """Stored energy."""
        return self.curve.area(self.reach(sin, cos).length - self._rest)


@dataclass(frozen=True, eq=False)
class MonotoneBranch:
    """A stretch on which the force is monotone; its ends are turns, or ends of the travel.

    Attributes:
        sign: of κ: 1, -1, or 0 where the force is constant.
        left, right: balls that hold its ends [m].
        force_left, force_right: the force there [N].
    """

    sign: int
    left: Ball
    right: Ball
    force_left: Ball
    force_right: Ball

    def end(self, heading: int) -> tuple[Ball, Ball]:
        """Travel and force at its end in a sense."""
        return (self.right, self.force_right) if heading > 0 else (self.left, self.force_left)


class EnclosedCell:
    """The force law of a cell on one sheet, and its branches once they are proved."""

    def __init__(self, problem: DrivenChain, cell: int, sheet: int = 0):
        laws, table = problem.laws, problem.sheets.table
        on = int(table[problem.sheets.now[cell], mech.FIRST]) + sheet
        self.cell, self.friction = cell, ball(float(laws.friction[cell]))
        self.rubs = bool(laws.friction[cell] > 0.0)
        self.low, self.high = ball(float(table[on, mech.LOW])), ball(float(table[on, mech.HIGH]))
        # An end that leads to another sheet is no stop.
        row = table[on]
        self.leads = bool(row[_BELOW] >= 0), bool(row[_ABOVE] >= 0)
        self.size = float(laws.full[cell])
        self._bands = _bands_of(laws, cell)
        self._lever = ball(float(laws.lever[cell])) if self._bands else None
        self._sine = ball(float(laws.sin_limit[cell]))
        first, last = int(row[_ROWS]), int(row[_ROWS_END])
        self._load = EnclosedCurve(laws.rows[first:last], 1.0, False) if last > first else None
        self._hints = turns_of(problem, on)

    def law(self, s: Ball, lean: int = 0) -> tuple[Ball, Ball, Ball]:
        """F [N], κ [N/m] and dκ/ds [N/m²] in a ball; for `lean` see `EnclosedCurve.at`."""
        force, slope, bend, _ = self._law(s, lean)
        return force, slope, bend

    def narrow(self, s: Ball) -> tuple[Ball, Ball]:
        """F and κ in a ball, by their mean value forms too (Moore 1966)."""
        force, slope, bend = self.law(s)
        at = balls.middle(s)
        away = s - at
        if not (away.rad() > 0 and slope.is_finite()):
            return force, slope
        there = self.law(at)
        if bend.is_finite():
            slope = slope.intersection(there[1] + bend * away)
        return force.intersection(there[0] + slope * away), slope

    def taylor(self, s: Ball, degree: int) -> list[Ball] | None:
        """Taylor coefficients of F by travel, over a ball of it; None where it holds a joint."""
        at = arb_series([s, 1], degree + 1)
        total = at * 0
        if self._lever is not None:
            sin = at / self._lever - self._sine
            cos = (1 - sin * sin).sqrt()
            for band in self._bands:
                more = band.taylor(sin, cos, self._turned(s))
                if more is None:
                    return None
                total = total + more
        if self._load is not None:
            one, two = self._load.rows_at(s)
            if one < two:
                return None
            total = total + self._load.series(one, at)
        return [total[k] for k in range(degree + 1)]

    def law_on(self, branch: MonotoneBranch, s: Ball) -> tuple[Ball, Ball, Ball]:
        """`law` over a ball of travel on a branch, with the slopes of that branch at its ends."""
        parts, a, b = [], low(s), high(s)
        if not branch.left.is_exact() and s.overlaps(branch.left):
            parts.append(self.law(branch.left, 1))
            a = high(branch.left)
        if not branch.right.is_exact() and s.overlaps(branch.right):
            parts.append(self.law(branch.right, -1))
            b = low(branch.right)
        if a <= b:
            parts.append(self.law(s if not parts else hull(a, b)))
        out = parts[0]
        for more in parts[1:]:
            out = hull(out[0], more[0]), hull(out[1], more[1]), hull(out[2], more[2])
        return out

    def _law(self, s: Ball, lean: int) -> tuple[Ball, Ball, Ball, int]:
        force, slope, bend, joints = _ZERO, _ZERO, _ZERO, 0
        if self._lever is not None:
            sin, cos = self._turned(s)
            for band in self._bands:
                f0, f1, f2, joint = band.law(sin, cos, lean)
                force, slope, bend, joints = force + f0, slope + f1, bend + f2, joints + joint
        if self._load is not None:
            f0, f1, f2 = self._load.at(s, lean)
            one, two = self._load.rows_at(s) if lean else (0, 0)
            force, slope, bend, joints = force + f0, slope + f1, bend + f2, joints + (one < two)
        return force, slope, bend, joints

    def _turned(self, s: Ball) -> tuple[Ball, Ball]:
        sin = s / self._lever - self._sine
        return sin, (1 - sin * sin).sqrt()

    def energy(self, s: Ball) -> Ball:
        """Stored energy [J] over a ball of travel, from a constant on."""
        total = _ZERO if self._load is None else self._load.area(s)
        if self._lever is not None:
            sin, cos = self._turned(s)
            for band in self._bands:
                total = total + band.energy(sin, cos)
        return total

    @cached_property
    def branches(self) -> tuple[MonotoneBranch, ...]:
        """Its branches in order of travel; each is proved monotone, and each turn to be one."""
        places, signs = self._hints
        turns = [self.low, *(ball(t, TURN * self.size) for t in places), self.high]
        forces = [self.law(turn)[0] for turn in turns]
        for (left, right), sign in zip(pairwise(turns), signs, strict=True):
            self._prove(high(left), low(right), sign)
        for turn, (before, after) in zip(turns[1:-1], pairwise(signs), strict=True):
            self._prove_turn(turn, before, after)
        ends = zip(signs, pairwise(turns), pairwise(forces), strict=True)
        return tuple(MonotoneBranch(sign, *at, *force) for sign, at, force in ends)

    def _prove(self, a: Ball, b: Ball, sign: int) -> None:
        if sign == 0:
            if not balls.covered(lambda s: self.law(s)[1].is_zero(), a, b):
                raise UndecidedError(
                    f"the force of cell {self.cell + 1} is constant but for rounding"
                )
            return

        def slope(s: Ball) -> tuple[Ball, Ball]:
            _, first, second = self.law(s)
            return sign * first, sign * second

        if not balls.positive(slope, a, b):
            raise UndecidedError(f"the force of cell {self.cell + 1} turns once more")

    def _prove_turn(self, turn: Ball, before: int, after: int) -> None:
        """Prove that the force turns in a ball, and nowhere else around it."""
        sides = [self._law(turn, lean) for lean in (-1, 1)]
        joints = sides[0][3]
        bends = all(before * bend < 0 for _, _, bend, _ in sides)
        ends = before * self.law(low(turn))[1] > 0 and after * self.law(high(turn))[1] > 0
        # Smooth, or two cubics that meet at the turn with slopes that are rounding.
        if joints <= 1 and bends and ends:
            return
        kink = joints == 1 and all(
            slope.is_zero() if sign == 0 else sign * slope > 0
            for (_, slope, _, _), sign in zip(sides, (before, after), strict=True)
        )
        if not kink:
            raise UndecidedError(f"a turn of the force of cell {self.cell + 1} is not proved")

    def invert(self, branch: MonotoneBranch, force: Ball, near: Ball | None = None) -> Ball:
        """The travels on a branch at which its force takes the values of a ball."""
        if branch.sign == 0:
            raise UndecidedError(f"cell {self.cell + 1} has a constant force")
        least, most = (branch.force_left, branch.force_right)[:: branch.sign]
        if force < least or force > most:
            raise UndecidedError(f"cell {self.cell + 1} leaves its branch")
        one = self._invert_at(branch, low(force), near)
        return one if force.is_exact() else hull(one, self._invert_at(branch, high(force), one))

    def _invert_at(self, branch: MonotoneBranch, force: Ball, near: Ball | None) -> Ball:
        """A ball with the travel at an exact force, clipped to the branch."""
        a, b, sign = branch.left, branch.right, branch.sign
        if not sign * (force - branch.force_left) > 0:
            return a
        if not sign * (branch.force_right - force) > 0:
            return b
        left, right = balls.middle(a), balls.middle(b)
        s = near if near is not None and left < near < right else (left + right) / 2
        s = balls.middle(s)
        tiny = (right - left) * balls.ball(1e-26)
        for _ in range(200):
            value, slope, _ = self.law(s)
            miss = balls.middle(force - value)
            if sign * miss > 0:
                left = s
            else:
                right = s
            step = balls.middle(miss / slope) if sign * slope > 0 else right - left
            to = s + step
            if not left < to < right:
                to = balls.middle((left + right) / 2)
            moved = abs(to - s)
            s = balls.middle(to)
            if moved <= tiny or right - left <= tiny:
                break
        return self._around(branch, s, force)

    def _around(self, branch: MonotoneBranch, s: Ball, force: Ball) -> Ball:
        """A ball around s with the travel at an exact force, proved by signs at its ends."""
        sign, width = branch.sign, (self.high - self.low) * ball(1e-25)
        for _ in range(30):
            a, b = max(s - width, low(branch.left)), min(s + width, high(branch.right))
            below = a <= low(branch.left) or sign * (force - self.law(a)[0]) > 0
            above = b >= high(branch.right) or sign * (self.law(b)[0] - force) > 0
            if below and above:
                return hull(a, b)
            width = width * 8
        raise UndecidedError(f"the travel of cell {self.cell + 1} at a force is not enclosed")


_ROWS, _ROWS_END, _BELOW, _ABOVE = 4, 5, 6, 7


def _bands_of(laws: Laws, cell: int) -> list[EnclosedBand]:
    lever, bands = ball(float(laws.lever[cell])), []
    for b in range(int(laws.band_first[cell]), int(laws.band_first[cell + 1])):
        dx, dy, stiffness, rest = map(ball, laws.band[b].tolist())
        rows = laws.rows[laws.band_rows[b] : laws.band_rows[b + 1]]
        curve = EnclosedCurve(rows, stiffness, not laws.two_sided[b])
        bands.append(EnclosedBand((dx, dy), rest, lever, curve))
    return bands


def turns_of(problem: DrivenChain, sheet: int) -> tuple[list[float], list[int]]:
    """Travels at which the engine's force turns, and the signs of κ between them: hints only."""
    pieces = problem.pieces
    begin, end = int(pieces.of_sheet[sheet]), int(pieces.of_sheet[sheet + 1])
    signs, places = [int(pieces.sign[begin])], []
    for k in range(begin + 1, end):
        if int(pieces.sign[k]) != signs[-1]:
            signs.append(int(pieces.sign[k]))
            places.append(float(pieces.left[k]))
    return places, signs
