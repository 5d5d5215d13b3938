"""All stable equilibria of a chain within a box.

At rest all cells share one λ, so a place is a choice of one branch for each cell and a root of one
scalar equation. A branch is a stretch of travel on which the force does not fall, or does not rise;
a place with two falling cells is unstable (theory page, "Stability").
"""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel
from stepwell.mechanism import law
from stepwell.statics.following.log import Pair
from stepwell.statics.following.pieces import find_piece, invert
from stepwell.statics.following.state import DrivenChain, force_at
from stepwell.statics.landings.reachable_box import CLOSE, CLOSE_FORCE, ReachableBox
from stepwell.statics.landings.start import Start

# Limits of the choices of branches, and of the intervals of λ; with more there is no proof.
_MOST_CHOICES, _MOST_INTERVALS = 5_000, 1_000
# Relative precision of the travels of a known place.
_KNOWN = 1e-8
# Places nearer to the start than this fraction of the travels are the start, next to which the
# equilibrium that is lost may still exist by rounding.
NEAR_START = 1e-5


class Stretches(NamedTuple):
    """Stretches of all cells on which the force does not turn; R of them, in order of the cell."""

    of_cell: Ints  # (N + 1,) those of cell i are of_cell[i] .. of_cell[i + 1] - 1
    sign: Ints  # (R,) +1 rising, -1 falling
    low: Floats  # (R,) travel at its ends
    high: Floats  # (R,)
    first: Ints  # (R,) first and last piece
    last: Ints  # (R,)
    least: Floats  # (R,) λ at which a cell can rest there, stops included
    most: Floats  # (R,)


@kernel
def _add(
    out: Stretches, r: int, sign: int, pieces: tuple[int, int], travel: Pair, force: Pair
) -> int:
    """Write branch r; returns the number of branches."""
    out.sign[r], out.first[r], out.last[r] = sign, pieces[0], pieces[1]
    out.low[r], out.high[r], out.least[r], out.most[r] = travel[0], travel[1], force[0], force[1]
    return r + 1


@kernel
def _branches(problem: DrivenChain, box: ReachableBox) -> Stretches:
    # One function: every cell adds to the same seven arrays.
    pieces, n, stops = problem.pieces, len(box.low), box.stops
    count = 4 * n + np.sum(pieces.among[:, 1] - pieces.among[:, 0])
    whole, number = np.empty((3, count), np.int64), np.empty((4, count))
    ends = number[0], number[1], whole[1], whole[2], number[2], number[3]
    out, used = Stretches(np.zeros(n + 1, np.int64), whole[0], *ends), 0
    for i in range(n):
        low, high = box.low[i], box.high[i]
        piece, end = find_piece(pieces, i, low, 1), find_piece(pieces, i, high, 0)
        if not high > low:
            used = _add(out, used, 1, (piece, piece), (low, high), (-np.inf, np.inf))
            out.of_cell[i + 1] = used
            continue
        if stops[i, 0] and pieces.sign[piece] < 0:
            forces = -np.inf, force_at(problem, i, low)
            used = _add(out, used, 1, (piece, piece), (low, low), forces)
        while piece <= end:
            begin, sign = piece, -1 if pieces.sign[piece] < 0 else 1
            while piece < end and (pieces.sign[piece + 1] < 0) == (sign < 0):
                piece += 1
            a, b = max(pieces.left[begin], low), min(pieces.right[piece], high)
            fa, fb = force_at(problem, i, a), force_at(problem, i, b)
            least = -np.inf if sign > 0 and stops[i, 0] and a == low else min(fa, fb)
            most = np.inf if sign > 0 and stops[i, 1] and b == high else max(fa, fb)
            used = _add(out, used, sign, (begin, piece), (a, b), (least, most))
            piece += 1
        if stops[i, 1] and out.sign[used - 1] < 0:
            forces = force_at(problem, i, high), np.inf
            used = _add(out, used, 1, (end, end), (high, high), forces)
        assert used > out.of_cell[i]
        out.of_cell[i + 1] = used
    return out


@kernel
def _travel_at(problem: DrivenChain, branches: Stretches, i: int, r: int, force: float) -> float:
    low, high = branches.low[r], branches.high[r]
    if low == high:
        return low
    pieces, rising = problem.pieces, branches.sign[r] > 0
    for piece in range(branches.first[r], branches.last[r] + 1):
        end = pieces.force_right[piece]
        if (end >= force if rising else end <= force) or piece == branches.last[r]:
            return min(max(invert(problem.laws, pieces, i, piece, force), low), high)
    return high


