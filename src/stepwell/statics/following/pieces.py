"""Cutting a cell's law into pieces on which force and slope are both monotone.

Everything exact in this room rests on it: on such a piece the force has one inverse, and over
any part of it the force and the slope are bounded by their end values.
"""

import math
from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, Floats, Ints
from stepwell.kernels import entry, kernel, leaf
from stepwell.mechanism import (
    CURVE_HIGH,
    CURVE_LOW,
    FIRST,
    HIGH,
    LOW,
    Laws,
    Sheets,
    change_sheet,
    law,
    pick_rows,
    travel_of,
    turn_at,
)

_NODES = 13
_DEPTH = 40
# A Chebyshev series speaks for its function once its last coefficients are this small.
_RESOLVED = 1e-6
# A force that changes by less than this share of itself is constant but for rounding.
_FLAT = 1e-12
# More pieces in one cell than this and the search for them has gone astray.
MOST_PIECES = 1000
# Forces that reach no further than this are none [N].
NO_FORCE = 1e-12


class Pieces(NamedTuple):
    """P monotone pieces of all cells, in order of cell, sheet and travel; T sheets."""

    of_sheet: Ints  # (T + 1,) pieces of sheet t are of_sheet[t] .. of_sheet[t + 1] - 1
    among: Ints  # (N, 2) first and last piece of the sheet on which cell i stands
    left: Floats  # (P,) travel where the piece begins
    right: Floats  # (P,)
    force_left: Floats  # (P,)
    force_right: Floats  # (P,)
    sign: Ints  # (P,) of κ: +1, 0 for constant force, -1
    picked: Ints  # (P, bands + 1) rows, see pick_rows


def _transform() -> Floats:
    # Values at Chebyshev-Lobatto points to series coefficients.
    n = _NODES - 1
    j, k = np.meshgrid(np.arange(_NODES), np.arange(_NODES))
    matrix = np.cos(np.pi * j * k / n) * 2.0 / n
    matrix[[0, -1], :] /= 2
    matrix[:, [0, -1]] /= 2
    return matrix


_TO_SERIES = _transform()
_POINTS = np.cos(np.pi * np.arange(_NODES) / (_NODES - 1))


@kernel
def cut_points(laws: Laws, ends: Floats, cell: int) -> Floats:
    """Travels at which the law of `cell` may have a kink, ends and mid-way looks included."""
    r, sin_limit, low, high = (
        laws.lever[cell],
        laws.sin_limit[cell],
        ends[cell, LOW],
        ends[cell, HIGH],
    )
    count = 2
    for b in range(laws.band_first[cell], laws.band_first[cell + 1]):
        count += 2 * (laws.band_rows[b + 1] - laws.band_rows[b]) + 2
    count += laws.load_rows[cell, 1] - laws.load_rows[cell, 0]
    points = np.empty(count)
    points[0], points[1] = low, high
    used = 2
    for b in range(laws.band_first[cell], laws.band_first[cell + 1]):
        dx, dy, _, rest = laws.band[b]
        reach = np.sqrt(dx * dx + dy * dy)
        # Looking from where the band is longest and where it is shortest puts the dense ends of
        # the Chebyshev points at the only places where its law can turn sharply.
        sine = dy / reach if reach > 0.0 else 2.0
        for side in (-1.0, 1.0):
            travel = travel_of(side * sine, r, sin_limit)
            if low < travel < high:
                points[used] = travel
                used += 1
        for row in range(laws.band_rows[b], laws.band_rows[b + 1]):
            if row == laws.band_rows[b] and laws.two_sided[b]:
                continue
            length = rest + laws.rows[row, 0]
            cosine = turn_at(length, reach, r)
            if not -1.0 <= cosine <= 1.0:
                continue
            for side in (-1.0, 1.0):
                angle = math.atan2(dy, dx) + side * math.acos(cosine)
                angle = math.atan2(math.sin(angle), math.cos(angle))
                if abs(angle) < np.pi / 2:
                    travel = travel_of(math.sin(angle), r, sin_limit)
                    if low < travel < high:
                        points[used] = travel
                        used += 1
    for row in range(laws.load_rows[cell, 0], laws.load_rows[cell, 1]):
        if low < laws.rows[row, 0] < high:
            points[used] = laws.rows[row, 0]
            used += 1
    points = np.sort(points[:used])
    kept = 1
    for i in range(1, used):
        if points[i] - points[kept - 1] > 1e-12 * laws.full[cell]:
            points[kept] = points[i]
            kept += 1
    points[kept - 1] = high
    return points[:kept]


