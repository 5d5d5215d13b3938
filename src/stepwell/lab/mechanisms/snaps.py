"""Snaps in a recording: where the force jumps faster than the rig could make it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepwell.base import ByValue, Floats
from stepwell.lab.mechanisms.rig import judged

# Mean force of 5 samples before and after, 6 samples apart: 120 ms at 50 Hz, where snaps of the
# paper's rig take 40 to 80 ms.
_MEAN, _GAP, _COURSE = 5, 3, 101
SIGMAS = 8.0
SHARE = 0.03  # of the range of the force


@dataclass(frozen=True, eq=False)
class MeasuredSnap(ByValue):
    """A jump of the force.

    Attributes:
        stroke: where [m].
        jump: force after less force before [N].
    """

    stroke: float
    jump: float

    def __repr__(self):
        return f"MeasuredSnap({self.stroke * 1e3:.2f} mm, {self.jump:+.3g} N)"


def find_snaps(
    stroke: Floats, force: Floats, quiet: Sequence[tuple[float, float]] = ()
) -> tuple[MeasuredSnap, ...]:
    """Jumps of the force along a recording.

    A jump counts if it is over 8 robust standard deviations of such differences and over 3 % of
    the range of the force.

    Args:
        stroke: (n,) [m], evenly sampled in time.
        force: (n,) [N].
        quiet: strokes between which a jump is no snap [m]: where the rig takes up its slack or one
            cell hands over to the next.

    Returns:
        The snaps in the order of the recording.
    """
    from scipy.ndimage import median_filter

    n = len(force)
    reach = _MEAN + _GAP
    if n < 4 * reach:
        return ()
    total = np.concatenate([[0.0], np.cumsum(force)])
    at = np.arange(reach, n - reach)
    before = (total[at - _GAP] - total[at - reach]) / _MEAN
    after = (total[at + reach] - total[at + _GAP]) / _MEAN
    # Less what the force does there anyway, over a stretch that no snap fills.
    jump = after - before
    jump = jump - median_filter(jump, _COURSE, mode="nearest")
    noise = 1.4826 * float(np.median(np.abs(jump)))
    least = max(SIGMAS * noise, SHARE * float(np.ptp(force)))
    u = stroke[at]
    over = judged(u, quiet) & (np.abs(jump) > least)
    edges = np.flatnonzero(np.diff(over, prepend=False, append=False))
    found: list[MeasuredSnap] = []
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        peak = start + int(np.argmax(np.abs(jump[start:end])))
        found.append(MeasuredSnap(float(u[peak]), float(jump[peak])))
    return tuple(found)
