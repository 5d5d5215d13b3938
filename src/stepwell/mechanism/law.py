"""Force, slope, curvature and energy of one cell at one travel, compiled; chains made ready."""

from collections.abc import Iterable, Sequence
from itertools import accumulate, chain as flatten
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel
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
    """The cells of a chain as flat arrays; N cells, B bands, M curve rows, T sheets.

    A cell has one sheet, but for elements whose curve folds back. `sheet`, `low`, `high` and
    `load_rows` are those on which it stands now: the follower writes them as cells jump.
    """

    lever: Floats  # (N,)
    sin_limit: Floats  # (N,)
    full: Floats  # (N,) full travel S
    friction: Floats  # (N,)
    band_first: Ints  # (N + 1,) bands of cell i are band_first[i] .. band_first[i + 1]
    band: Floats  # (B, 4) d_x, d_y, k, ℓ0
    two_sided: Ints  # (B,)
    band_rows: Ints  # (B + 1,) rows of band b
    load_rows: Ints  # (N, 2) rows of the load of cell i, or of the element's sheet
    rows: Floats  # (M, 6) piecewise cubics, see mechanism/cubics
    sheet: Ints  # (N,)
    low: Floats  # (N,) travels between which cell i can go
    high: Floats  # (N,)
    sheet_first: Ints  # (N + 1,) sheets of cell i are sheet_first[i] .. sheet_first[i + 1]
    sheet_ends: Floats  # (T, 2) low, high
    sheet_curve: Floats  # (T, 2) the same without what open ends go on beyond the curve
    sheet_rows: Ints  # (T, 2)
    sheet_next: Ints  # (T, 2) where it jumps to from below and above, by number in its cell; or -1


@kernel
def summed(values: Floats) -> float:
    """The sum of (N,) numbers from first to last, where NumPy's own order hangs on its version."""
    total = 0.0
    for value in values:
        total += value
    return total


@kernel
def change_sheet(laws: Laws, cell: int, sheet: int) -> None:
    """Let a cell stand on another sheet of its curve."""
    at = laws.sheet_first[cell] + sheet
    laws.sheet[cell] = sheet
    laws.low[cell], laws.high[cell] = laws.sheet_ends[at, 0], laws.sheet_ends[at, 1]
    laws.load_rows[cell, 0], laws.load_rows[cell, 1] = (
        laws.sheet_rows[at, 0],
        laws.sheet_rows[at, 1],
    )


@kernel
def ends_of(laws: Laws) -> tuple[float, float]:
    """Least and largest Σ s that the cells have, with open ends as far as they go on."""
    low, high = 0.0, 0.0
    for i in range(len(laws.full)):
        first, last = laws.sheet_first[i], laws.sheet_first[i + 1]
        low += np.min(laws.sheet_ends[first:last, 0])
        high += np.max(laws.sheet_ends[first:last, 1])
    return low, high


@kernel
def can_fall(laws: Laws, cell: int, travel: float) -> bool:
    """Whether a cell has somewhere to go from there with less travel: no stop is below it."""
    at = laws.sheet_first[cell] + laws.sheet[cell]
    return travel > laws.low[cell] or laws.sheet_next[at, 0] >= 0


@kernel
def can_rise(laws: Laws, cell: int, travel: float) -> bool:
    """Whether a cell has somewhere to go from there with more travel: no stop is above it."""
    at = laws.sheet_first[cell] + laws.sheet[cell]
    return travel < laws.high[cell] or laws.sheet_next[at, 1] >= 0


@kernel
def beyond(laws: Laws, cell: int, travel: float) -> int:
    """The sheet that a cell jumps to where it stands; -1 where it does not."""
    at = laws.sheet_first[cell] + laws.sheet[cell]
    if travel <= laws.low[cell]:
        return laws.sheet_next[at, 0]
    return laws.sheet_next[at, 1] if travel >= laws.high[cell] else -1


@kernel
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


@kernel
def law(laws: Laws, cell: int, picked: Ints, travel: float) -> tuple[float, float, float]:
    """F [N], κ = dF/ds [N/m] and dκ/ds [N/m²] of a cell whose bands are on `picked` rows."""
    # Taken out once, here: compiled, every later look into the record would count references.
    lever, sin_limit, band_first = laws.lever, laws.sin_limit, laws.band_first
    band, rows = laws.band, laws.rows
    r = lever[cell]
    sin = sine_at(travel, r, sin_limit[cell])
    cos = np.sqrt(1.0 - sin * sin)
    force, slope, bend = 0.0, 0.0, 0.0
    slot = 0
    for b in range(band_first[cell], band_first[cell + 1]):
        row = picked[slot]
        slot += 1
        if row < 0:
            continue
        dx, dy, k, rest = band[b, 0], band[b, 1], band[b, 2], band[b, 3]
        length = band_length(sin, cos, dx, dy, r)
        l1, l2, l3 = length_slopes(sin, cos, length, dx, dy, r)
        x = length - rest - rows[row, 0]
        t0, t1, t2 = cubic(x, rows[row, 1], rows[row, 2], rows[row, 3], rows[row, 4])
        f0, f1, f2 = force_slopes(k * t0, k * t1, k * t2, l1, l2, l3)
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