class Derivative(NamedTuple):
    """The force of a cell by its travel on fixed rows, or a derivative of it."""

    laws: Laws
    cell: int
    picked: Ints
    order: int  # 0 for F, 1 for κ, 2 for dκ/ds
    noise: float  # where it is nowhere larger than this it is zero, which has no sign to change


@kernel
def _verdict(of: Derivative, a: float, b: float) -> int:
    """0: no root of the derivative in [a, b]; 1: monotone there; 2: unknown."""
    laws, cell, picked, order, noise = of
    values = np.empty(_NODES)
    for i in range(_NODES):
        values[i] = law(laws, cell, picked, 0.5 * (a + b) + 0.5 * (b - a) * _POINTS[i])[order]
    series = np.zeros(_NODES)
    for k in range(_NODES):
        for i in range(_NODES):
            series[k] += _TO_SERIES[k, i] * values[i]
    rest, size = 0.0, abs(series[0])
    for k in range(1, _NODES):
        rest += abs(series[k])
        size = max(size, abs(series[k]))
    if size <= noise:
        return 0
    tail = abs(series[-1]) + abs(series[-2]) + abs(series[-3])
    if tail > _RESOLVED * size:
        return 2
    if abs(series[0]) > rest + 10.0 * tail:
        return 0
    # Coefficients of the derivative, by the backward recurrence.
    slopes = np.zeros(_NODES + 1)
    for k in range(_NODES - 1, 0, -1):
        above = slopes[k + 1] if k + 1 <= _NODES else 0.0
        slopes[k - 1] = above + 2.0 * k * series[k]
    slopes[0] /= 2.0
    rest = 0.0
    for k in range(1, _NODES - 1):
        rest += abs(slopes[k])
    if abs(slopes[0]) > rest + 10.0 * tail * _NODES * _NODES:
        return 1
    return 2


@leaf
def _largest(laws: Laws, cell: int, picked: Ints, a: float, b: float) -> tuple[float, float]:
    """Largest |F| and |κ| seen on [a, b]."""
    force, slope = 0.0, 0.0
    for i in range(_NODES):
        travel = 0.5 * (a + b) + 0.5 * (b - a) * _POINTS[i]
        value, stiff, _ = law(laws, cell, picked, travel)
        force, slope = max(force, abs(value)), max(slope, abs(stiff))
    return force, slope


@leaf
def _root(of: Derivative, a: float, b: float) -> float:
    """The sign change in [a, b], by bisection with a secant guess each time."""
    laws, cell, picked, order, _ = of
    fa = law(laws, cell, picked, a)[order]
    fb = law(laws, cell, picked, b)[order]
    for step in range(200):
        middle = 0.5 * (a + b)
        if not a < middle < b:
            break
        guess = b - fb * (b - a) / (fb - fa) if step % 2 == 0 and fb != fa else middle
        if not a < guess < b:
            guess = middle
        value = law(laws, cell, picked, guess)[order]
        if value == 0.0:
            return guess
        if (value < 0.0) == (fa < 0.0):
            a, fa = guess, value
        else:
            b, fb = guess, value
    return 0.5 * (a + b)


