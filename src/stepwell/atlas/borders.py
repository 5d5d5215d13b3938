"""Which machine begins where another one ends: its neighbours in the space, number by number."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stepwell.atlas.atlas import Atlas
from stepwell.atlas.canonical import canonical, name_of
from stepwell.base import Floats, InputError, Ints
from stepwell.concave import TOLD, classed, closed_graph
from stepwell.studies import DRIVES, Blocks, Study, packed

# Designs on every way, and how often the piece with the border is halved: to 3·10⁻⁵ of the way.
# Nearer to a border the engine would see a tie.
_STEPS, _HALVES = 32, 10


class Border(NamedTuple):
    """Where a machine becomes another one as one number of its most robust design is changed.

    Attributes:
        machine: its name.
        parameter: the number, all others staying.
        value: where it is another one already, just past the border, in SI; to some micrometres
            where a snap lands by a flow of several cells.
        step: from the design to there, in SI; its sign says which way.
        beyond: name of the machine that begins there, one of the atlas or not.
    """

    machine: str
    parameter: str
    value: float
    step: float
    beyond: str


def borders(study: Study, found: Atlas) -> tuple[Border, ...]:
    """The neighbours of every machine of an atlas: what one small change makes of it.

    From its most robust design every number that varies is changed by itself, down and up to the
    ends of the space, until closed form tells another graph. A machine that takes up less than a
    thirty-second of such a way may be passed over. Where closed form does not tell what lies at a
    border, nothing is said.

    Args:
        study: the store of the atlas.
        found: what `charted` made of it.

    Returns:
        Of every machine in the order of the atlas, the numbers in the order of the space, down
        before up.

    Raises:
        ValueError: the study is that of no atlas.
    """
    designs = study.designs
    if not isinstance(designs, Blocks):
        raise InputError(f"{study.folder}: holds no atlas, but {study!r}.")
    drive = DRIVES[found.drive]
    numbers = packed(found.chain, [axis.name for axis in found.axes])
    starts = np.array([designs.space.points(m.design, m.design + 1)[0] for m in found.machines])
    # A way for every machine, number and end of the space.
    machines, axes, ends = (
        each.ravel()
        for each in np.indices((len(found.machines), len(found.axes), 2), dtype=np.int64)
    )
    reach = np.array([(axis.low, axis.high) for axis in found.axes])
    far = reach[axes, ends] - starts[machines, axes]

    def graphs(ways: Ints, shares: Floats) -> tuple[Ints, np.ndarray]:
        """The key of the graph at a share of each of these ways, and whether it is told."""
        points = starts[machines[ways]]
        points[np.arange(len(ways)), axes[ways]] += shares * far[ways]
        key, _, _, told = classed(numbers.at(points), drive)
        return key, told == TOLD

    own, _, _, _ = classed(numbers.at(starts), drive)
    all_ways, shares = np.arange(len(far)), np.arange(1, _STEPS + 1) / _STEPS
    key, told = graphs(np.repeat(all_ways, _STEPS), np.tile(shares, len(far)))
    key, told = (one.reshape(len(far), _STEPS) for one in (key, told))
    other = (key != own[machines][:, None]) | ~told
    first = np.argmax(other, axis=1)
    # Behind what is not told may be anything.
    ways = np.flatnonzero(other.any(axis=1) & told[all_ways, first] & (far != 0.0))
    high = shares[first[ways]]
    low = high - 1.0 / _STEPS
    for _ in range(_HALVES):
        half = 0.5 * (low + high)
        key, told = graphs(ways, half)
        ways, key = ways[told], key[told]
        low, high, half = low[told], high[told], half[told]
        same = key == own[machines[ways]]
        low, high = np.where(same, half, low), np.where(same, high, half)
    past = starts[machines[ways]]
    past[np.arange(len(ways)), axes[ways]] += high * far[ways]
    key, _ = graphs(ways, high)
    names: dict[int, str] = {}
    for one, cells in zip(key.tolist(), numbers.at(past), strict=True):
        if one not in names:
            names[one] = name_of(canonical(closed_graph(cells, drive), len(found.chain)))
    return tuple(
        Border(
            found.machines[machines[way]].name,
            found.axes[axes[way]].name,
            float(starts[machines[way], axes[way]] + share * far[way]),
            float(share * far[way]),
            names[one],
        )
        for way, share, one in zip(ways, high, key.tolist(), strict=True)
    )
