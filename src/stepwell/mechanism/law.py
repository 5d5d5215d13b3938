"""Force, slope, curvature and energy of one cell at one travel, compiled; chains made ready."""

from collections.abc import Iterable, Sequence
from itertools import accumulate, chain as flatten, pairwise
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel, leaf
from stepwell.mechanism.cell import Cell
from stepwell.mechanism.cubics import cubic, cubic_area
from stepwell.mechanism.elements import Element
from stepwell.mechanism.geometry import (
    band_energy,
    band_length,
    force_slopes,
    length_slopes,
    sine_at,
)


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


class Sheets(NamedTuple):
    """Where the cells of a chain end; N cells, T sheets.

    A cell has one sheet, but for elements whose curve folds back. `ends` and `now`, like the load
    rows of the laws, are those on which it stands: the follower writes them as cells jump. They
    stand apart from the laws, which compiled code passes on at every look at a force.
    """

    ends: Floats  # (N, 4) travels between which cell i stands, and between which it can go
    now: Ints  # (N,) which of all sheets cell i stands on
    table: Floats  # (T, 9) see below, in order of the cells


# Columns of a sheet: its ends; the same without what an open end goes on beyond the curve; its
# rows; the sheets to which it leads from below and above, or -1; and the first sheet of its cell.
LOW, HIGH, CURVE_LOW, CURVE_HIGH, ROWS, ROWS_END, BELOW, ABOVE, FIRST = range(9)
# Columns of `ends`, after LOW and HIGH: where a cell can go no further, which an end that leads on
# is not.
BEFORE, BEYOND = 2, 3


@leaf
def summed(values: Floats) -> float:
    """The sum of (N,) numbers from first to last, where NumPy's own order hangs on its version."""
    total = 0.0
    for value in values:
        total += value
    return total


@leaf
def change_sheet(laws: Laws, sheets: Sheets, cell: int, sheet: int) -> None:
    """Let a cell stand on another sheet, by its number among all."""
    row, ends = sheets.table[sheet], sheets.ends[cell]
    sheets.now[cell] = sheet
    laws.load_rows[cell, 0], laws.load_rows[cell, 1] = int(row[ROWS]), int(row[ROWS_END])
    ends[LOW], ends[HIGH] = row[LOW], row[HIGH]
    ends[BEFORE] = row[LOW] if row[BELOW] < 0.0 else -np.inf
    ends[BEYOND] = row[HIGH] if row[ABOVE] < 0.0 else np.inf


@kernel
def ends_of(sheets: Sheets) -> tuple[float, float]:
    """Least and largest Σ s that the cells have, with open ends as far as they go on."""
    table, low, high = sheets.table, 0.0, 0.0
    begin = 0
    for after in range(1, len(table) + 1):
        if after == len(table) or table[after, FIRST] == after:
            low += np.min(table[begin:after, LOW])
            high += np.max(table[begin:after, HIGH])
            begin = after
    return low, high


@leaf
def beyond(sheets: Sheets, cell: int, travel: float) -> int:
    """The sheet, among all, to which a cell jumps where it stands; -1 where it does not."""
    row = sheets.table[sheets.now[cell]]
    if travel <= sheets.ends[cell, LOW]:
        return int(row[BELOW])
    return int(row[ABOVE]) if travel >= sheets.ends[cell, HIGH] else -1


@leaf
def pick_rows(laws: Laws, cell: int, travel: float, out: Ints) -> None:
    """Which row every band (and last the load) of `cell` is on at `travel`; -1 for none.

    Fixing the rows on a whole stretch makes the law smooth there, past its ends too, so
    nothing downstream has to ask on which side of a kink a rounding error fell.
    """
    sin = sine_at(travel, laws.lever[cell], laws.sin_limit[cell])
    cos = np.sqrt(1.0 - sin * sin)
    slot = 0
    for b in range(laws.band_first[cell], laws.band_first[cell + 1]):
        dx, dy, rest = laws.band[b, 0], laws.band[b, 1], laws.band[b, 3]
        extension = band_length(sin, cos, dx, dy, laws.lever[cell]) - rest
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
    """F, κ and dκ/ds that a taut band makes of d_x, d_y, k, ℓ0 and its row."""
    dx, dy, k, rest = band
    x0, c0, c1, c2, c3 = row
    length = band_length(sin, cos, dx, dy, r)
    l1, l2, l3 = length_slopes(sin, cos, length, dx, dy, r)
    t0, t1, t2 = cubic(length - rest - x0, c0, c1, c2, c3)
    return force_slopes(k * t0, k * t1, k * t2, l1, l2, l3)


@leaf
def law(laws: Laws, cell: int, picked: Ints, travel: float) -> tuple[float, float, float]:
    """F [N], κ = dF/ds [N/m] and dκ/ds [N/m²] of a cell whose bands are on `picked` rows."""
    band, rows, r = laws.band, laws.rows, laws.lever[cell]
    sin = sine_at(travel, r, laws.sin_limit[cell])
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


class Looks(NamedTuple):
    """Travels of a cell, and its law there; n of them."""

    travel: Floats  # (n,)
    sin: Floats  # (n,)
    cos: Floats  # (n,)
    force: Floats  # (n,)
    slope: Floats  # (n,)
    bend: Floats  # (n,)


