"""Force, slope, curvature and energy of one cell at one travel, compiled; chains made ready."""

from collections.abc import Sequence
from itertools import accumulate, chain as flatten
from typing import NamedTuple

import numpy as np

from stepwell.base import Floats, Ints
from stepwell.kernels import kernel
from stepwell.mechanism.cell import Cell
from stepwell.mechanism.curves import cubic, cubic_area
from stepwell.mechanism.geometry import (
    band_energy,
    band_length,
    force_slopes,
    length_slopes,
    sine_at,
    travel_of,
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
    load_rows: Ints  # (N, 2) rows of the load of cell i
    rows: Floats  # (M, 6) piecewise cubics, see mechanism/curves.py


@kernel
def summed(values: Floats) -> float:
    """The sum of (N,) numbers from first to last, where NumPy's own order hangs on its version."""
    total = 0.0
    for value in values:
        total += value
    return total


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
    row = first
    while row + 1 < last and laws.rows[row + 1, 0] <= travel:
        row += 1
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


def pack(cells: Sequence[Cell]) -> Laws:
    """The laws of the cells, inner first."""
    bands = [cell.bands for cell in cells]
    flat = list(flatten.from_iterable(bands))
    curves = [band.law.pieces() for band in flat]
    loads = [np.empty((0, 6)) if cell.load is None else cell.load.pieces() for cell in cells]
    first = list(accumulate((len(c) for c in curves), initial=0))
    load_first = list(accumulate((len(load) for load in loads), initial=first[-1]))
    sin_limit = np.array([cell.sin_limit for cell in cells])
    lever = np.array([cell.lever for cell in cells])
    return Laws(
        lever=lever,
        sin_limit=sin_limit,
        full=travel_of(sin_limit, lever, sin_limit),
        friction=np.array([cell.friction for cell in cells]),
        band_first=np.array(list(accumulate((len(b) for b in bands), initial=0))),
        band=np.array([(*b.d, b.stiffness, b.rest_length) for b in flat]),
        two_sided=np.array([int(b.two_sided) for b in flat]),
        band_rows=np.array(first),
        load_rows=np.array([load_first[:-1], load_first[1:]]).T.copy(),
        rows=np.concatenate([*curves, *loads]),
    )
