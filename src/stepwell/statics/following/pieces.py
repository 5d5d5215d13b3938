"""Cutting a cell's law into pieces on which force and slope are both monotone.

All exact results of this package are based on it: on such a piece the force has one inverse, and
over any part of it the force and the slope are bounded by their end values.
"""

import math
from typing import NamedTuple

import numpy as np

from stepwell import mechanism as mech
from stepwell.base import Bools, Floats, Ints
from stepwell.kernels import entry, kernel, leaf, record
from stepwell.mechanism import Laws, Looks, Sheets, geometry

_NODES = 13
_DEPTH = 40
# A Chebyshev series represents its function once its last coefficients are this small.
_RESOLVED = 1e-6
# A force that changes by less than this fraction of itself is constant but for rounding.
_FLAT = 1e-12
# With more pieces in one cell the search for them has failed.
MOST_PIECES = 1000
# Forces below this are zero [N].
NO_FORCE = 1e-12


@record
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


@record
class CuttingSpace(NamedTuple):
    """Work memory of cutting, so that no cut makes an array."""

    points: Floats  # (kinks,)
    cuts: Floats  # (4 MOST_PIECES,)
    rows: Ints  # (bands + 1,)
    at: Looks  # the nodes of a stretch
    series: Floats  # (2, _NODES + 1) of a function there, and of its derivative
    ends: Floats  # (2, 4 _DEPTH) stretches that wait
    depth: Ints  # (2, 4 _DEPTH) how small they are, and what is open on them


def cutting_space(laws: Laws) -> CuttingSpace:
    """Work memory to cut these cells."""
    bands = int(np.max(np.diff(laws.band_first)))
    points, cuts = np.empty(2 + 2 * len(laws.rows) + 4 * bands), np.empty(4 * MOST_PIECES)
    rows, at = np.empty(bands + 1, np.int64), Looks._make(np.empty((6, _NODES)))
    ends, depth = np.empty((2, 4 * _DEPTH)), np.empty((2, 4 * _DEPTH), np.int64)
    return CuttingSpace(points, cuts, rows, at, np.empty((2, _NODES + 1)), ends, depth)


@leaf
def _sort(values: Floats, count: int) -> None:
    for i in range(1, count):
        value, j = values[i], i
        while j > 0 and values[j - 1] > value:
            values[j] = values[j - 1]
            j -= 1
        values[j] = value


@leaf
def _kinks(laws: Laws, ends: Floats, cell: int, points: Floats) -> int:
    """Travels at which the law of `cell` may have a kink, ends and mid-way looks included."""
    # One function: bands and loads add to the same list of travels.
    r, sin_limit = laws.lever[cell], laws.sin_limit[cell]
    low, high = ends[cell, mech.LOW], ends[cell, mech.HIGH]
    points[0], points[1], used = low, high, 2
    for b in range(laws.band_first[cell], laws.band_first[cell + 1]):
        dx, dy, rest = laws.band[b, 0], laws.band[b, 1], laws.band[b, 3]
        reach = np.sqrt(dx * dx + dy * dy)
        # Cuts where the band is longest and shortest put the dense ends of the Chebyshev points at
        # the only places where its law can turn sharply.
        sine = dy / reach if reach > 0.0 else 2.0
        for side in (-1.0, 1.0):
            travel = geometry.travel_of(side * sine, r, sin_limit)
            if low < travel < high:
                points[used] = travel
                used += 1
        for row in range(laws.band_rows[b], laws.band_rows[b + 1]):
            if row == laws.band_rows[b] and laws.two_sided[b]:
                continue
            length = rest + laws.rows[row, 0]
            cosine = geometry.turn_at(length, reach, r)
            if not -1.0 <= cosine <= 1.0:
                continue
            for side in (-1.0, 1.0):
                angle = math.atan2(dy, dx) + side * math.acos(cosine)
                angle = math.atan2(math.sin(angle), math.cos(angle))
                if abs(angle) < np.pi / 2:
                    travel = geometry.travel_of(math.sin(angle), r, sin_limit)
                    if low < travel < high:
                        points[used] = travel
                        used += 1
    for row in range(laws.load_rows[cell, 0], laws.load_rows[cell, 1]):
        if low < laws.rows[row, 0] < high:
            points[used] = laws.rows[row, 0]
            used += 1
    # Those of an element are in order but for the end.
    _sort(points, used)
    kept = 1
    for i in range(1, used):
        if points[i] - points[kept - 1] > 1e-12 * laws.full[cell]:
            points[kept] = points[i]
            kept += 1
    points[kept - 1] = high
    return kept


