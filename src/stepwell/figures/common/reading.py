"""What a figure has to find in a path: its smooth pieces, its snaps, the states it rests in."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepwell.base import InputError
from stepwell.mechanism import Chain
from stepwell.statics import Path

if TYPE_CHECKING:
    from stepwell.sequences import Cycle, Program


class Vertex(NamedTuple):
    """A sample where every cell rests at a stop."""

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
    found: list[SnapSamples] = []
    for i in np.flatnonzero(path.snap_after[:-1]):
        moved = np.abs(path.travel[i + 1] - path.travel[i]) > 1e-9 * full
        cells = tuple(int(c) for c in np.flatnonzero(moved))
        found.append(SnapSamples(int(i), int(i) + 1, int(path.direction[i]), cells))
    return found


def pieces(path: Path) -> list[tuple[int, NDArray[np.intp]]]:
    """(direction, sample indices) of every stretch between snaps and turning points."""
    direction = np.asarray(path.direction)
    after_snap = np.flatnonzero(path.snap_after[:-1]) + 1
    after_turn = np.flatnonzero(np.diff(direction)) + 1
    cuts = np.unique(np.concatenate([[0], after_snap, after_turn, [len(direction)]]))
    found: list[tuple[int, NDArray[np.intp]]] = []
    for first, end in pairwise(int(c) for c in cuts):
        # A turning point belongs to both of its stretches.
        begin = first - 1 if first > 0 and not path.snap_after[first - 1] else first
        if end - begin > 1:
            found.append((int(direction[end - 1]), np.arange(begin, end)))
    return found


def curve(
    path: Path, direction: int, *columns: NDArray[np.float64]
) -> tuple[NDArray[np.float64], ...]:
    """Each of the (n,) columns along all pieces of one direction, NaN between pieces."""
    parts = [at for way, at in pieces(path) if (way > 0) == (direction > 0)]
    gap = np.array([np.nan])
    return tuple(
        np.concatenate([piece for at in parts for piece in (column[at], gap)] or [gap])
        for column in columns
    )


def legs(path: Path) -> list[tuple[int, NDArray[np.intp]]]:
    """(direction, sample indices) of the pieces, cut again at every vertex.

    What only the force does while all cells rest is left out.
    """
    at_stops = np.all(np.any(_resting(path), axis=0), axis=1)
    found: list[tuple[int, NDArray[np.intp]]] = []
    for direction, at in pieces(path):
        inside = np.flatnonzero(at_stops[at[1:-1]]) + 1
        cuts = [0, *inside, len(at) - 1]
        for first, last in pairwise(int(c) for c in cuts):
            part = at[first : last + 1]
            if np.ptp(path.stroke[part]) > 0:
                found.append((direction, part))
    return found


def vertices(path: Path) -> list[Vertex]:
    """Where every cell rests at a stop, once for each visit."""
    resting = _resting(path)
    found: list[Vertex] = []
    previous = -2
    for i in np.flatnonzero(np.all(np.any(resting, axis=0), axis=1)):
        state = "".join("1" if one else "0" for one in resting[1, i])
        if not (i == previous + 1 and found and found[-1].state == state):
            found.append(Vertex(int(i), state, int(path.direction[i])))
        previous = i
    return found


def _resting(path: Path) -> NDArray[np.bool_]:
    """(2, n, N) whether a cell is at its stop 0, at its stop 1."""
    full = np.array(path.chain.full_travels)
    return np.stack([path.travel <= 1e-7 * full, path.travel >= (1 - 1e-7) * full])


def require_two_cells(chain: Chain, what: str) -> None:
    """Refuse a chain that a picture in two travels cannot show."""
    if len(chain) != 2:
        raise InputError(
            f"the chain has {len(chain)} cells: {what} shows exactly 2; "
            f"use force_stroke or travel_stroke."
        )
