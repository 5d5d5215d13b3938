"""Forces in levers, pins and hooks: of the bands, and of the actuator along a full cycle."""

from typing import NamedTuple

import numpy as np

from stepwell.base import Floats
from stepwell.build import drive
from stepwell.build.layouts import BandPath, Layout
from stepwell.mechanism import Cell
from stepwell.statics import Path

# Lengths at which the tension of a band is computed.
_LENGTHS = 721


class BandRange(NamedTuple):
    """Least and largest length [m] and largest tension [N] of a band over all angles."""

    shortest: float
    longest: float
    tension: float


def band_range(cell: Cell, number: int) -> BandRange:
    """Lengths and tension of a band of a cell over all angles of the cell."""
    band = cell.bands[number]
    ends = band.lengths(cell.lever, cell.limit)
    # Rubber can soften, so that the tension is not always largest at the largest length.
    return BandRange(*ends, float(np.max(band.tension(np.linspace(*ends, _LENGTHS)))))


def hook_loads(layout: Layout) -> dict[tuple[int, str], list[tuple[BandPath, float]]]:
    """Bands on each hook with their largest tensions [N], by block and name of the hole."""
    loads: dict[tuple[int, str], list[tuple[BandPath, float]]] = {}
    for path in layout.bands:
        pull = band_range(layout.cells[path.cell].cell, path.number).tension
        for block, hole in zip((path.cell, path.cell + 1), path.holes, strict=True):
            loads.setdefault((block, hole), []).append((path, pull))
    return loads


def lever_forces(layout: Layout, path: Path) -> Floats:
    """(n, N, 2) force along each lever of each cell [N] at the samples of a path, tension < 0.

    All blocks outside of a cell are one free body: the bands of the cell, the actuator and the two
    levers act on it, and at a stop the stop. Its force acts across the stroke for faces, in the
    middle of their overlap, and along the slot for a slot.
    """
    theta = np.column_stack(
        [one.cell.angle(travel) for one, travel in zip(layout.cells, path.travel.T, strict=True)]
    )
    at = layout.positions(theta)
    force = np.asarray(path.force)
    local = layout.blocks[-1].at(drive.drive_place(layout.cells, layout.build_file), 0.0)
    driven = at[:, -1] + local
    spacing = layout.build_file.lever.spacing
    result = np.empty((len(theta), len(layout.cells), 2))
    for i, plan in enumerate(layout.cells):
        cell, side = plan.cell, plan.side
        joint = at[:, i + 1]
        lever = np.column_stack([np.sin(theta[:, i]), side * np.cos(theta[:, i])])
        total = np.column_stack([force, np.zeros_like(force)])
        moment = _cross(driven - joint, total)
        for one in (band for band in layout.bands if band.cell == i):
            q = joint + one.q
            way = at[:, i] + one.p - q
            length = np.hypot(*way.T)
            pull = cell.bands[one.number].tension(length)[:, None] * way / length[:, None]
            total = total + pull
            moment = moment + _cross(q - joint, pull)
        if plan.slotted:
            along = np.sum(total * lever, axis=1)
        else:
            # In transit nothing is left across the lever, and the faces carry nothing.
            across = lever[:, 0] * total[:, 1] - lever[:, 1] * total[:, 0]
            face = -across / np.where(np.abs(lever[:, 0]) < 1e-9, np.inf, lever[:, 0])
            along = np.sum(total * lever, axis=1) + face * lever[:, 1]
            moment = moment - face * cell.lever * np.sin(theta[:, i]) / 2.0
        difference = 2.0 * moment / (spacing * lever[:, 1])
        result[:, i, 0] = (-along + difference) / 2.0
        result[:, i, 1] = (-along - difference) / 2.0
    return result


def _cross(a: Floats, b: Floats) -> Floats:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
