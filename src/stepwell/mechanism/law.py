"""Compiled force, slope, curvature and energy of one cell; arrays of a chain for compiled code."""

import math
from collections.abc import Sequence
from itertools import chain as flatten
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import entry, leaf, record
from stepwell.mechanism import geometry, phase
from stepwell.mechanism.band import Band, Load
from stepwell.mechanism.cell import Cell
from stepwell.mechanism.cubics import COLUMNS, cubic, cubic_area
from stepwell.mechanism.element import Element


@record
class Laws(NamedTuple):
    """The cells of a chain as flat arrays; N cells, B bands, M curve rows."""

    lever: Floats  # (N,)
    sin_limit: Floats  # (N,)
    full: Floats  # (N,) full travel S
    friction: Floats  # (N,)
    band_first: Ints  # (N + 1,) bands of cell i are band_first[i] .. band_first[i + 1]
    band: Floats  # (B, 4) d_x, d_y, k, ℓ0
    two_sided: Ints  # (B,)
    band_rows: Ints  # (B + 1,) rows of band b
    load_rows: Ints  # (N, 2) rows of the load of cell i, or of the sheet on which an element stands
    rows: Floats  # (M, 6) piecewise cubics, see mechanism/cubics


@record
class Sheets(NamedTuple):
    """Sheets of the cells of a chain and their ends; N cells, T sheets.

    A cell has one sheet; elements whose curve folds back have more. `ends` and `now`, like the load
    rows of the laws, belong to the present sheets: the follower writes them as cells jump. They are
    separate from the laws, which compiled code passes on at every evaluation of a force.
    """

    ends: Floats  # (N, 4) travels between which cell i stands, and between which it can go
    now: Ints  # (N,) which of all sheets cell i stands on
    table: Floats  # (T, 9) see `Sheet`, in order of the cells


# Columns of `ends`, after LOW and HIGH: travels that a cell cannot pass; infinite at an end that
# leads to another sheet.
BEFORE, BEYOND = 2, 3


@leaf
def smallest(values: Floats | Ints) -> float:
    """The least of (N,) numbers; inf of none."""
    least = np.inf
    for value in values:
        least = min(least, value)
    return least


@leaf
def largest(values: Floats | Ints) -> float:
    """The largest of (N,) numbers; -inf of none."""
    most = -np.inf
    for value in values:
        most = max(most, value)
    return most


@leaf
def summed(values: Floats) -> float:
    """The sum of (N,) numbers from first to last; the order of NumPy depends on its version."""
    total = 0.0
    for value in values:
        total += value
    return total


@leaf
def change_sheet(laws: Laws, sheets: Sheets, cell: int, sheet: int) -> None:
    """Move a cell to another sheet, given by its number among all sheets."""
    row, ends = sheets.table[sheet], sheets.ends[cell]
    sheets.now[cell] = sheet
    laws.load_rows[cell, 0], laws.load_rows[cell, 1] = (
        int(row[phase.ROWS]),
        int(row[phase.ROWS_END]),
    )
    ends[phase.LOW], ends[phase.HIGH] = row[phase.LOW], row[phase.HIGH]
    ends[BEFORE] = row[phase.LOW] if row[phase.BELOW] < 0.0 else -np.inf
    ends[BEYOND] = row[phase.HIGH] if row[phase.ABOVE] < 0.0 else np.inf


@entry(1e-5, "sheets.now")
def ends_of(sheets: Sheets) -> tuple[float, float]:
    """Least and largest Σ s of the cells, open ends included as far as they extend."""
    table, low, high = sheets.table, 0.0, 0.0
    begin = 0
    for after in range(1, len(table) + 1):
        if after == len(table) or table[after, phase.FIRST] == after:
            low += smallest(table[begin:after, phase.LOW])
            high += largest(table[begin:after, phase.HIGH])
            begin = after
    return low, high