@kernel
def _roots(of: Derivative, a: float, b: float, out: Floats, used: int) -> int:
    """Append to `out` every root in (a, b), and any place where a root cannot be ruled out."""
    laws, cell, picked, order, _ = of
    left = np.empty(4 * _DEPTH)
    right = np.empty(4 * _DEPTH)
    depth = np.empty(4 * _DEPTH, np.int64)
    left[0], right[0], depth[0] = a, b, 0
    waiting = 1
    while waiting > 0 and used < len(out):
        waiting -= 1
        lo, hi, level = left[waiting], right[waiting], depth[waiting]
        verdict = _verdict(of, lo, hi)
        if verdict == 0:
            continue
        at_lo = law(laws, cell, picked, lo)[order]
        at_hi = law(laws, cell, picked, hi)[order]
        if verdict == 1 and (at_lo < 0.0) == (at_hi < 0.0):
            continue
        if verdict == 1:
            out[used] = _root(of, lo, hi)
            used += 1
        elif level >= _DEPTH or hi - lo < 1e-10 * (b - a):
            # A needless cut costs nothing; a missed one would cost the proof.
            out[used] = 0.5 * (lo + hi)
            used += 1
        else:
            middle = 0.5 * (lo + hi)
            left[waiting], right[waiting], depth[waiting] = middle, hi, level + 1
            left[waiting + 1], right[waiting + 1], depth[waiting + 1] = lo, middle, level + 1
            waiting += 2
    return used


def cut(laws: Laws, sheets: Sheets) -> Pieces:
    """All pieces of all cells."""
    cells = len(laws.lever)
    slots = int(np.max(np.diff(laws.band_first))) + 1
    room = 16 * cells + 64
    while True:
        among = np.zeros(len(sheets.table) + 1, np.int64), np.zeros((cells, 2), np.int64)
        columns = *np.empty((4, room)), np.empty(room, np.int64)
        pieces = Pieces._make((*among, *columns, np.full((room, slots), -1, np.int64)))
        total = _cut(laws, sheets, pieces)
        if total >= 0:
            return Pieces._make((*among, *(column[:total].copy() for column in pieces[2:])))
        room *= 2


@entry(6e-3, "laws.lever")
def _cut(laws: Laws, sheets: Sheets, out: Pieces) -> int:
    """Fill the pieces; how many there are, or -1 where they are more than fit in."""
    found = np.empty(4 * MOST_PIECES)
    rows = np.full(out.picked.shape[1], -1, np.int64)
    total = 0
    cell, last = -1, len(sheets.table)
    for sheet in range(last):
        cell += sheets.table[sheet, FIRST] == sheet
        change_sheet(laws, sheets, cell, sheet)
        out.of_sheet[sheet] = total
        total = _cut_sheet(laws, sheets.ends, cell, out, found, rows, total)
        if total < 0:
            return -1
    out.of_sheet[last] = total
    for i in range(len(laws.lever)):
        stand_on(laws, sheets, out, i, 0)
    return total


@kernel
def _cut_sheet(
    laws: Laws, ends: Floats, i: int, out: Pieces, found: Floats, rows: Ints, total: int
) -> int:
    """Append the pieces of the sheet on which a cell stands; how many there are then, or -1."""
    left, right, force_left, force_right = out.left, out.right, out.force_left, out.force_right
    sign, picked = out.sign, out.picked
    bands = laws.band_first[i + 1] - laws.band_first[i]
    points = cut_points(laws, ends, i)
    before = np.nan
    for j in range(len(points) - 1):
        a, b = points[j], points[j + 1]
        pick_rows(laws, i, 0.5 * (a + b), rows)
        flat = rows[bands] < 0
        load_row = rows[bands]
        if load_row >= 0:
            flat = (
                laws.rows[load_row, 2] == 0.0
                and laws.rows[load_row, 3] == 0.0
                and laws.rows[load_row, 4] == 0.0
            )
        for slot in range(bands):
            flat = flat and rows[slot] < 0
        used = 0
        if not flat:
            force, slope = _largest(laws, i, rows, a, b)
            flat = slope * (b - a) <= _FLAT * force
            # The pieces of an element come cut where they turn.
            if not flat and bands > 0:
                used = _roots(Derivative(laws, i, rows, 1, 0.0), a, b, found, used)
                steady = _FLAT * slope / (b - a)
                used = _roots(Derivative(laws, i, rows, 2, steady), a, b, found, used)
        cuts = np.empty(used + 2)
        cuts[0], cuts[1] = a, b
        cuts[2:] = found[:used]
        cuts = np.sort(cuts)
        for c in range(len(cuts) - 1):
            lo, hi = cuts[c], cuts[c + 1]
            if hi - lo <= 1e-13 * laws.full[i] and c + 2 < len(cuts):
                cuts[c + 1] = lo
                continue
            if total == len(left):
                return -1
            begin = law(laws, i, rows, lo)[0] if np.isnan(before) or flat else before
            end = begin if flat else law(laws, i, rows, hi)[0]
            if flat and not np.isnan(before):
                # A flat stretch is exact, the curve that runs into it is rounded.
                force_right[total - 1] = begin
            left[total], right[total] = lo, hi
            force_left[total], force_right[total] = begin, end
            sign[total] = 0 if end == begin else (1 if end > begin else -1)
            picked[total] = rows
            before = end
            total += 1
    return total


