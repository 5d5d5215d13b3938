"""A chain of two cells in which the band of one is moved about."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepwell.base import require
from stepwell.mechanism import Cell, Chain, SlipError, sizes

Floats = NDArray[np.float64]

# How the odd true case is told.
WAY = "If it is meant so, say unusual=True of a cell of the chain."


def with_q(cell: Cell, x: float, y: float) -> Cell:
    """The cell with its anchors q at (x, y) [m], a place that nobody has typed: it is not asked."""
    return replace(cell, band=tuple(replace(band, q=(x, y)) for band in cell.bands))


def moved(chain: Chain, cell: int, x: float, y: float) -> Chain:
    """The chain with the bands of one cell anchored at q = (x, y) [m] on its outer block."""
    cells = list(chain.cells)
    cells[cell] = with_q(cells[cell], x, y)
    return replace(chain, cells=tuple(cells))


def which(chain: Chain, cell: int | str) -> int:
    """The number of a cell given by number or name; refuses chains that are no pair."""
    if len(chain) != 2:
        raise ValueError(
            f"the chain has {len(chain)} cells: a transition map and its boundaries are drawn for "
            f"two cells. Take two neighbours, Chain(chain.cells[i:i + 2]), or ask margin(chain), "
            f"which works for any number."
        )
    allowed = f"must be 0 or {chain.names[0]!r} (inner), 1 or {chain.names[1]!r} (outer)"
    if isinstance(cell, str):
        if cell not in chain.names:
            raise ValueError(f"cell = {cell!r}: {allowed}.")
        return chain.names.index(cell)
    if cell not in (0, 1):
        raise ValueError(f"cell = {cell!r}: {allowed}.")
    return int(cell)


def axis(name: str, values: ArrayLike, least: int) -> Floats:
    """`values` as rising floats [m]; raises ValueError otherwise."""
    array = np.array(values, float)
    if array.ndim != 1 or len(array) < least or not np.all(np.isfinite(array)):
        raise ValueError(
            f"{name} has shape {array.shape}: must be {least} or more finite numbers in a row "
            f"[m], for example np.linspace(0, 0.020, 200)."
        )
    if np.any(np.diff(array) <= 0):
        raise ValueError(f"{name} must rise from value to value [m]: sort it, drop repeats.")
    return array


def require_places(across: int, up: int, each: int) -> None:
    """Refuse a map of too many places of `each` bytes before memory is asked for."""
    memory = across * up * each / 2**30
    require("points", across * up, f"{across} x {up}, which take {memory:.1f} GiB, are")


def refuse_far(chain: Chain, cell: int, x: Floats, y: Floats) -> None:
    """Raise SlipError for a grid that is far outside the cell whose anchor it shows."""
    lever = chain.cells[cell].lever
    ends = (("x", float(max(x, key=abs))), ("y", float(max(y, key=abs))))
    far = tuple(slip for name, end in ends for slip in sizes.far(name, end, lever))
    if far and not chain.unusual:
        raise SlipError(far, WAY)
