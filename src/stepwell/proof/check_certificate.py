"""Check a certificate of a path in ball arithmetic: `check_certificate.py FILE`. SI units."""

import hashlib
import json
import math
import sys
from bisect import bisect_right
from itertools import pairwise

from flint import arb, ctx

ctx.prec, TURN, TIE = 100, 1e-13, 1e-9


class NotProved(SystemExit):
    """A condition that is not proved, or a claim that is wrong."""


def need(holds, what):
    if not holds:
        raise NotProved(f"not proved: {what}")


def ends(x):
    return x.lower().mid(), x.upper().mid()  # exact


def zero(f, a, b):
    """None if f > 0 on [a, b] is proved, else a ball with the first zero, where f falls."""
    todo, seen = [(ends(a)[0], ends(b)[1])], 0
    while todo:
        (a, b), seen = todo.pop(), seen + 1
        value, slope = f(x := a.union(b))[:2]
        if value > 0 or (slope >= 0 and f(a)[0] > 0) or (slope <= 0 and f(b)[0] > 0):
            continue
        if slope < 0 and f(b)[0] < 0 and f(a)[0] > 0:
            for _ in range(8):  # interval Newton
                x = (x.mid() - f(x.mid())[0] / f(x)[1]).intersection(x)
            if x.rad() < (b - a) / 1000:
                return x
        middle = ((a + b) / 2).mid()
        need(seen < 4000 and a < middle < b, "a sign is too near to zero")
        todo += [(middle, b), (a, middle)]


class Law:
    """A band (with d = q - p), or a force against travel: cubics on rows."""

    def __init__(self, data, lever, sine):
        self.d, self.r, self.sine = data.get("d"), lever, sine
        self.k, self.rest, self.first = arb(data["k"]), arb(data["rest"]), -int(data["slack"])
        self.starts = [row[0] for row in data["rows"]]
        self.rows = [[arb(value) for value in row] for row in data["rows"]]
        for row, after in pairwise(self.rows):  # tilted, so that the next one begins where it ends
            row[2] = (after[1] - row[1]) / (x := after[0] - row[0]) - x * (row[3] + x * row[4])
        self.rows.append([arb(0)] * 5)

    def _on(self, k, e):  # T, T', T'' on a row; the last one, -1, is slack
        x0, c0, c1, c2, c3 = self.rows[k]
        x = e - x0
        t = c0 + x * (c1 + x * (c2 + x * c3)), c1 + x * (2 * c2 + 3 * c3 * x), 2 * c2 + 6 * c3 * x
        return tuple(self.k * one for one in t)

    def at(self, s, lean):
        """F, F', F'' by travel, and whether two rows meet; `lean`: the slopes of one side there."""
        e, g = s, arb(1)
        if self.d:
            (dx, dy), r, sin = map(arb, self.d), self.r, s / self.r - self.sine
            cos = (1 - sin * sin).sqrt()
            length = (r * r + dx * dx + dy * dy + 1e-30 + 2 * r * (dx * cos + dy * sin)).sqrt()
            e, g, c3 = length - self.rest, dy - dx * sin / cos, r * cos * cos * cos
        sides = (math.nextafter(float(x), far) for x, far in zip(ends(e), (-1e9, 1e9), strict=True))
        one, two = (max(bisect_right(self.starts, x) - 1, self.first) for x in sides)
        joint = one < two
        if lean and joint:
            need(two == one + 1 and (g > 0 or g < 0), "several joints of a law in one box")
            one = two = one if (lean < 0) == bool(g > 0) else two
        t, t1, t2 = self._on(one, e)
        for k in range(one + 1, two + 1):
            t, t1, t2 = (
                *map(arb.union, (t, t1), self._on(k, e)[:2]),
                arb(0, math.inf),
            )  # T' may jump
        if not self.d:
            return t, t1, t2, joint
        first, ratio = g / length, t / length
        h, g1, g2 = (t1 - ratio) / length, -dx / c3, -3 * dx * sin / (r * cos * cos * c3)
        bend = first * (t2 * first * first + 3 * h * (g1 - first * first)) + ratio * g2
        return ratio * g, h * first * g + ratio * g1, bend, joint