@leaf
def beyond(sheets: Sheets, cell: int, travel: float) -> int:
    """Number of the sheet to which a cell jumps at its travel; -1 where it does not jump."""
    row = sheets.table[sheets.now[cell]]
    if travel <= sheets.ends[cell, phase.LOW]:
        return int(row[phase.BELOW])
    return int(row[phase.ABOVE]) if travel >= sheets.ends[cell, phase.HIGH] else -1


@leaf
def pick_rows(laws: Laws, cell: int, travel: float, out: Ints) -> None:
    """Write the row of every band (and last of the load) of `cell` at `travel`; -1 for none.

    Fixed rows on a whole stretch make the law smooth there, past its ends too, so rounding errors
    near a kink have no effect downstream.
    """
    sin = geometry.sine_at(travel, laws.lever[cell], laws.sin_limit[cell])
    cos = np.sqrt(1.0 - sin * sin)
    slot = 0
    for b in range(laws.band_first[cell], laws.band_first[cell + 1]):
        dx, dy, rest = laws.band[b, 0], laws.band[b, 1], laws.band[b, 3]
        extension = geometry.band_length(sin, cos, dx, dy, laws.lever[cell]) - rest
        row = laws.band_rows[b]
        while row + 1 < laws.band_rows[b + 1] and laws.rows[row + 1, 0] <= extension:
            row += 1
        out[slot] = row if laws.two_sided[b] or extension > 0.0 else -1
        slot += 1
    first, last = laws.load_rows[cell, 0], laws.load_rows[cell, 1]
    row, after = first, last
    while row + 1 < after:
        middle = (row + after) // 2
        if laws.rows[middle, 0] <= travel:
            row = middle
        else:
            after = middle
    out[slot] = row if last > first else -1


@leaf
def _of_band(
    band: tuple[float, float, float, float],
    row: tuple[float, float, float, float, float],
    sin: float,
    cos: float,
    r: float,
) -> tuple[float, float, float]:
    """F, κ and dκ/ds of a band in tension from d_x, d_y, k, ℓ0 and its row."""
    dx, dy, k, rest = band
    x0, c0, c1, c2, c3 = row
    length = geometry.band_length(sin, cos, dx, dy, r)
    g, g1, g2 = geometry.reach_slopes(sin, cos, dx, dy, r)
    x = length - rest - x0
    t0, _, t2 = cubic(x, c0, c1, c2, c3)
    h = geometry.steepening(length, x, c0, c1, c2, c3)
    return geometry.force_slopes(k * t0, k * t2, k * h, length, g, g1, g2)


@leaf
def law(laws: Laws, cell: int, picked: Ints, travel: float) -> tuple[float, float, float]:
    """F [N], κ = dF/ds [N/m] and dκ/ds [N/m²] of a cell whose bands are on `picked` rows."""
    band, rows, r = laws.band, laws.rows, laws.lever[cell]
    sin = geometry.sine_at(travel, r, laws.sin_limit[cell])
    cos = np.sqrt(1.0 - sin * sin)
    force, slope, bend, slot = 0.0, 0.0, 0.0, 0
    for b in range(laws.band_first[cell], laws.band_first[cell + 1]):
        row = picked[slot]
        slot += 1
        if row < 0:
            continue
        numbers = band[b, 0], band[b, 1], band[b, 2], band[b, 3]
        on = rows[row, 0], rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4]
        f0, f1, f2 = _of_band(numbers, on, sin, cos, r)
        force += f0
        slope += f1
        bend += f2
    row = picked[slot]
    if row >= 0:
        x = travel - rows[row, 0]
        f0, f1, f2 = cubic(x, rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4])
        force += f0
        slope += f1
        bend += f2
    return force, slope, bend


@record
class Looks(NamedTuple):
    """Values of the law of a cell at n travels."""

    travel: Floats  # (n,)
    sin: Floats  # (n,)
    cos: Floats  # (n,)
    force: Floats  # (n,)
    slope: Floats  # (n,)
    bend: Floats  # (n,)


