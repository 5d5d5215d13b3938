"""Sizes and forces that a usual workshop does not have: what to look at before it is built."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stepwell.base import Measure, amount, number
from stepwell.design.placement import usual_box
from stepwell.mechanism import Band, Cell, Chain, sizes
from stepwell.statics import Path

# The largest strain of a rubber band in use: natural rubber breaks at about 6 to 7.
STRAIN = 5.0
# What a hobby servo of 2 kg cm pulls on a horn of 10 mm [N], the air that a hand presses [Pa], and
# what that servo turns [N m].
PULLS = {Measure.TRAVEL: 20.0, Measure.VOLUME: 1e5, Measure.ANGLE: 0.2}
_ANGLES = 91  # at which a band is measured, its ends and the middle included
_EDGE = 1e-9  # of the lever: an anchor this far outside is on the edge


def oddities(chain: Chain, path: Path) -> tuple[str, ...]:
    """What is out of the ordinary, a sentence each.

    Args:
        chain: a design.
        path: what the actuator does with it.

    Returns:
        Sentences with numbers in the units in which people are told; none where all is usual.
    """
    # Two bands in one hole are odd once.
    return tuple(dict.fromkeys(_oddities(chain, path)))


def _oddities(chain: Chain, path: Path) -> Iterator[str]:
    unit, most = chain.measure.force_unit, PULLS[chain.measure]
    pull = abs(path.peak_force)
    if pull > most:
        yield (
            f"the actuator needs {amount(pull, unit)}: hobby drives give about {amount(most, unit)}"
        )
    for name, cell in zip(chain.names, chain.cells, strict=True):
        if not isinstance(cell, Cell):
            continue
        yield from (f"{name}: {slip}" for slip in sizes.slips(cell))
        for band in cell.bands:
            yield from _of_band(name, cell, band)


def _of_band(name: str, cell: Cell, band: Band) -> Iterator[str]:
    longest = _longest(cell, band)
    if band.rest_length > 0 and longest > (1.0 + STRAIN) * band.rest_length:
        yield (
            f"a band of {name} is stretched to {number(longest / band.rest_length, 3)} times its "
            f"rest length: rubber tears at about {1 + STRAIN:g} to 8 times"
        )
    for which, place in (("p", band.p), ("q", band.q)):
        box, edge = usual_box(cell.lever, which), _EDGE * cell.lever
        x, y = place
        inside = box.left - edge <= x <= box.right + edge
        if not (inside and box.bottom - edge <= y <= box.top + edge):
            yield (
                f"anchor {which} of {name} at ({number(x * 1e3)}, {number(y * 1e3)}) mm lies "
                f"outside the block of a usual build"
            )


def _longest(cell: Cell, band: Band) -> float:
    """Greatest length of a band on its way [m]."""
    angles = np.linspace(-cell.limit, cell.limit, _ANGLES)
    return float(np.max(band.length(angles, cell.lever)))