class CheckedCell:
    """A cell, its travel cut into branches of one sign of κ: [sign, left, right, forces there]."""

    def __init__(self, data):
        self.laws = [Law(law, arb(data["lever"] or 0), arb(data["sine"])) for law in data["laws"]]
        self.low, self.high = arb(data["low"]), arb(data["high"])
        self.mobility, box = arb(data["mobility"]), TURN * data["size"]
        turns = [self.low, *(arb(turn, box) for turn in data["turns"]), self.high]
        for sign, (a, b) in zip(data["signs"], pairwise(turns), strict=True):
            turn = zero(lambda s, by=sign: self.slopes(s, by), ends(a)[1], ends(b)[0])
            need(turn is None, "a branch of one sign")
        for turn, signs in zip(turns[1:-1], pairwise(data["signs"]), strict=True):
            left, right = self.law(turn, -1), self.law(turn, 1)
            if not left[3]:  # smooth: κ' has one sign, κ those of both branches at the ends
                need(signs[0] * left[2] < 0, "a turn")
                left, right = map(self.law, ends(turn))
            for sign, side in zip(signs, (left, right), strict=True):
                need(side[3] <= 1 and (sign * side[1] > 0 or (not sign and side[1] == 0)), "a turn")
        forces = [self.law(turn)[0] for turn in turns]
        self.branches = list(zip(data["signs"], turns, turns[1:], forces, forces[1:], strict=False))

    def law(self, s, lean=0):
        """F, κ, dκ/ds, and the number of joints of rows."""
        return tuple(map(sum, zip(*(law.at(s, lean) for law in self.laws), strict=True)))

    def slopes(self, s, sign, force=None):
        """κ and dκ/ds, or F - force and κ, times a sign; for sign 0: 1 where κ = 0 is proved."""
        value, first, second, _ = self.law(s)
        if force is not None:
            return sign * (value - force), sign * first
        return (sign * first, sign * second) if sign else (arb(int(first == 0)), arb(0))

    def branch_at(self, s, to=0):
        """The branch on which a travel is, or on which it goes on in a sense."""
        for k, (_, a, b, *_) in enumerate(self.branches):
            if (s >= a or (to > 0 and s.overlaps(a))) and (s <= b or (to < 0 and s.overlaps(b))):
                return k
        raise NotProved("not proved: a cell is too near to a turn of its force")

    def invert(self, k, force):
        """The travels on a branch at which the force takes the values of a ball."""
        sign, a, b, fa, fb = self.branches[k]
        need(sign and not sign * (force - fa) < 0 and not sign * (fb - force) < 0, "off a branch")
        if not force.is_exact():
            return self.invert(k, ends(force)[0]).union(self.invert(k, ends(force)[1]))
        if not sign * (force - fa) > 0:
            return a
        miss = zero(lambda s: self.slopes(s, -sign, force), ends(a)[1], ends(b)[0])
        return b if miss is None else miss