@leaf
def law_along(laws: Laws, cell: int, picked: Ints, at: Looks) -> None:
    """`law` at n travels, band by band, so that machine code computes several at once."""
    band, rows, r, limit = laws.band, laws.rows, laws.lever[cell], laws.sin_limit[cell]
    travel, sin, cos, force, slope, bend = at.travel, at.sin, at.cos, at.force, at.slope, at.bend
    n = len(travel)
    for i in range(n):
        sin[i] = geometry.sine_at(travel[i], r, limit)
        cos[i] = np.sqrt(1.0 - sin[i] * sin[i])
        force[i], slope[i], bend[i] = 0.0, 0.0, 0.0
    slot = 0
    for b in range(laws.band_first[cell], laws.band_first[cell + 1]):
        row = picked[slot]
        slot += 1
        if row < 0:
            continue
        numbers = band[b, 0], band[b, 1], band[b, 2], band[b, 3]
        on = rows[row, 0], rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4]
        for i in range(n):
            f0, f1, f2 = _of_band(numbers, on, sin[i], cos[i], r)
            force[i] += f0
            slope[i] += f1
            bend[i] += f2
    row = picked[slot]
    if row >= 0:
        x0, c0, c1, c2, c3 = rows[row, 0], rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4]
        for i in range(n):
            f0, f1, f2 = cubic(travel[i] - x0, c0, c1, c2, c3)
            force[i] += f0
            slope[i] += f1
            bend[i] += f2


@leaf
def stored(laws: Laws, cell: int, picked: Ints, travel: float) -> float:
    """Energy [J] of a cell whose bands are on `picked` rows; the load counts from travel 0."""
    band, rows, r = laws.band, laws.rows, laws.lever[cell]
    sin = geometry.sine_at(travel, r, laws.sin_limit[cell])
    cos = np.sqrt(1.0 - sin * sin)
    energy, slot = 0.0, 0
    for b in range(laws.band_first[cell], laws.band_first[cell + 1]):
        row = picked[slot]
        slot += 1
        if row < 0:
            continue
        dx, dy, k, rest = band[b, 0], band[b, 1], band[b, 2], band[b, 3]
        x = geometry.band_length(sin, cos, dx, dy, r) - rest - rows[row, 0]
        c0, c1, c2, c3 = rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4]
        energy += geometry.band_energy(k, cubic_area(x, c0, c1, c2, c3, rows[row, 5]))
    row = picked[slot]
    if row >= 0:
        x = travel - rows[row, 0]
        c0, c1, c2, c3 = rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4]
        energy += cubic_area(x, c0, c1, c2, c3, rows[row, 5])
    return energy


def packed(cells: Sequence[Cell | Element]) -> tuple[Laws, Sheets]:
    """Laws and sheets of the cells, inner first, each on its first sheet."""
    # A chain may have very many cells: every attribute of them is read once.
    n = len(cells)
    levers = [cell for cell in cells if isinstance(cell, Cell)]
    is_lever = np.array([isinstance(cell, Cell) for cell in cells])
    # The lever of an element is never used by a band; this value keeps sine and cosine finite.
    lever, sin_limit, full = np.full(n, np.inf), np.zeros(n), np.empty(n)
    lever[is_lever] = [cell.lever for cell in levers]
    sin_limit[is_lever] = [math.sin(cell.limit) for cell in levers]
    full[is_lever] = geometry.travel_of(sin_limit[is_lever], lever[is_lever], sin_limit[is_lever])

    own, (counts, flat, band, curves) = np.zeros(n, int), _of_bands(levers)
    own[is_lever] = counts
    band_rows = _starts(list(map(len, curves)))

    # A lever cell has one sheet, from stop to stop, and its curve is that of its load.
    packs = [_of_load(cell.load) if isinstance(cell, Cell) else cell.packed for cell in cells]
    table = _rows_of(phase.SHEET_COLUMNS, [sheets for sheets, _ in packs])
    is_first = table[:, phase.FIRST] == 0
    now, cell_of = np.flatnonzero(is_first), np.cumsum(is_first) - 1
    of_lever = is_lever[cell_of]
    table[of_lever, phase.HIGH] = table[of_lever, phase.CURVE_HIGH] = full[is_lever]
    full = np.maximum.reduceat(table[:, phase.CURVE_HIGH], now)
    full -= np.minimum.reduceat(table[:, phase.CURVE_LOW], now)
    starts = band_rows[-1] + _starts(table[:, phase.ROWS_END])
    table[:, phase.ROWS], table[:, phase.ROWS_END], table[:, phase.FIRST] = (
        starts[:-1],
        starts[1:],
        now[cell_of],
    )
    leads = table[:, phase.BELOW : phase.ABOVE + 1]
    leads += np.where(leads < 0, 0, now[cell_of, None])
    rows = np.concatenate(curves + [loads for _, loads in packs])
    friction = np.array([cell.friction for cell in cells])

    if np.isinf(table[:, [phase.LOW, phase.HIGH]]).any():
        reach = 4.0 * float(np.max([cell.largest_force for cell in cells] + friction))
        _extend(table, rows, starts, full[cell_of], reach)
    two_sided = np.array([b.two_sided for b in flat], int)
    load_rows = table[now, phase.ROWS : phase.ROWS_END + 1].astype(int)
    of_bands = _starts(own), band, two_sided, band_rows
    laws = Laws(lever, sin_limit, full, friction, *of_bands, load_rows, rows)
    # A cell cannot pass its ends, except where an element folds back.
    ends = table[now[:, None], [phase.LOW, phase.HIGH, phase.LOW, phase.HIGH]]
    ends[table[now, phase.BELOW] >= 0, BEFORE] = -np.inf
    ends[table[now, phase.ABOVE] >= 0, BEYOND] = np.inf
    return laws, Sheets(ends, now, table)