@kernel
def _compliance(
    problem: DrivenChain,
    box: ReachableBox,
    branches: Stretches,
    i: int,
    r: int,
    low: float,
    high: float,
) -> Pair:
    """Least and largest 1/κ of cell i between two travels of branch r; 0 where a stop holds it."""
    if branches.low[r] == branches.high[r]:
        return 0.0, 0.0
    laws, pieces = problem.laws, problem.pieces
    softest, stiffest = np.inf, 0.0
    for piece in range(branches.first[r], branches.last[r] + 1):
        a, b = max(pieces.left[piece], low), min(pieces.right[piece], high)
        if a > b:
            continue
        one = abs(law(laws, i, pieces.picked[piece], a)[1])
        two = abs(law(laws, i, pieces.picked[piece], b)[1])
        softest, stiffest = min(softest, one, two), max(stiffest, one, two)
    least = 1.0 / stiffest if stiffest > 0.0 else 0.0
    most = 1.0 / softest if softest > 0.0 else np.inf
    if branches.sign[r] < 0:
        return -most, -least
    below = box.stops[i, 0] and low <= box.low[i]
    above = box.stops[i, 1] and high >= box.high[i]
    return (0.0 if below or above else least), most


class RestSearch(NamedTuple):
    """State of the search for equilibria, and its results."""

    branches: Stretches
    choice: Ints  # (N,) a branch of every cell
    rest: Floats  # (2, N) travels between which it rests under some interval of λ
    places: Floats  # (C, 2, N) the same for every place
    counts: Ints  # (2,) places, intervals of λ


@kernel
def _slip(problem: DrivenChain) -> float:
    """Drives that are closer than this differ by rounding, of the drive and of the forces."""
    travels = problem.alpha * CLOSE * np.sum(problem.laws.full)
    return travels + problem.beta * CLOSE_FORCE * problem.scale


@kernel
def _span(problem: DrivenChain, search: RestSearch, low: float, high: float) -> Pair:
    """Fill the box of the choice for λ from `low` to `high`; the least and largest U less βλ."""
    branches, choice, rest = search.branches, search.choice, search.rest
    least, most, slip = 0.0, 0.0, CLOSE_FORCE * problem.scale
    for i in range(len(choice)):
        r, begin, end = choice[i], low - slip, high + slip
        if branches.sign[r] < 0:
            begin, end = end, begin
        rest[0, i] = _travel_at(problem, branches, i, r, begin)
        rest[1, i] = _travel_at(problem, branches, i, r, end)
        least += rest[0, i]
        most += rest[1, i]
    return least, most


@kernel
def _stability(problem: DrivenChain, box: ReachableBox, search: RestSearch) -> Pair:
    """Least and largest α Σ 1/κ + β in the box."""
    branches, choice, rest, alpha = search.branches, search.choice, search.rest, problem.alpha
    least, most = problem.beta, problem.beta
    for i in range(len(choice)):
        low, high = _compliance(problem, box, branches, i, choice[i], rest[0, i], rest[1, i])
        least += alpha * low
        most += alpha * high
    return least, most


@kernel
def _noted(problem: DrivenChain, search: RestSearch) -> bool:
    """Whether the box is the last place that was noted: λ may be free there."""
    last, rest = search.counts[0] - 1, search.rest
    if last < 0:
        return False
    for i in range(len(search.choice)):
        near = 2.0 * _KNOWN * problem.laws.full[i]
        low, high = search.places[last, 0, i], search.places[last, 1, i]
        if abs(low - rest[0, i]) > near or abs(high - rest[1, i]) > near:
            return False
    return True


@kernel
def _note(problem: DrivenChain, start: Start, search: RestSearch) -> bool:
    """Note the box if it is precise enough; returns whether it is, or is the start."""
    laws, rest, counts = problem.laws, search.rest, search.counts
    here, known = True, True
    for i in range(len(start.travel)):
        s, near = start.travel[i], NEAR_START * laws.full[i]
        here = here and rest[0, i] >= s - near and rest[1, i] <= s + near
        known = known and rest[1, i] - rest[0, i] <= _KNOWN * laws.full[i]
    if here:
        return True
    if known and not _noted(problem, search):
        search.places[counts[0]] = rest
        counts[0] += 1
    return known


@kernel
def _excess(problem: DrivenChain, start: Start, search: RestSearch, force: float) -> Pair:
    """Least and largest α Σ s + β λ of the choice under one λ, less the drive."""
    least, most = _span(problem, search, force, force)
    rest = problem.beta * force - start.drive
    return problem.alpha * least + rest, problem.alpha * most + rest


