"""Places of the hooks: the anchors of all bands on the plates, and the levels of the bands."""

import math
from collections.abc import Iterable, Iterator
from functools import cache
from typing import NamedTuple

import numpy as np

from stepwell.base import Vec2
from stepwell.build.build_file import BuildFile
from stepwell.mechanism import Band, Cell

# Places equal within this distance are one [m].
SAME = 1e-9
# Largest shift of both anchors of a band, and its step, in pitches of the grid.
_FARTHEST, _PARTS = 6, 5
# Shifts of a band that are tried for an order of the bands: the shortest, and of all others.
_NEAREST, _MOST_TRIED = 20, 80
# Angles at which bands are compared with hooks for their levels; the sweep proves the result.
_ANGLES = 91


class HookedBand(NamedTuple):
    """A band of a cell on its two blocks.

    Anchors (x, y) [m] of a seat: x along the stroke from the midpoint of its joints, y across, away
    from the other block. `shift` is the vector [m] added to p and q in the frame of the cell, which
    leaves d and so the motion as they are. `level` counts from 0, the lowest. `fits` is False if no
    shift puts both anchors on the plates, clear of pins.
    """

    number: int
    inner: Vec2
    outer: Vec2
    shift: Vec2
    level: int
    fits: bool = True


class Seat(NamedTuple):
    """The room for hooks at a pair of joints: joints, the front edge, hole sizes [m]."""

    joints: tuple[Vec2, Vec2]
    front: float
    hook: float  # diameters
    cap: float
    pin: float
    bridge: float

    def allows(self, at: Vec2) -> bool:
        """Whether a hook can stand there: on the plate, and off the pins or exactly on one."""
        x, y = at
        if y < self.front + self.hook / 2 + self.bridge - SAME:
            return False
        apart = (self.hook + self.pin) / 2 + self.bridge - SAME
        gaps = [math.hypot(x - a, y - b) for a, b in self.joints]
        return all(gap < SAME or gap >= apart for gap in gaps)


def seat(build_file: BuildFile, front: float) -> Seat:
    """The seat of a pair of joints whose plates end `front` [m] before the joints."""
    half = build_file.lever.spacing / 2
    fit = build_file.pin.plate_fit
    return Seat(
        ((-half, 0.0), (half, 0.0)),
        -front,
        build_file.hook.diameter + fit,
        build_file.hook.cap_width,
        build_file.pin.diameter + fit,
        build_file.sheet.bridge,
    )


def inner_place(band: Band, shift: Vec2 = (0.0, 0.0)) -> Vec2:
    """Anchor p on its seat: the inner block lies in the direction of -x of the cell."""
    return band.p[1] + shift[1], -(band.p[0] + shift[0])


def outer_place(band: Band, shift: Vec2 = (0.0, 0.0)) -> Vec2:
    """Anchor q on its seat."""
    return band.q[1] + shift[1], band.q[0] + shift[0]


@cache
def _shifts(pitch: float) -> tuple[Vec2, ...]:
    """Shifts in the order of trial: none, then whole pitches by length, then parts of a pitch."""
    whole = range(-_FARTHEST, _FARTHEST + 1)
    parts = range(-_FARTHEST * _PARTS, _FARTHEST * _PARTS + 1)
    coarse = sorted((i * i + j * j, i, j) for i in whole for j in whole)
    fine = sorted((i * i + j * j, i, j) for i in parts for j in parts if i % _PARTS or j % _PARTS)
    steps = [(i * pitch, j * pitch) for _, i, j in coarse]
    small = [(i * pitch / _PARTS, j * pitch / _PARTS) for _, i, j in fine]
    return (*steps, *small)


def on_grid(at: Vec2, pitch: float) -> bool:
    """Whether a place is on the grid through the midpoint of the joints."""
    return all(abs(one / pitch - round(one / pitch)) * pitch < SAME for one in at)


