"""Many designs at once, in closed form: their numbers as arrays, and what a block of them does."""

import json
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from stepwell import concave, mechanism
from stepwell.base import Floats, InputError
from stepwell.studies.designs import Block, Subject, changed, unit_in

DRIVES = {"stroke": concave.STROKE, "force": concave.FORCE}
# How many designs of a block closed form tells, and how many not, and why.
COUNTS = {
    "told": concave.TOLD,
    "not_proved": concave.NOT_PROVED,
    "ties": concave.TIES,
    "wakes": concave.WAKES,
}

# Designs that are computed together: their numbers stay in the processor's cache.
_PIECE = 2**14
# Different graphs that a block may hold.
_GRAPHS = 2**17
# Designs of a block that closed form does not tell and the engine may be asked for.
_ASKED = 50
# Values at which a design is compared with what its numbers should be, and by how much of the
# largest it may differ: rounding.
_LOOKS, _SAME = (0.3, 0.7, 1.1), 1e-12


class Packed(NamedTuple):
    """The numbers of a chain as a sum of what varies."""

    base: Floats  # (N, 6) cells as the fields of `Simple`, where all that varies is 0
    slopes: Floats  # (axes, N, 6) by how much each number grows with each value

    def at(self, points: Floats) -> Floats:
        """(m, N, 6) numbers of the designs at points (m, axes).

        Sums are taken one after the other: a product of matrices may round otherwise with another
        number of threads, and a block is to have the same bytes whoever computes it.
        """
        found = np.empty((len(points), self.base.size))
        found[:] = self.base.ravel()
        for values, slope in zip(points.T, self.slopes.reshape(len(self.slopes), -1), strict=True):
            hangs = np.flatnonzero(slope)
            found[:, hangs] += values[:, None] * slope[hangs]
        return found.reshape(len(points), *self.base.shape)


def packed(chain: mechanism.Chain, names: Sequence[str]) -> Packed:
    """The numbers of a chain by what varies, so that those of many designs are a few sums.

    What is found by two values of each name, as `unit_in` takes it, is compared with the chain
    itself at others. The cells have one linear band each, without load or friction.
    A `ValueError` refuses others, too many, or a number on which those of a cell do not hang in
    proportion, such as an angle.
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
    found = Packed(here - np.tensordot(np.array([now for now, _ in steps]), slope, 1), slope)
    for look in _LOOKS:
        point = [now + (look + k) * step for k, (now, step) in enumerate(steps)]
        wanted = _numbers(changed(chain, names, point), ", ".join(names))
        size = np.max(np.abs(wanted), axis=0)
        if np.any(np.abs(found.at(np.array([point]))[0] - wanted) > _SAME * size):
            raise InputError(
                f"{', '.join(names)}: the numbers of a cell must be sums of what varies: vary "
                f"anchors, stiffness, rest length and lever."
            )
    return found


def _value(chain: mechanism.Chain, name: str) -> tuple[float, float]:
    """What a number is, and a step of it that leaves a design possible."""
    from stepwell.design import parameter

    unit_in(chain, name)
    now = float(parameter(chain, name).value(chain))  # type: ignore[arg-type]
    return now, 0.01 * abs(now) if now else 1e-4


def _numbers(chain: Subject, what: str) -> Floats:
    assert isinstance(chain, mechanism.Chain)
    found = [concave.simple(cell) for cell in chain.cells]
    if any(one is None for one in found) or np.isfinite(chain.actuator_stiffness):
        raise InputError(
            f"{what}: closed form needs cells of one linear band, without load or friction, and "
            f"no spring behind the actuator."
        )
    return np.array(found, float)


def block_row(block: Block, numbers: Packed, drive: int) -> dict[str, Any]:
    """What a block of designs does.

    That is how many were told, and how many were not and why; and as JSON the graphs and the
    cycles, each [key, how often, largest gap, the design that has it], and the first not told.
    """
    most = min(block.size, _GRAPHS)
    graphs, cycles = concave.KeyCounts(most), concave.KeyCounts(most)
    counts = np.zeros(4, np.int64)
    asked: list[int] = []
    for first in range(block.first, block.first + block.size, _PIECE):
        last = min(first + _PIECE, block.first + block.size)
        key, cycle, gap, told = concave.classed(numbers.at(block.space.points(first, last)), drive)
        graphs.add(key, gap[:, 0], first)
        cycles.add(cycle, gap[:, 1], first)
        counts += np.bincount(told, minlength=4)
        if len(asked) < _ASKED:
            asked += (first + np.flatnonzero(told != concave.TOLD)[: _ASKED - len(asked)]).tolist()
    lists = {"graphs": graphs.rows, "cycles": cycles.rows, "asked": asked}
    told = {name: int(counts[code]) for name, code in COUNTS.items()}
    return told | {name: json.dumps(rows) for name, rows in lists.items()}
