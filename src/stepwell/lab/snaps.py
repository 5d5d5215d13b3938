"""Jumps in a recording, and which of them are the snaps that theory tells of."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stepwell.base import Bools, ByValue, Floats, to_unit
from stepwell.lab.recordings.recording import Recording, without_spikes
from stepwell.lab.rig import judged
from stepwell.statics import Event

# Means over 0.1 s before and after, 0.12 s apart: snaps of the paper's rig take 40 to 80 ms. What
# the force does there anyway is seen over 2 s. Faster recordings are averaged to this rate first;
# of slower ones a mean is one sample.
_MEAN, _GAP, _COURSE, _RATE = 0.1, 0.06, 2.0, 50.0
# Of samples: what the course needs at least, steps that make a hole, and the rate of a recording
# without time.
_LEAST_COURSE, _HOLE, _TIMELESS = 21, 3.0, 50.0
SIGMAS = 8.0
SHARE = 0.03  # of the range of the force
# A measured jump is a snap if it has the sign of the predicted one and about its size: rubber and
# friction change it, and a slip within a cell is smaller.
_SIZES = (0.3, 3.0)
# How far from where it is predicted a snap counts as much as by how many times its size is off [m].
_FAR = 5e-3


@dataclass(frozen=True, eq=False)
class MeasuredSnap(ByValue):
    """A jump of the force: where [m], and force after less force before [N], in recorded order."""

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

    A jump counts if it is over 8 robust standard deviations of such differences and over 3 % of
    the range of the force. Across a hole in time nothing can be told, so there is no jump.

    Args:
        quiet: strokes between which a jump is no snap [m]: where the rig takes up its slack or one
            cell hands over to the next.
        time: (n,) of the samples [s]; by default they are 20 ms apart, as test machines write.
    """
    from scipy.ndimage import median_filter

    force = without_spikes(force)
    rate, hole = _clock(time, len(force))
    averaged = max(1, int(rate / _RATE))
    if averaged > 1:  # What is left at the end is left out.
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
    # Less what the force does there anyway, over a stretch that no snap fills.
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
    jumps: Sequence[MeasuredSnap], predicted: Sequence[Event]
) -> tuple[MeasuredSnap | None, ...]:
    """For every predicted snap the jump of its sign and size near it, no jump twice; or None."""
    left = list(jumps)
    matches: list[MeasuredSnap | None] = []
    for event in predicted:
        size = event.force_after - event.force_before

        def deviation(jump: MeasuredSnap, size: float = size, event: Event = event) -> float:
            return abs(np.log(jump.jump / size)) + abs(jump.stroke - event.stroke) / _FAR

        fitting = [one for one in left if _SIZES[0] <= one.jump / size <= _SIZES[1]]
        matches.append(min(fitting, key=deviation, default=None))
        left = [one for one in left if one is not matches[-1]]
    return tuple(matches)


def samples_of_jump(time: Floats | None) -> float:
    """How many samples of a recording lie between the two means that tell a jump."""
    rate, _ = _clock(time, 0 if time is None else len(time))
    return max(2.0, 2.0 * _GAP * rate)


def holes_of(recording: Recording) -> int:
    """How many samples are missing between two that follow each other, in all holes."""
    rate, hole = _clock(recording.time, len(recording))
    return int(np.sum(np.round(np.diff(recording.time)[hole[1:]] * rate) - 1))


def _clock(time: Floats | None, n: int) -> tuple[float, Bools]:
    """Samples a second, and (n,) whether there is a hole before a sample."""
    steps = np.diff([] if time is None else time)
    usual = float(np.median(steps)) if len(steps) else 0.0
    if not usual > 0:
        return _TIMELESS, np.zeros(n, bool)
    return 1.0 / usual, np.append(False, steps > _HOLE * usual)