def of_curve(sheets: Sheets, pieces: Pieces) -> Bools:
    """(P,) which pieces lie on the curve of their cell, and not past an open end of it."""
    if np.array_equal(sheets.table[:, LOW:CURVE_LOW], sheets.table[:, CURVE_LOW : CURVE_HIGH + 1]):
        return np.ones(len(pieces.left), bool)
    own = np.repeat(np.arange(len(sheets.table)), np.diff(pieces.of_sheet))
    begin, end = sheets.table[own, CURVE_LOW : CURVE_HIGH + 1].T
    return (pieces.right > begin) & (pieces.left < end)


def force_scale(laws: Laws, sheets: Sheets, pieces: Pieces) -> float:
    """Largest force of any cell on its curve [N], against which tolerances are measured."""
    own = of_curve(sheets, pieces)
    forces = np.abs(np.concatenate([pieces.force_left[own], pieces.force_right[own]]))
    return float(max(np.max(forces), np.max(laws.friction), NO_FORCE))


@kernel
def travel_in(
    laws: Laws,
    sheets: Sheets,
    pieces: Pieces,
    cell: int,
    phase: tuple[int, float, float],
    force: float,
) -> float:
    """Travel of a cell in a phase at a force [m]; at an end of the phase past its forces.

    The phase is the sheet on which it lies, by number in the cell, and its ends [m].
    """
    sheet, low, high = phase
    if low == high:
        return low
    at = int(sheets.table[sheets.now[cell], FIRST]) + sheet
    begin, end = pieces.of_sheet[at], pieces.of_sheet[at + 1]
    # A phase begins and ends where pieces do.
    first = begin + np.searchsorted(pieces.left[begin:end], low)
    last = begin + np.searchsorted(pieces.right[begin:end], high, side="right") - 1
    if force <= pieces.force_left[first]:
        return float(pieces.left[first])
    if force >= pieces.force_right[last]:
        return float(pieces.right[last])
    piece = first + np.searchsorted(pieces.force_right[first : last + 1], force)
    return invert(laws, pieces, cell, piece, force)


@entry(1e-4, "out")
def travels_in(
    laws: Laws, sheets: Sheets, pieces: Pieces, phases: Floats, force: float, out: Floats
) -> None:
    """Travels of all cells in their (N, 3) phases at a force, into (N,) `out` [m]."""
    for i in range(len(out)):
        phase = int(phases[i, 0]), phases[i, 1], phases[i, 2]
        out[i] = travel_in(laws, sheets, pieces, i, phase, force)


@leaf
def stand_on(laws: Laws, sheets: Sheets, pieces: Pieces, cell: int, sheet: int) -> None:
    """Let a cell stand on a sheet of its curve, by its number there."""
    among_all = int(sheets.table[sheets.now[cell], FIRST]) + sheet
    change_sheet(laws, sheets, cell, among_all)
    pieces.among[cell, 0] = pieces.of_sheet[among_all]
    pieces.among[cell, 1] = pieces.of_sheet[among_all + 1] - 1


