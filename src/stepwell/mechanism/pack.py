"""A chain as the flat arrays that the kernels read."""

from collections.abc import Sequence
from itertools import accumulate, chain as flatten

import numpy as np

from stepwell.mechanism.cell import Cell
from stepwell.mechanism.geometry import travel_of
from stepwell.mechanism.law import Laws


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