@kernel
def stored(laws: Laws, cell: int, picked: Ints, travel: float) -> float:
    """Energy [J] of a cell whose bands are on `picked` rows; the load counts from travel 0."""
    # Taken out once, here: compiled, every later look into the record would count references.
    lever, sin_limit, band_first = laws.lever, laws.sin_limit, laws.band_first
    band, rows = laws.band, laws.rows
    r = lever[cell]
    sin = sine_at(travel, r, sin_limit[cell])
    cos = np.sqrt(1.0 - sin * sin)
    energy = 0.0
    slot = 0
    for b in range(band_first[cell], band_first[cell + 1]):
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
    bands = [() if isinstance(cell, Element) else cell.bands for cell in cells]
    flat = list(flatten.from_iterable(bands))
    curves = [band.law.pieces() for band in flat]
    reach = _reach(cells)
    loads = [_loads(cell, reach) for cell in cells]
    all_loads = [rows for load in loads for rows, *_ in load]
    first = list(accumulate((len(c) for c in curves), initial=0))
    load_first = list(accumulate((len(rows) for rows in all_loads), initial=first[-1]))
    sheet_first = np.array(list(accumulate((len(load) for load in loads), initial=0)))
    sheet_rows = np.array([load_first[:-1], load_first[1:]]).T.copy()
    sin_limit = np.array([0.0 if isinstance(cell, Element) else cell.sin_limit for cell in cells])
    # No band asks an element for its lever; this one leaves sine and cosine finite.
    lever = np.array([np.inf if isinstance(cell, Element) else cell.lever for cell in cells])
    ends = np.array([end for load in loads for _, end, *_ in load])
    begin = sheet_first[:-1]
    return Laws(
        lever=lever,
        sin_limit=sin_limit,
        full=np.array([cell.full_travel for cell in cells]),
        friction=np.array([cell.friction for cell in cells]),
        band_first=np.array(list(accumulate((len(b) for b in bands), initial=0))),
        band=np.array([(*b.d, b.stiffness, b.rest_length) for b in flat]).reshape(-1, 4),
        two_sided=np.array([int(b.two_sided) for b in flat], dtype=int),
        band_rows=np.array(first),
        load_rows=sheet_rows[begin],
        rows=np.concatenate([*curves, *all_loads]),
        sheet=np.zeros(len(cells), dtype=int),
        low=ends[begin, 0],
        high=ends[begin, 1],
        sheet_first=sheet_first,
        sheet_ends=ends,
        sheet_curve=np.array([curve for load in loads for _, _, curve, _ in load]),
        sheet_rows=sheet_rows,
        sheet_next=np.array([leads for load in loads for *_, leads in load]),
    )


_Sheet = tuple[Floats, tuple[float, float], tuple[float, float], tuple[int, int]]


def _loads(cell: Cell | Element, reach: float) -> list[_Sheet]:
    """Rows, ends, ends of the curve itself and what they lead to, of every sheet of a cell."""
    if not isinstance(cell, Element):
        rows = np.empty((0, 6)) if cell.load is None else cell.load.pieces()
        ends = 0.0, cell.full_travel
        return [(rows, ends, ends, (-1, -1))]
    found: list[_Sheet] = []
    for sheet, rows in zip(cell.laws, cell.reaching(reach), strict=True):
        low, high = float(rows[0, 0]), sheet.end
        if rows[-1, 0] == sheet.end:
            # An open end: straight on, as far as any force of the chain can pull it.
            high += max((reach - rows[-1, 1]) / rows[-1, 2], 1e-3 * cell.full_travel)
        leads = (-1 if one is None else one for one in (sheet.below, sheet.above))
        curve = sheet.begin, sheet.end
        found.append((rows, (low, high), curve, (next(leads), next(leads))))
    return found


def _reach(cells: Iterable[Cell | Element]) -> float:
    """A force above all that the cells of a chain offer [N]; 0 where no curve is open."""
    cells = tuple(cells)
    if all(all(cell.stopped) for cell in cells):
        return 0.0
    return 4.0 * max(cell.largest_force + cell.friction for cell in cells)