class CheckedChain:
    """Cells in series at travels s under a stroke: at most one, `j`, moves, on its branch `k`."""

    def __init__(self, data):
        self.cells = [CheckedCell(cell) for cell in data["cells"]]
        self.s, self.tie = [arb(s) for s in data["start"]], arb(TIE * data["scale"])
        self.j, self.k, self.force, self.claims, self.taken = None, 0, None, iter(data["events"]), 0
        need(all(s in (c.low, c.high) for s, c in zip(self.s, self.cells, strict=True)), "a start")

    def _held(self, toward, but=()):  # forces at which cells at stops leave as λ goes one way
        for i, (cell, s) in enumerate(zip(self.cells, self.s, strict=True)):
            if i not in (self.j, *but) and s != (cell.high if toward > 0 else cell.low):
                yield cell.law(s)[0], i

    def go(self, d, target):
        """Events in the sense d of the stroke, up to a target or to the stops of all cells."""
        while True:
            cell = None if self.j is None else self.cells[self.j]
            sign, a, b, fa, fb = cell.branches[self.k] if cell else (1, 0, 0, 0, 0)
            toward, end = d * sign, b if d > 0 else a
            events = list(self._held(toward)) if toward else []
            events += [(fb if d > 0 else fa, self.j)] if cell else []
            if not events:
                return
            force, i = min(events, key=lambda one: toward * float(one[0].mid()))
            need(self.force is None or not toward * (force - self.force) < 0, "a force is passed")
            if cell:
                there = end if i == self.j else cell.invert(self.k, force)
                limit = target - sum(self.s, arb(0)) + self.s[self.j]
                if d * (limit - there) < 0:
                    self.s[self.j], self.force = limit, cell.law(limit)[0]
                    return
                need(d * (limit - there) > 0, "an event at a turning point")
                self.s[self.j] = there
            need(all(n == i or toward * (f - force) > self.tie for f, n in events), "events tie")
            self.force = force
            if i != self.j and cell:
                falls = self.cells[i].branches[self.cells[i].branch_at(self.s[i], toward)][0] < 0
                need(toward == -d and falls, "two cells that move smoothly")
                claim = next(self.claims, {})
                moved = self.take(claim) if claim.get("taken") else self.snap(self.j, i, d)
                yield claim, "snap", moved
            elif i != self.j:
                self.j, self.k = i, self.cells[i].branch_at(self.s[i], toward)
            elif not end.is_exact():
                self.k += d
            else:
                self.j = None
                yield next(self.claims, {}), "switch", [i]

    def snap(self, j, p, d):
        """Cell j moves by x with the stroke and p against it, while the pull on j is larger."""
        cell, other, s, t = self.cells[j], self.cells[p], self.s[j], self.s[p]
        stop = cell.high if d > 0 else cell.low
        room, share = d * (stop - s), other.mobility / (cell.mobility + other.mobility)
        need(room < other.high - other.low, "which cell of a snap arrives first")

        def pull(x):  # with its slope, and λ, a mean by mobilities, with its own
            (f, k, *_), (g, h, *_) = cell.law(s + d * x), other.law(t - d * x)
            return d * (g - f), -k - h, share * g + (1 - share) * f, d * (k - share * (k + h))

        begin = ends(room / 1024)[1]
        need(pull(arb(0).union(begin))[1] > 0, "in which sense a snap begins")
        need(zero(lambda x: pull(x)[:2], begin, room) is None, "a landing between the stops")
        for n, b in [(w, one[0]) for w in (1, -1) for one in self._held(w, (j, p))]:
            out = zero(lambda x, b=b, n=n: (n * (b - pull(x)[2]), -n * pull(x)[3]), arb(0), room)
            need(out is None, "a third cell in a snap")
        self.s[j], self.s[p] = stop, t - d * room
        return self._rest(p, sorted({j, p}))

    def _rest(self, j, moved):  # cell j between its stops, whose force has to hold all others
        self.j, self.k = j, self.cells[j].branch_at(self.s[j])
        self.force = w = self.cells[j].law(self.s[j])[0]
        need(all(n * (f - w) > 0 for n in (1, -1) for f, _ in self._held(n)), "a next snap")
        return moved

    def take(self, claim):
        """Put cells where a snap is claimed to land: a rest at this stroke. No flow is followed."""
        total, self.taken = sum(self.s, arb(0)), self.taken + 1
        for i, (travel, _) in zip(claim["cells"], claim["after"], strict=True):
            self.s[i] = arb(travel)
        free = [i for i, c in enumerate(self.cells) if self.s[i] not in (c.low, c.high)]
        need(len(free) == 1, "a landing with one cell between its stops")
        self.s[free[0]] += total - sum(self.s, arb(0))
        return self._rest(free[0], claim["cells"])


def check(text):
    """What a certificate proves, in a sentence; NotProved where it does not."""
    data = json.loads(text)
    claims = json.dumps({**data, "sha256": ""}, sort_keys=True, ensure_ascii=False)
    need(hashlib.sha256(claims.encode()).hexdigest() == data["sha256"], "an unchanged certificate")
    chain = CheckedChain(data)
    for d, target in [(one["direction"], one["target"]) for one in data["strokes"]]:
        for claim, *event in chain.go(
            d, arb(d * math.inf if target is None else target)
        ):  # to stops
            need([claim.get("kind"), claim.get("cells")] == event, "another event")
            found = [sum(chain.s, arb(0)), *(chain.s[i] for i in claim["cells"])]
            for x, box in zip(found, [claim["stroke"], *claim["after"]], strict=True):
                need(arb(*box).contains(x), "a number outside its box")
    need(next(chain.claims, None) is None, "fewer events than claimed")
    text = f"proved: {len(data['events'])} events of {len(chain.cells)} cells, and no others"
    return text + f"; landings taken as claimed, not checked: {chain.taken}" * bool(chain.taken)


if __name__ == "__main__":
    print(check(open(sys.argv[1], encoding="utf-8").read()))  # noqa: SIM115
