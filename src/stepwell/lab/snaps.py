"""Jumps in a recording, and the predicted snaps that match them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, ByValue, Floats, to_unit
from stepwell.lab.recordings.recording import Recording, without_spikes
from stepwell.lab.rig import judged

# A jump is the difference of two means over 0.1 s, 0.12 s apart: snaps of the paper's rig take 40
# to 80 ms. The trend over 2 s is subtracted. Faster recordings are averaged to 50 Hz first. In
# slower ones a mean is one sample.
_MEAN, _GAP, _COURSE, _RATE = 0.1, 0.06, 2.0, 50.0
# Least number of samples of the trend, time steps that make a gap, and assumed rate without time.
_LEAST_COURSE, _HOLE, _TIMELESS = 21, 3.0, 50.0
SIGMAS = 8.0
SHARE = 0.03  # of the range of the force
# A measured jump is a snap if it has the sign of the predicted one and about its size: rubber and
# friction change it, and a slip within a cell is smaller.
_SIZES = (0.3, 3.0)
# Distance from the predicted stroke [m] that weighs as much as a factor e in the size of the jump.
_FAR = 5e-3


@dataclass(frozen=True, eq=False)
class MeasuredSnap(ByValue):
    """A jump of the force: stroke [m], and force after less force before [N] in recorded order."""

    stroke: float
    jump: float

    def __repr__(self):
        return f"MeasuredSnap({to_unit(self.stroke, 'mm'):.2f} mm, {self.jump:+.3g} N)"


def find_snaps(
    stroke: Floats,
    force: Floats,
    quiet: Sequence[tuple[float, float]] = (),
    time: Floats | None = None,
) -> tuple[MeasuredSnap, ...]:
    """Jumps of the force (n,) [N] along a recording of strokes (n,) [m], in its order.

    A jump counts above 8 robust standard deviations of such differences and above 3 % of the range
    of the force. No jump is reported across a gap in time.

    Args:
        quiet: ranges of stroke in which jumps are ignored [m]: slack of the rig, and the handover
            from one cell to the next.
        time: (n,) of the samples [s]; by default in steps of 20 ms, as test machines record.
    """
    from scipy.ndimage import median_filter

    force = without_spikes(force)
    rate, hole = _clock(time, len(force))
    averaged = max(1, int(rate / _RATE))
    if averaged > 1:  # An incomplete last block is left out.
        blocks = len(force) // averaged * averaged
        parts = [one[:blocks].reshape(-1, averaged) for one in (stroke, force, hole)]
        stroke, force = (np.mean(part, axis=1) for part in parts[:2])
        hole = np.any(parts[2], axis=1)
        rate /= averaged
    mean, gap = max(1, round(_MEAN * rate)), max(1, round(_GAP * rate))
    course = max(_LEAST_COURSE, 2 * round(_COURSE * rate / 2) + 1)
    n, reach = len(force), mean + gap
    if n < 4 * reach + _LEAST_COURSE:
        return ()
    total = np.concatenate([[0.0], np.cumsum(force)])
    at = np.arange(reach, n - reach)
    before = (total[at - gap] - total[at - reach]) / mean
    after = (total[at + reach] - total[at + gap]) / mean
    # The trend is subtracted, over a range that no snap fills.
    jump = after - before
    jump = jump - median_filter(jump, min(course, len(jump) - 1 + len(jump) % 2), mode="nearest")
    noise = 1.4826 * float(np.median(np.abs(jump)))
    least = max(SIGMAS * noise, SHARE * float(np.ptp(force)))
    u = stroke[at]
    holes = np.append(0, np.cumsum(hole))
    whole = holes[at + reach] == holes[at - reach]
    over = judged(u, quiet) & (np.abs(jump) > least) & whole
    edges = np.flatnonzero(np.diff(over, prepend=False, append=False))
    snaps: list[MeasuredSnap] = []
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        peak = start + int(np.argmax(np.abs(jump[start:end])))
        snaps.append(MeasuredSnap(float(u[peak]), float(jump[peak])))
    return tuple(snaps)


def matched(
    jumps: Sequence[MeasuredSnap], predicted: Sequence[MeasuredSnap]
) -> tuple[MeasuredSnap | None, ...]:
    """For every predicted snap the nearest unused jump of its sign and size, or None."""
    left = list(jumps)
    matches: list[MeasuredSnap | None] = []
    for one in predicted:

        def deviation(jump: MeasuredSnap, one: MeasuredSnap = one) -> float:
            return abs(np.log(jump.jump / one.jump)) + abs(jump.stroke - one.stroke) / _FAR

        fitting = [jump for jump in left if _SIZES[0] <= jump.jump / one.jump <= _SIZES[1]]
        matches.append(min(fitting, key=deviation, default=None))
        left = [jump for jump in left if jump is not matches[-1]]
    return tuple(matches)


def samples_of_jump(time: Floats | None) -> float:
    """Number of samples between the two means that define a jump."""
    rate, _ = _clock(time, 0 if time is None else len(time))
    return max(2.0, 2.0 * _GAP * rate)


def holes_of(recording: Recording) -> int:
    """Number of samples missing in all gaps of a recording."""
    rate, hole = _clock(recording.time, len(recording))
    return int(np.sum(np.round(np.diff(recording.time)[hole[1:]] * rate) - 1))


def _clock(time: Floats | None, n: int) -> tuple[float, Bools]:
    """Sampling rate [Hz], and mask (n,) of the samples after a gap."""
    steps = np.diff([] if time is None else time)
    usual = float(np.median(steps)) if len(steps) else 0.0
    if not usual > 0:
        return _TIMELESS, np.zeros(n, bool)
    return 1.0 / usual, np.append(False, steps > _HOLE * usual)
