"""Features of a path for figures: smooth pieces, snaps, and states at rest."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stepwell.base import Floats
from stepwell.mechanism import Cell, Element
from stepwell.sequences import Cycle, Program
from stepwell.statics import Path

# A cell is at a stop or in a phase within this fraction of its full travel.
_SLIP = 1e-7


class Vertex(NamedTuple):
    """A sample where every cell is in a phase; the phases of a lever cell are its stops."""

    sample: int
    state: str
    direction: int


class SnapSamples(NamedTuple):
    """The samples before and after a snap, and the cells that moved in it."""

    before: int
    after: int
    direction: int
    cells: tuple[int, ...]


def path_of(result: Cycle | Path | Program) -> Path:
    """The path of a cycle or of a program, or the path itself."""
    return result if isinstance(result, Path) else result.path


def snaps_of(path: Path) -> list[SnapSamples]:
    """Every snap of the path as the samples on either side of it."""
    full = np.array(path.chain.full_travels)
    snaps: list[SnapSamples] = []
    for i in np.flatnonzero(path.snap_after[:-1]):
        moved = np.abs(path.travel[i + 1] - path.travel[i]) > 1e-9 * full
        # Where a curve folds back, a cell snaps at constant travel.
        moved |= path.sheet[i + 1] != path.sheet[i]
        cells = tuple(int(c) for c in np.flatnonzero(moved))
        snaps.append(SnapSamples(int(i), int(i) + 1, int(path.direction[i]), cells))
    return snaps


def pieces(path: Path) -> list[tuple[int, NDArray[np.intp]]]:
    """(direction, sample indices) of every stretch between snaps and turning points."""
    direction = np.asarray(path.direction)
    inside = np.flatnonzero(path.snap_after[:-1] | (np.diff(direction) != 0)) + 1
    stretches: list[tuple[int, NDArray[np.intp]]] = []
    for first, end in pairwise([0, *inside.tolist(), len(direction)]):
        # A turning point belongs to both of its stretches.
        begin = first - 1 if first > 0 and not path.snap_after[first - 1] else first
        if end - begin > 1:
            stretches.append((int(direction[end - 1]), np.arange(begin, end)))
    return stretches


def curve(path: Path, direction: int, *columns: Floats) -> tuple[Floats, ...]:
    """Each of the (n,) columns along all pieces of one direction, NaN between pieces."""
    parts = [at for way, at in pieces(path) if (way > 0) == (direction > 0)]
    gap = np.array([np.nan])
    return tuple(
        np.concatenate([piece for at in parts for piece in (column[at], gap)] or [gap])
        for column in columns
    )


def legs(path: Path) -> list[tuple[int, NDArray[np.intp]]]:
    """(direction, sample indices) of the pieces, also cut where every cell rests at a stop. Pieces
    with a constant stroke are left out.
    """
    slip = _SLIP * np.array(path.chain.full_travels)
    stops = [np.where(c.stopped, (c.low, c.high), (-np.inf, np.inf)) for c in path.chain.cells]
    low, high = np.array(stops).T
    resting = np.all((path.travel <= low + slip) | (path.travel >= high - slip), axis=1)
    parts = (
        (direction, at[first : last + 1])
        for direction, at in pieces(path)
        for first, last in pairwise([0, *np.flatnonzero(resting[at[1:-1]]) + 1, len(at) - 1])
    )
    return [(direction, part) for direction, part in parts if np.ptp(path.stroke[part]) > 0]


def vertices(path: Path) -> list[Vertex]:
    """Samples where every cell is in a phase, one per visit. The sample is the first of the visit
    if all cells rest, and half-way if they move.
    """
    columns = zip(path.chain.cells, path.travel.T, path.sheet.T, strict=True)
    digits = np.column_stack([phases(*column) for column in columns])
    inside = np.all(digits >= 0, axis=1)
    changes = np.any(np.diff(digits, axis=0) != 0, axis=1) | path.snap_after[:-1]
    cuts = [0, *(np.flatnonzero(changes) + 1).tolist(), len(digits)]
    resting: list[Vertex] = []
    for first, end in pairwise(cuts):
        if inside[first]:
            way = travelled(path.stroke[first:end])
            moves = way[-1] > _SLIP * path.chain.full_stroke
            at = first + (int(np.argmin(np.abs(way - way[-1] / 2))) if moves else 0)
            state = "".join(map(str, digits[first]))
            resting.append(Vertex(at, state, int(path.direction[at])))
    return resting


def travelled(values: Floats) -> Floats:
    """(n,) path length up to each of these values."""
    return np.cumsum(np.abs(np.diff(values, prepend=values[0])))


def span(path: Path, cell: int) -> tuple[float, float]:
    """Least and largest travel of a cell [m]: the ends of its curve, or of the path beyond."""
    one, travel = path.chain.cells[cell], path.travel[:, cell]
    slip = _SLIP * one.full_travel
    low, high = float(np.min(travel)), float(np.max(travel))
    return (low if low < one.low - slip else one.low, high if high > one.high + slip else one.high)


def phases(
    cell: Cell | Element, travel: ArrayLike, sheet: ArrayLike, near: float = _SLIP
) -> NDArray[np.intp]:
    """Phase of a cell at travels [m] on sheets, both of one shape; -1 in transit. `near` is the
    tolerance, as a fraction of the full travel.
    """
    travel, sheet, slip = np.asarray(travel), np.asarray(sheet), near * cell.full_travel
    digits = np.full(travel.shape, -1)
    for digit, phase in enumerate(cell.phases):
        here = (travel >= phase.low - slip) & (travel <= phase.high + slip)
        digits[here & (sheet == phase.sheet)] = digit
    return digits