@leaf
def _look(laws: Laws, cell: int, a: float, b: float, room: CuttingSpace) -> None:
    """F, κ and dκ/ds at the Chebyshev points of [a, b], of which the first is b and the last a."""
    travel = room.at.travel
    for i in range(_NODES):
        travel[i] = 0.5 * (a + b) + 0.5 * (b - a) * _POINTS[i]
    travel[0], travel[_NODES - 1] = b, a
    mech.law_along(laws, cell, room.rows, room.at)


@leaf
def _verdict(values: Floats, noise: float, room: CuttingSpace) -> int:
    """0: no root of a function with these values, or only noise; 1: monotone; 2: undecided."""
    series, slopes = room.series[0], room.series[1]
    series[:] = 0.0
    for i in range(_NODES):
        for k in range(_NODES):
            series[k] += _TO_SERIES[i, k] * values[i]
    rest, size = 0.0, abs(series[0])
    for k in range(1, _NODES):
        rest += abs(series[k])
        size = max(size, abs(series[k]))
    if size <= noise:
        return 0
    tail = abs(series[_NODES - 1]) + abs(series[_NODES - 2]) + abs(series[_NODES - 3])
    if tail > _RESOLVED * size:
        return 2
    if abs(series[0]) > rest + 10.0 * tail:
        return 0
    # Coefficients of the derivative, by the backward recurrence.
    slopes[_NODES] = slopes[_NODES - 1] = 0.0
    for k in range(_NODES - 1, 0, -1):
        slopes[k - 1] = slopes[k + 1] + 2.0 * k * series[k]
    rest = 0.0
    for k in range(1, _NODES - 1):
        rest += abs(slopes[k])
    return 1 if abs(0.5 * slopes[0]) > rest + 10.0 * tail * _NODES * _NODES else 2


@leaf
def _root(
    laws: Laws, cell: int, picked: Ints, order: int, ends: tuple[float, float, float, float]
) -> float:
    """The sign change of F, κ or dκ/ds between two travels; `ends` are these and what is there."""
    # The secant with half the value of an end that stays (Dowell and Jarratt 1971), or the middle.
    a, b, fa, fb = ends
    falls, stays, last = fa < 0.0, 0, a
    for step in range(200):
        middle = 0.5 * (a + b)
        if not a < middle < b:
            break
        guess = b - fb * (b - a) / (fb - fa) if step % 4 != 3 and fb != fa else middle
        if not a < guess < b:
            guess = middle
        value = mech.law(laws, cell, picked, guess)[order]
        if value == 0.0 or abs(guess - last) <= 1e-16 * laws.full[cell]:
            return guess
        last = guess
        if (value < 0.0) == falls:
            a, fa = guess, value
            fb *= 0.5 if stays == 1 else 1.0
            stays = 1
        else:
            b, fb = guess, value
            fa *= 0.5 if stays == -1 else 1.0
            stays = -1
    return 0.5 * (a + b)


@leaf
def _turns(laws: Laws, cell: int, a: float, b: float, noise: float, room: CuttingSpace) -> int:
    """Write all travels in (a, b) where κ or dκ/ds has or may have a root; returns their number."""
    # One function: halves wait on one stack, whose height is a local like the count.
    at, out, picked = room.at, room.cuts, room.rows
    lefts, rights, depth, open_on = room.ends[0], room.ends[1], room.depth[0], room.depth[1]
    lefts[0], rights[0], depth[0], open_on[0] = a, b, 0, 3
    waiting, used = 1, 0
    while waiting > 0:
        waiting -= 1
        lo, hi, level, asked = lefts[waiting], rights[waiting], depth[waiting], open_on[waiting]
        if level > 0:
            _look(laws, cell, lo, hi, room)
        unknown = 0
        # 1 for κ, 2 for dκ/ds, as in what a law returns.
        for order in (1, 2):
            if not asked & order:
                continue
            values = at.slope if order == 1 else at.bend
            verdict = _verdict(values, 0.0 if order == 1 else noise, room)
            at_lo, at_hi = values[_NODES - 1], values[0]
            if verdict == 2:
                unknown += order
            elif verdict == 1 and (at_lo < 0.0) != (at_hi < 0.0):
                if used == len(out):
                    return used
                out[used] = _root(laws, cell, picked, order, (lo, hi, at_lo, at_hi))
                used += 1
        if unknown == 0:
            continue
        middle = 0.5 * (lo + hi)
        if level >= _DEPTH or hi - lo < 1e-10 * (b - a):
            # A needless cut costs nothing; a missed one would cost the proof.
            if used == len(out):
                return used
            out[used] = middle
            used += 1
        else:
            lefts[waiting], rights[waiting] = middle, hi
            lefts[waiting + 1], rights[waiting + 1] = lo, middle
            for j in (waiting, waiting + 1):
                depth[j], open_on[j] = level + 1, unknown
            waiting += 2
    return used


