"""Many designs in closed form: their parameters as arrays, and the results of a block."""

import json
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from stepwell import concave, mechanism
from stepwell.base import Floats, InputError
from stepwell.studies.designs import Block, Subject, changed, unit_in

DRIVES = {"stroke": concave.STROKE, "force": concave.FORCE}
# Columns with the numbers of designs by result of the closed form. Stores keep the names, so they
# cannot change: this one is the number of designs evaluated in closed form.
CLOSED_FORM = "told"
COUNTS = {
    CLOSED_FORM: concave.DECIDED,
    "not_proved": concave.NOT_PROVED,
    "ties": concave.TIES,
    "wakes": concave.WAKES,
}

# Designs computed together: their parameters fit into the processor's cache.
_PIECE = 2**14
# Largest number of different graphs in a block.
_GRAPHS = 2**17
# Largest number of designs without a closed form that a block lists for the engine.
_ASKED = 50
# Points at which the linear formulas are compared with the design, and the allowed relative
# difference (rounding).
_LOOKS, _SAME = (0.3, 0.7, 1.1), 1e-12


class Packed(NamedTuple):
    """The parameters of a chain's cells as linear functions of the varied parameters."""

    base: Floats  # (N, 6) cells as the fields of `Simple`, with all varied parameters 0
    slopes: Floats  # (axes, N, 6) derivatives by the varied parameters

    def at(self, points: Floats) -> Floats:
        """(m, N, 6) parameters of the cells of the designs at points (m, axes).

        Terms are added one after another, because the rounding of a matrix product may depend on
        the number of threads, and a block must be bit-identical on all machines.
        """
        numbers = np.empty((len(points), self.base.size))
        numbers[:] = self.base.ravel()
        for values, slope in zip(points.T, self.slopes.reshape(len(self.slopes), -1), strict=True):
            hangs = np.flatnonzero(slope)
            numbers[:, hangs] += values[:, None] * slope[hangs]
        return numbers.reshape(len(points), *self.base.shape)


def packed(chain: mechanism.Chain, names: Sequence[str]) -> Packed:
    """Linear functions for the parameters of a chain's cells, fast for many designs.

    They are derived from two values of each name (see `unit_in`) and compared with the chain at
    other values. The cells have one linear band each, without load or friction. A `ValueError` is
    raised for other cells, too many cells, or a nonlinear parameter, such as an angle.
    """
    if len(chain) > concave.MOST_CELLS:
        raise InputError(f"{len(chain)} cells: must be at most {concave.MOST_CELLS}.")
    here = _numbers(chain, "the design")
    steps = [_value(chain, name) for name in names]
    slopes = [
        (_numbers(changed(chain, [name], [now + step]), name) - here) / step
        for name, (now, step) in zip(names, steps, strict=True)
    ]
    slope = np.array(slopes).reshape(len(names), *here.shape)
    result = Packed(here - np.tensordot(np.array([now for now, _ in steps]), slope, 1), slope)
    for look in _LOOKS:
        point = [now + (look + k) * step for k, (now, step) in enumerate(steps)]
        wanted = _numbers(changed(chain, names, point), ", ".join(names))
        size = np.max(np.abs(wanted), axis=0)
        if np.any(np.abs(result.at(np.array([point]))[0] - wanted) > _SAME * size):
            raise InputError(
                f"{', '.join(names)}: the closed form needs a linear dependence: vary anchors, "
                f"stiffness, rest length and lever."
            )
    return result


def _value(chain: mechanism.Chain, name: str) -> tuple[float, float]:
    """Value of a parameter, and a small step of it that leaves the design possible."""
    from stepwell.design import parameter

    unit_in(chain, name)
    now = float(parameter(chain, name).value(chain))  # type: ignore[arg-type]
    return now, 0.01 * abs(now) if now else 1e-4


def _numbers(chain: Subject, what: str) -> Floats:
    assert isinstance(chain, mechanism.Chain)
    cells = [concave.simple(cell) for cell in chain.cells]
    if any(one is None for one in cells) or np.isfinite(chain.actuator_stiffness):
        raise InputError(
            f"{what}: closed form needs cells of one linear band, without load or friction, and "
            f"no spring behind the actuator."
        )
    return np.array(cells, float)


def block_row(block: Block, numbers: Packed, drive: int) -> dict[str, Any]:
    """Row of a block of designs: counts, graphs and cycles.

    Counts are the designs in closed form, and the others by reason. Graphs and cycles are JSON
    lists of [key, count, largest gap, design with that gap]; `asked` lists the first designs
    without a closed form.
    """
    most = min(block.size, _GRAPHS)
    graphs, cycles = concave.KeyCounts(most), concave.KeyCounts(most)
    counts = np.zeros(4, np.int64)
    asked: list[int] = []
    for first in range(block.first, block.first + block.size, _PIECE):
        last = min(first + _PIECE, block.first + block.size)
        key, cycle, gap, verdict = concave.classed(
            numbers.at(block.space.points(first, last)), drive
        )
        graphs.add(key, gap[:, 0], first)
        cycles.add(cycle, gap[:, 1], first)
        counts += np.bincount(verdict, minlength=4)
        if len(asked) < _ASKED:
            asked += (
                first + np.flatnonzero(verdict != concave.DECIDED)[: _ASKED - len(asked)]
            ).tolist()
    lists = {"graphs": graphs.rows, "cycles": cycles.rows, "asked": asked}
    verdict = {name: int(counts[code]) for name, code in COUNTS.items()}
    return verdict | {name: json.dumps(rows) for name, rows in lists.items()}