def place_bands(cell: Cell, build_file: BuildFile, seats: tuple[Seat, Seat]) -> list[HookedBand]:
    """Hooks of all bands of a cell, anchors shifted where their places are taken.

    A band that has no allowed place keeps its anchors; `limits` reports it.
    """
    pitch = build_file.grid.pitch
    taken: tuple[list[Vec2], list[Vec2]] = ([], [])
    placed: list[HookedBand] = []
    for number, band in enumerate(cell.bands):
        free = list(_free_shifts(band, seats, taken, pitch))
        every = max(1, len(free) // _MOST_TRIED)
        tried = [*free[:_NEAREST], *free[_NEAREST::every]]
        ways = [_hooked(number, band, shift) for shift in tried]
        # Where hooks stand in each other's way, another shift lets the bands lie one above another.
        one = next((way for way in ways if _stackable([*placed, way], cell, build_file)), None)
        one = one or (ways[0] if ways else _hooked(number, band, (0.0, 0.0))._replace(fits=False))
        taken[0].append(one.inner)
        taken[1].append(one.outer)
        placed.append(one)
    order = list(_sorted_upwards(_below(cell, placed, build_file)))
    return [one._replace(level=order.index(one.number)) for one in placed]


def _hooked(number: int, band: Band, shift: Vec2) -> HookedBand:
    return HookedBand(number, inner_place(band, shift), outer_place(band, shift), shift, 0)


def _free_shifts(
    band: Band, seats: tuple[Seat, Seat], taken: tuple[list[Vec2], list[Vec2]], pitch: float
) -> Iterator[Vec2]:
    """Shifts with both hooks on the plates, clear of pins and other hooks, in order of trial."""
    apart = max(seats[0].hook + seats[0].bridge, seats[0].cap) - SAME

    def free(at: Vec2, side: int) -> bool:
        gaps = (math.dist(at, other) for other in taken[side])
        return seats[side].allows(at) and all(gap < SAME or gap >= apart for gap in gaps)

    gridded = on_grid(inner_place(band), pitch) and on_grid(outer_place(band), pitch)
    shifts = _shifts(pitch)
    # Anchors off the grid gain nothing from whole pitches: the shortest shift is tried first.
    ordered: Iterable[Vec2] = shifts if gridded else sorted(shifts, key=lambda v: math.hypot(*v))
    # At last the shift that puts both hooks equally far from the faces.
    even = -(band.p[0] + band.q[0]) / 2.0
    ordered = [*ordered, *((even, along) for across, along in shifts if across == 0.0)]
    yield from (
        v for v in ordered if free(inner_place(band, v), 0) and free(outer_place(band, v), 1)
    )


def _stackable(placed: list[HookedBand], cell: Cell, build_file: BuildFile) -> bool:
    """Whether an order of bands exists in which each passes over the hooks in its way."""
    below = _below(cell, placed, build_file)
    order = list(_sorted_upwards(below))
    return all(order.index(other) < order.index(n) for n in below for other in below[n])


def _below(cell: Cell, placed: list[HookedBand], build_file: BuildFile) -> dict[int, set[int]]:
    """For each band the bands that have a hook in its way, and so have to lie below it."""
    below: dict[int, set[int]] = {one.number: set() for one in placed}
    width = build_file.hook.diameter + 2.0 * build_file.band.thickness
    near = (width + build_file.hook.diameter) / 2
    theta = np.linspace(-cell.limit, cell.limit, _ANGLES)
    # The outer seat's midpoint from that of the inner one; y of the inner seat points away.
    along, across = cell.lever * np.sin(theta), -cell.lever * np.cos(theta)
    for band in placed:
        for other in placed:
            if other is band:
                continue
            if any(gap < near for gap in _gaps(band, other, along, across)):
                below[band.number].add(other.number)
    return below


def _gaps(
    band: HookedBand, other: HookedBand, along: np.ndarray, across: np.ndarray
) -> Iterator[float]:
    """Least distances [m] of a band to those hooks of another band that are not its own."""
    p = np.array(band.inner)
    q = np.column_stack([along + band.outer[0], across - band.outer[1]])
    if math.dist(band.inner, other.inner) >= SAME:
        yield _least(p, q, np.array(other.inner))
    if math.dist(band.outer, other.outer) >= SAME:
        yield _least(p, q, np.column_stack([along + other.outer[0], across - other.outer[1]]))


def _least(p: np.ndarray, q: np.ndarray, at: np.ndarray) -> float:
    """Least distance of the point `at` to the segment from p to q, over all rows."""
    way = q - p
    share = np.clip(((at - p) * way).sum(1) / (way * way).sum(1), 0.0, 1.0)
    return float(np.hypot(*(p + share[:, None] * way - at).T).min())


def _sorted_upwards(below: dict[int, set[int]]) -> Iterator[int]:
    """Bands from the lowest level; if each passes a hook of the other, the smaller number first."""
    left = dict(below)
    while left:
        lowest = next((n for n, others in left.items() if not others & left.keys()), min(left))
        del left[lowest]
        yield lowest