def cut(laws: Laws, sheets: Sheets) -> Pieces:
    """All pieces of all cells."""
    size = 16 * len(laws.lever) + len(laws.rows) + 64
    while True:
        pieces = memory_for_pieces(laws, sheets, size)
        total = cut_into(laws, sheets, pieces, cutting_space(laws))
        if total >= 0:
            columns = (column[:total].copy() for column in pieces[2:])
            return Pieces._make((*pieces[:2], *columns))
        size *= 2


def memory_for_pieces(laws: Laws, sheets: Sheets, size: int) -> Pieces:
    """Memory for this number of pieces."""
    cells, slots = len(laws.lever), int(np.max(np.diff(laws.band_first))) + 1
    among = np.zeros(len(sheets.table) + 1, np.int64), np.zeros((cells, 2), np.int64)
    columns = *np.empty((4, size)), np.empty(size, np.int64)
    return Pieces._make((*among, *columns, np.full((size, slots), -1, np.int64)))


@entry(1e-3, "laws.lever")
@leaf
def cut_into(laws: Laws, sheets: Sheets, out: Pieces, room: CuttingSpace) -> int:
    """Fill the pieces; returns their number, or -1 where the memory is too small."""
    total = 0
    cell, last = -1, len(sheets.table)
    for sheet in range(last):
        cell += sheets.table[sheet, mech.FIRST] == sheet
        mech.change_sheet(laws, sheets, cell, sheet)
        out.of_sheet[sheet] = total
        total = _cut_sheet(laws, sheets.ends, cell, out, room, total)
        if total < 0:
            return -1
    out.of_sheet[last] = total
    for i in range(len(laws.lever)):
        stand_on(laws, sheets, out, i, 0)
    return total


@leaf
def _cut_sheet(
    laws: Laws, ends: Floats, i: int, out: Pieces, room: CuttingSpace, total: int
) -> int:
    """Append the pieces of a cell's sheet; returns the number of all pieces, or -1."""
    # One function: every cut writes to the same arrays, which are taken out once.
    left, right, force_left, force_right = out.left, out.right, out.force_left, out.force_right
    sign, picked, rows, cuts = out.sign, out.picked, room.rows, room.cuts
    bands = laws.band_first[i + 1] - laws.band_first[i]
    kinks = _kinks(laws, ends, i, room.points)
    before = np.nan
    for j in range(kinks - 1):
        a, b = room.points[j], room.points[j + 1]
        mech.pick_rows(laws, i, 0.5 * (a + b), rows)
        flat, used = _is_flat(laws, rows, bands), 0
        if not flat:
            force, slope = _steepest(laws, i, a, b, room)
            flat = slope * (b - a) <= _FLAT * force
            if not flat and bands > 0:
                used = _turns(laws, i, a, b, _FLAT * slope / (b - a), room)
                _sort(cuts, used)
        lo = a
        for c in range(used + 1):
            hi = cuts[c] if c < used else b
            if hi - lo <= 1e-13 * laws.full[i] and c < used:
                continue
            if total == len(left):
                return -1
            begin = mech.law(laws, i, rows, lo)[0] if np.isnan(before) or flat else before
            end = begin if flat else mech.law(laws, i, rows, hi)[0]
            if flat and not np.isnan(before):
                # A flat stretch is exact, the curve that runs into it is rounded.
                force_right[total - 1] = begin
            left[total], right[total] = lo, hi
            force_left[total], force_right[total] = begin, end
            sign[total] = 0 if end == begin else (1 if end > begin else -1)
            for slot in range(bands + 1):
                picked[total, slot] = rows[slot]
            before, lo = end, hi
            total += 1
    return total


@leaf
def _steepest(laws: Laws, i: int, a: float, b: float, room: CuttingSpace) -> tuple[float, float]:
    """The largest force and slope of a cell between two kinks, on the rows picked there."""
    force, slope = 0.0, 0.0
    if laws.band_first[i] < laws.band_first[i + 1]:
        _look(laws, i, a, b, room)
        for node in range(_NODES):
            force = max(force, abs(room.at.force[node]))
            slope = max(slope, abs(room.at.slope[node]))
    else:
        # The rows of an element come cut where they turn: they are largest at their ends.
        for end in (a, b):
            value, stiff, _ = mech.law(laws, i, room.rows, end)
            force, slope = max(force, abs(value)), max(slope, abs(stiff))
    return force, slope


@leaf
def _is_flat(laws: Laws, rows: Ints, bands: int) -> bool:
    """Whether a cell on these rows has a constant force: no band in tension, no varying load."""
    for slot in range(bands):
        if rows[slot] >= 0:
            return False
    load = rows[bands]
    return load < 0 or (
        laws.rows[load, 2] == 0.0 and laws.rows[load, 3] == 0.0 and laws.rows[load, 4] == 0.0
    )