@kernel
def _one_place(
    problem: DrivenChain, start: Start, search: RestSearch, a: float, b: float, way: int
) -> bool:
    """Note the place between two λ where `way` U is monotone; False where there are too many."""
    counts, slip = search.counts, _slip(problem)
    below, above = _excess(problem, start, search, a), _excess(problem, start, search, b)
    if way < 0:
        below, above = (-below[1], -below[0]), (-above[1], -above[0])
    if below[0] > slip or above[1] < -slip:
        return True
    one, two = 0.5 * (below[0] + below[1]), 0.5 * (above[0] + above[1])
    for step in range(200):
        _span(problem, search, a, b)
        if _note(problem, start, search):
            return True
        force = 0.5 * (a + b)
        if b - a <= 1e-2 * CLOSE_FORCE * problem.scale or not a < force < b:
            break
        if step % 3 != 2 and two > one:
            # Not too near to an end, so that both ends converge.
            share = min(max(-one / (two - one), 0.0), 1.0)
            force = a + min(max(share, 1e-4), 1.0 - 1e-4) * (b - a)
        here = _excess(problem, start, search, force)
        value = way * 0.5 * (here[0] + here[1])
        if value < 0.0:
            a, one = force, value
        else:
            b, two = force, value
    _span(problem, search, a, b)
    if counts[0] >= len(search.places):
        return False
    search.places[counts[0]] = search.rest
    counts[0] += 1
    return True


@kernel
def _places(
    problem: DrivenChain, box: ReachableBox, start: Start, search: RestSearch, ends: Pair
) -> bool:
    """Note the places of one choice between two λ; False where there are too many."""
    alpha, beta, drive, slip = problem.alpha, problem.beta, start.drive, _slip(problem)
    counts, lows, highs = search.counts, np.empty(256), np.empty(256)
    if np.min(search.branches.sign[search.choice]) > 0:
        if counts[0] >= len(search.places):
            return False
        return _one_place(problem, start, search, ends[0], ends[1], 1)
    (lows[0], highs[0]), waiting = ends, 1
    while waiting > 0:
        waiting -= 1
        a, b = lows[waiting], highs[waiting]
        counts[1] += 1
        if counts[1] > _MOST_INTERVALS or counts[0] >= len(search.places):
            return False
        least, most = _span(problem, search, a, b)
        if alpha * least + beta * a > drive + slip or alpha * most + beta * b < drive - slip:
            continue
        if _note(problem, start, search):
            continue
        middle = 0.5 * (a + b)
        if b - a <= 1e-2 * CLOSE_FORCE * problem.scale or not a < middle < b:
            search.places[counts[0]] = search.rest
            counts[0] += 1
            continue
        least, most = _stability(problem, box, search)
        if least > 0.0:
            # Every equilibrium in it is unstable.
            continue
        if most < 0.0:
            if not _one_place(problem, start, search, a, b, -1):
                return False
            continue
        lows[waiting], highs[waiting] = a, middle
        lows[waiting + 1], highs[waiting + 1] = middle, b
        waiting += 2
    return True


@kernel
def places_of_rest(problem: DrivenChain, box: ReachableBox, start: Start, places: Floats) -> int:
    """Fill boxes (C, 2, N) with all stable equilibria but the start; their number, or -1."""
    branches, n = _branches(problem, box), len(box.low)
    search = RestSearch(
        branches, np.full(n, -1, np.int64), np.empty((2, n)), places, np.zeros(2, np.int64)
    )
    slip = CLOSE_FORCE * problem.scale
    # For the cells chosen so far: their range of λ, their travels, the number of falling ones; and
    # the range of travels of the others.
    least, most, below, above = np.empty(n + 1), np.empty(n + 1), np.zeros(n + 1), np.zeros(n + 1)
    falls, rest_low, rest_high = np.zeros(n + 1, np.int64), np.zeros(n + 1), np.zeros(n + 1)
    least[0], most[0] = box.force[0], box.force[1]
    for i in range(n - 1, -1, -1):
        rest_low[i] = rest_low[i + 1] + box.low[i]
        rest_high[i] = rest_high[i + 1] + box.high[i]
    alpha, beta, drive, slack = problem.alpha, problem.beta, start.drive, 2.0 * _slip(problem)
    tries, level = 0, 0
    while level >= 0:
        r = search.choice[level]
        r = branches.of_cell[level] if r < 0 else r + 1
        if r == branches.of_cell[level + 1]:
            search.choice[level] = -1
            level -= 1
            continue
        search.choice[level] = r
        tries += 1
        if tries > _MOST_CHOICES:
            return -1
        after = level + 1
        least[after] = max(least[level], branches.least[r])
        most[after] = min(most[level], branches.most[r])
        below[after] = below[level] + branches.low[r]
        above[after] = above[level] + branches.high[r]
        falls[after] = falls[level] + (branches.sign[r] < 0)
        low = alpha * (below[after] + rest_low[after]) + beta * least[after]
        high = alpha * (above[after] + rest_high[after]) + beta * most[after]
        missed = low > drive + slack or high < drive - slack
        if missed or falls[after] > 1 or least[after] > most[after] + slip:
            continue
        if after < n:
            level = after
            continue
        ends = min(least[n], most[n]), max(least[n], most[n])
        if not _places(problem, box, start, search, ends):
            return -1
    return search.counts[0]