@leaf
def law_along(laws: Laws, cell: int, picked: Ints, at: Looks) -> None:
    """The same at many travels, band by band, so that machine code does several at once."""
    band, rows, r, limit = laws.band, laws.rows, laws.lever[cell], laws.sin_limit[cell]
    travel, sin, cos, force, slope, bend = at
    n = len(travel)
    for i in range(n):
        sin[i] = sine_at(travel[i], r, limit)
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
    sin = sine_at(travel, r, laws.sin_limit[cell])
    cos = np.sqrt(1.0 - sin * sin)
    energy, slot = 0.0, 0
    for b in range(laws.band_first[cell], laws.band_first[cell + 1]):
        row = picked[slot]
        slot += 1
        if row < 0:
            continue
        dx, dy, k, rest = band[b, 0], band[b, 1], band[b, 2], band[b, 3]
        x = band_length(sin, cos, dx, dy, r) - rest - rows[row, 0]
        c0, c1, c2, c3 = rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4]
        energy += band_energy(k, cubic_area(x, c0, c1, c2, c3, rows[row, 5]))
    row = picked[slot]
    if row >= 0:
        x = travel - rows[row, 0]
        c0, c1, c2, c3 = rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4]
        energy += cubic_area(x, c0, c1, c2, c3, rows[row, 5])
    return energy


def pack(cells: Sequence[Cell | Element]) -> Laws:
    """The laws of the cells, inner first, each on its first sheet."""
    return packed(cells)[0]


def packed(cells: Sequence[Cell | Element]) -> tuple[Laws, Sheets]:
    """The laws of the cells, inner first, and where they end, each on its first sheet."""
    bands = [() if isinstance(cell, Element) else cell.bands for cell in cells]
    flat = list(flatten.from_iterable(bands))
    curves = [band.law.pieces() for band in flat]
    reach = _reach(cells)
    loads = [_loads(cell, reach) for cell in cells]
    first = list(accumulate((len(c) for c in curves), initial=0))
    all_rows = [rows for load in loads for rows, *_ in load]
    load_first = list(accumulate((len(rows) for rows in all_rows), initial=first[-1]))
    begin = list(accumulate((len(load) for load in loads), initial=0))
    own = [k for k, load in zip(begin, loads, strict=False) for _ in load]
    told = [tail for load in loads for _, *tail in load]
    table = np.array(
        [
            (*ends, *rows, *(one if one < 0 else one + k for one in leads), k)
            for (ends, leads), rows, k in zip(told, pairwise(load_first), own, strict=True)
        ],
        float,
    )
    now = np.array(begin[:-1])
    sin_limit = np.array([0.0 if isinstance(cell, Element) else cell.sin_limit for cell in cells])
    # No band asks an element for its lever; this one leaves sine and cosine finite.
    lever = np.array([np.inf if isinstance(cell, Element) else cell.lever for cell in cells])
    laws = Laws(
        lever=lever,
        sin_limit=sin_limit,
        full=np.array([cell.full_travel for cell in cells]),
        friction=np.array([cell.friction for cell in cells]),
        band_first=np.array(list(accumulate((len(b) for b in bands), initial=0))),
        band=np.array([(*b.d, b.stiffness, b.rest_length) for b in flat]).reshape(-1, 4),
        two_sided=np.array([int(b.two_sided) for b in flat], dtype=int),
        band_rows=np.array(first),
        load_rows=table[now, ROWS : ROWS_END + 1].astype(int),
        rows=np.concatenate([*curves, *all_rows]),
    )
    # A stop, but for elements that fold back, is where a cell ends and cannot go on.
    sheets = Sheets(table[now[:, None], [LOW, HIGH, LOW, HIGH]], now, table)
    for i, cell in enumerate(cells):
        if isinstance(cell, Element):
            change_sheet(laws, sheets, i, now[i])
    return laws, sheets


# Rows; their ends, and those of the curve itself; where the sheet leads from below and above.
_Sheet = tuple[Floats, tuple[float, float, float, float], tuple[int, int]]


def _loads(cell: Cell | Element, reach: float) -> list[_Sheet]:
    """Every sheet of a cell."""
    if not isinstance(cell, Element):
        rows = np.empty((0, 6)) if cell.load is None else cell.load.pieces()
        full = cell.full_travel
        return [(rows, (0.0, full, 0.0, full), (-1, -1))]
    found: list[_Sheet] = []
    for sheet, rows in zip(cell.laws, cell.reaching(reach), strict=True):
        low, high = float(rows[0, 0]), sheet.end
        if rows[-1, 0] == sheet.end:
            # An open end: straight on, as far as any force of the chain can pull it.
            high += max((reach - rows[-1, 1]) / rows[-1, 2], 1e-3 * cell.full_travel)
        below, above = (-1 if one is None else one for one in (sheet.below, sheet.above))
        found.append((rows, (low, high, sheet.begin, sheet.end), (below, above)))
    return found


def _reach(cells: Iterable[Cell | Element]) -> float:
    """A force above all that the cells of a chain offer [N]; 0 where no curve is open."""
    cells = tuple(cells)
    if all(all(cell.stopped) for cell in cells):
        return 0.0
    return 4.0 * max(cell.largest_force + cell.friction for cell in cells)