@leaf
def stand_all_on(laws: Laws, sheets: Sheets, pieces: Pieces, numbers: Ints) -> None:
    """Let every cell stand on its sheet, (N,) by number in the cell."""
    now, table = sheets.now, sheets.table
    for i in range(len(numbers)):
        if now[i] - int(table[now[i], FIRST]) != numbers[i]:
            stand_on(laws, sheets, pieces, i, numbers[i])


@leaf
def sheet_of(sheets: Sheets, cell: int) -> int:
    """The sheet of its curve on which a cell stands, by its number there."""
    return int(sheets.now[cell] - sheets.table[sheets.now[cell], FIRST])


@kernel
def sheets_of(sheets: Sheets) -> Ints:
    """(N,) the sheets on which the cells stand, each by its number in the cell."""
    now, table = sheets.now, sheets.table
    numbers = np.empty(len(now), np.int64)
    for i in range(len(numbers)):
        numbers[i] = now[i] - int(table[now[i], FIRST])
    return numbers


@leaf
def find_piece(pieces: Pieces, cell: int, travel: float, direction: int) -> int:
    """The piece of `cell` at `travel`; at a joint the one that lies in `direction`."""
    ends = pieces.right
    first, last = pieces.among[cell, 0], pieces.among[cell, 1]
    while first < last:
        middle = (first + last) // 2
        if ends[middle] < travel or (direction > 0 and ends[middle] <= travel):
            first = middle + 1
        else:
            last = middle
    return first


@leaf
def piece_along(pieces: Pieces, cell: int, piece: int, force: float) -> int:
    """The piece with a force, of those next to each other on which κ has the sign of `piece`."""
    first, last = pieces.among[cell, 0], pieces.among[cell, 1]
    sign, left, right = pieces.sign, pieces.force_left, pieces.force_right
    way = sign[piece]
    while piece < last and sign[piece + 1] == way and way * (force - right[piece]) > 0.0:
        piece += 1
    while piece > first and sign[piece - 1] == way and way * (force - left[piece]) < 0.0:
        piece -= 1
    return piece


@leaf
def resting_piece(pieces: Pieces, cell: int, travel: float) -> int:
    """The piece on which `cell` rests at `travel`; where its force turns, the one that rises."""
    piece = find_piece(pieces, cell, travel, 0)
    after = find_piece(pieces, cell, travel, 1)
    return after if pieces.sign[piece] < 0 and pieces.sign[after] >= 0 else piece


@leaf
def invert(laws: Laws, pieces: Pieces, cell: int, piece: int, force: float) -> float:
    """The travel on `piece` at which the cell pushes back with `force`, clipped to the piece."""
    return invert_near(laws, pieces, cell, piece, force, np.nan)


@leaf
def invert_near(
    laws: Laws, pieces: Pieces, cell: int, piece: int, force: float, near: float
) -> float:
    """The same, looked for from travel `near` on, where that is on the piece.

    Every step is to the root of the parabola that has the force, κ and dκ/ds here, which is near
    even next to an extremum.
    """
    a, b = pieces.left[piece], pieces.right[piece]
    fa, fb = pieces.force_left[piece], pieces.force_right[piece]
    rising, picked = pieces.sign[piece] > 0, pieces.picked[piece]
    if (force <= fa) == rising or force == fa:
        return a
    if (force >= fb) == rising or force == fb:
        return b
    travel = near if a < near < b else a + (b - a) * (force - fa) / (fb - fa)
    last, rounding = 0.0, 1e-16 * laws.full[cell]
    for _ in range(200):
        value, slope, bend = law(laws, cell, picked, travel)
        if value == force:
            return travel
        if (value < force) == rising:
            a = travel
        else:
            b = travel
        miss = force - value
        root = np.sqrt(max(slope * slope + 2.0 * bend * miss, 0.0))
        below = slope + root if rising else slope - root
        step = 2.0 * miss / below if below != 0.0 else np.inf
        size = abs(step)
        if size <= rounding or size * size * size <= rounding * last * last:
            # At this pace the next step would be below rounding.
            return min(max(travel + step, a), b)
        travel, last = travel + step, size
        if not a < travel < b:
            travel, last = 0.5 * (a + b), 0.0
            if not a < travel < b:
                break
    return travel
