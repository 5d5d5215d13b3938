"""Spikes: single samples that are far off those beside them."""

from __future__ import annotations

import numpy as np

from stepwell.base import Bools, Floats

# Of the range of the force; and so many times what all but a fiftieth of the samples are off the
# median of three. A snap stays where it has jumped to, so its samples are not off it.
_SHARE, _TIMES, _MOST = 0.05, 5.0, 0.98


def spikes(force: Floats) -> Bools:
    """Which samples (n,) of a force [N] are off both beside them, far beyond the others."""
    middle = _of_three(force)
    off = np.abs(force - middle)
    usual = float(np.quantile(off, _MOST)) if len(off) else 0.0
    return off > max(_TIMES * usual, _SHARE * float(np.ptp(middle)) if len(off) else 0.0)


def without_spikes(force: Floats) -> Floats:
    """The force (n,) [N], the median of three in place of every spike."""
    found = spikes(force)
    return np.where(found, _of_three(force), force) if np.any(found) else force


def _of_three(force: Floats) -> Floats:
    """Median of every sample and the two beside it; an end, which has one beside it, as it is."""
    if len(force) < 3:
        return force
    low, high = np.minimum(force[:-1], force[1:]), np.maximum(force[:-1], force[1:])
    inner = np.maximum(low[:-1], np.minimum(high[:-1], force[2:]))
    return np.concatenate([force[:1], inner, force[-1:]])