def of_curve(sheets: Sheets, pieces: Pieces) -> Bools:
    """(P,) whether a piece lies on the curve of its cell, and not past an open end."""
    own = np.repeat(np.arange(len(sheets.table)), np.diff(pieces.of_sheet))
    begin, end = sheets.table[own, mech.CURVE_LOW : mech.CURVE_HIGH + 1].T
    return (pieces.right > begin) & (pieces.left < end)


@entry(1e-6, "pieces.left")
@leaf
def force_scale(laws: Laws, sheets: Sheets, pieces: Pieces) -> float:
    """Largest force of any cell on its curve [N], against which tolerances are measured."""
    left, right, begins, ends = pieces.left, pieces.right, pieces.force_left, pieces.force_right
    most = NO_FORCE
    for i in range(len(laws.friction)):
        most = max(most, laws.friction[i])
    for sheet in range(len(sheets.table)):
        low, high = sheets.table[sheet, mech.CURVE_LOW], sheets.table[sheet, mech.CURVE_HIGH]
        for k in range(pieces.of_sheet[sheet], pieces.of_sheet[sheet + 1]):
            if right[k] > low and left[k] < high:
                most = max(most, abs(begins[k]), abs(ends[k]))
    return most


@leaf
def stand_on(laws: Laws, sheets: Sheets, pieces: Pieces, cell: int, sheet: int) -> None:
    """Move a cell to a sheet of its curve, by its number in the cell."""
    among_all = int(sheets.table[sheets.now[cell], mech.FIRST]) + sheet
    mech.change_sheet(laws, sheets, cell, among_all)
    pieces.among[cell, 0] = pieces.of_sheet[among_all]
    pieces.among[cell, 1] = pieces.of_sheet[among_all + 1] - 1


@leaf
def stand_all_on(laws: Laws, sheets: Sheets, pieces: Pieces, numbers: Ints) -> None:
    """Move every cell to its sheet, (N,) by number in the cell."""
    for i in range(len(numbers)):
        if sheet_of(sheets, i) != numbers[i]:
            stand_on(laws, sheets, pieces, i, numbers[i])


@leaf
def sheet_of(sheets: Sheets, cell: int) -> int:
    """The present sheet of a cell, by its number in the cell."""
    return int(sheets.now[cell] - sheets.table[sheets.now[cell], mech.FIRST])


@kernel
def sheets_of(sheets: Sheets) -> Ints:
    """(N,) the present sheets of the cells, each by its number in the cell."""
    numbers = np.empty(len(sheets.now), np.int64)
    for i in range(len(numbers)):
        numbers[i] = sheet_of(sheets, i)
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
    """The piece that contains a force, among neighbours on which κ has the sign of `piece`."""
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
    """The travel on `piece` at which the cell resists with `force`, clipped to the piece."""
    return invert_near(laws, pieces, cell, piece, force, np.nan)


@leaf
def _first_at(values: Floats, begin: int, end: int, bound: float) -> int:
    """The first of rising values from `begin` to before `end` that is not below a bound."""
    while begin < end:
        middle = (begin + end) // 2
        if values[middle] < bound:
            begin = middle + 1
        else:
            end = middle
    return begin


@leaf
def travel_between(
    laws: Laws,
    sheets: Sheets,
    pieces: Pieces,
    cell: int,
    stretch: tuple[int, float, float],
    force: float,
) -> float:
    """Travel of a cell on a stretch of rising force [m], (sheet, low, high); clipped to it."""
    sheet, low, high = stretch
    if low == high:
        return low
    at = int(sheets.table[sheets.now[cell], mech.FIRST]) + sheet
    # A phase begins and ends where pieces do.
    begin, end = pieces.of_sheet[at], pieces.of_sheet[at + 1]
    first = _first_at(pieces.left, begin, end, low)
    last = min(_first_at(pieces.right, begin, end, high), end - 1)
    if force <= pieces.force_left[first]:
        return float(pieces.left[first])
    if force >= pieces.force_right[last]:
        return float(pieces.right[last])
    piece = _first_at(pieces.force_right, first, last + 1, force)
    return invert(laws, pieces, cell, piece, force)


@leaf
def invert_near(
    laws: Laws, pieces: Pieces, cell: int, piece: int, force: float, near: float
) -> float:
    """`invert` from travel `near` on, by roots of parabolas, also next to an extremum."""
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
        value, slope, bend = mech.law(laws, cell, picked, travel)
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


@entry(1e-4, "out")
def travels_between(
    laws: Laws, sheets: Sheets, pieces: Pieces, stretches: Floats, force: float, out: Floats
) -> None:
    """`travel_between` of all cells on their (N, 3) stretches, into (N,) `out`."""
    for i in range(len(out)):
        stretch = int(stretches[i, 0]), stretches[i, 1], stretches[i, 2]
        out[i] = travel_between(laws, sheets, pieces, i, stretch, force)