def _of_bands(levers: Sequence[Cell]) -> tuple[list[int], list[Band], Floats, list[Floats]]:
    """Counts of bands of cells, all bands, their q - p, k and ℓ0 (bands, 4), and their laws."""
    per_cell = [(cell.band,) if isinstance(cell.band, Band) else cell.band for cell in levers]
    bands = list(flatten.from_iterable(per_cell))
    band = np.empty((len(bands), 4))
    band[:, :2] = _rows_of(2, [b.q for b in bands]) - _rows_of(2, [b.p for b in bands])
    band[:, 2], band[:, 3] = [b.stiffness for b in bands], [b.rest_length for b in bands]
    # Most bands share one law, so the rows of each law are computed once.
    laws_of = [b.law for b in bands]
    known = dict(zip(map(id, laws_of), laws_of, strict=True))
    pieces = {name: law.pieces() for name, law in known.items()}
    return list(map(len, per_cell)), bands, band, list(map(pieces.__getitem__, map(id, laws_of)))


def _extend(table: Floats, rows: Floats, starts: Ints, full: Floats, reach: float) -> None:
    """Extend open ends of sheets straight, up to the largest force, `reach` [N].

    `full` is the travel of the cell of each sheet [m].
    """
    low, high = np.isinf(table[:, phase.LOW]), np.isinf(table[:, phase.HIGH])
    first, last = starts[:-1][low], starts[1:][high] - 1
    rows[first] = phase.before(rows[first + 1], -reach)
    table[low, phase.LOW] = rows[first, 0]
    end, force, slope = rows[last, :3].T
    table[high, phase.HIGH] = end + np.maximum((reach - force) / slope, 1e-3 * full[high])


def _of_load(load: Load | None) -> tuple[tuple[float, ...], Floats]:
    """The only sheet of a lever cell with this load, as `Element.packed`; its high end is 0."""
    rows = _NO_ROWS if load is None else load.pieces()
    return (0.0, 0.0, 0.0, 0.0, 0.0, len(rows), -1.0, -1.0, 0.0), rows


_NO_ROWS = np.empty((0, COLUMNS))


def _rows_of(columns: int, values: Sequence[Sequence[float]]) -> Floats:
    return np.fromiter(flatten.from_iterable(values), float).reshape(-1, columns)


def _starts(sizes: Sequence[int] | Ints | Floats) -> Ints:
    """Where stretches of these sizes begin, and where the last one ends."""
    return np.append(0, np.cumsum(np.asarray(sizes, int)))
