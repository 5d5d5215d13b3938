"""Jumps and other features of a recording: extremes, work and stiffness of each half."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

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


# A half is averaged over at most this many strips of stroke, each of three rows or more on average.
_STRIPS, _ROWS = 400, 3
# Rows of a half for the search of jumps; longer halves are averaged first.
_MOST = 20_000
# Least prominence of a peak or valley: standard deviations of a strip, and fraction of the range.
_PEAK_SIGMAS, _PEAK_SHARE = 8.0, 0.02
# Part of the stroke over which a stiffness is computed, and parts at both ends without jumps, where
# the machine settles.
_END, _QUIET = 0.1, 0.025
# Most rows of a line at each side of a jump, and rows of a half over these; least step between both
# lines over the jump.
_LINE, _PARTS, _SUDDEN = 10, 16, 0.4
# Fourth differences of white noise have this variance over that of the noise.
_FOURTH = 70.0


class Extreme(NamedTuple):
    """A peak or a valley: stroke [m] and force [N]."""

    stroke: float
    force: float


@dataclass(frozen=True, eq=False)
class HalfCycle(ByValue):
    """A loading or unloading half of a recording.

    Attributes:
        recording, number: name of its recording, and number of the half, from 1.
        direction: "loading" or "unloading".
        start, end: strokes in recorded order [m].
        least, most: range of the force, without single spikes [N].
        peaks, valleys: local extremes of the force above its noise, in recorded order.
        snaps: jumps of the force, as `find_snaps` defines them, if they are steps and no steep
            falls; none in the first and the last 2.5 % of the stroke, where the machine settles.
        work: ∫ F du in recorded order [J]; above zero if the machine does work.
        loss: of a loading half, the fraction of its work that the next half does not return [1];
            NaN without an unloading half, and where that half takes work too, as of a bistable
            chain, which stores energy at either end: see `work` of both.
        stiffness_0, stiffness_1: slope over the first tenth of the stroke from the onset of force
            on, and over its last tenth, at the largest stroke [N/m].
        noise: standard deviation of a force, from fourth differences of the rows [N].
    """

    recording: str
    number: int
    direction: str
    start: float
    end: float
    least: float
    most: float
    peaks: tuple[Extreme, ...] = field(repr=False)
    valleys: tuple[Extreme, ...] = field(repr=False)
    snaps: tuple[MeasuredSnap, ...] = field(repr=False)
    work: float
    loss: float
    stiffness_0: float
    stiffness_1: float
    noise: float = field(repr=False)

    @property
    def name(self) -> str:
        """Its direction, with its number."""
        return f"{self.number} {self.direction}"


def half_cycles(recording: Recording) -> tuple[HalfCycle, ...]:
    """Features of every loading and unloading half of a recording, in recorded order."""
    works = [_work(recording, half) for half in recording.halves]
    halves: list[HalfCycle] = []
    for k, (half, work) in enumerate(zip(recording.halves, works, strict=True)):
        loading = recording.direction_of(half) == "loading"
        after = works[k + 1] if loading and k + 1 < len(works) else math.nan
        loss = 1.0 + after / work if work > 0 >= after else math.nan
        halves.append(_half(recording, half, k + 1, work, loss))
    return tuple(halves)


def _work(recording: Recording, half: slice) -> float:
    return float(np.trapezoid(recording.force[half], recording.stroke[half]))


def _half(recording: Recording, half: slice, number: int, work: float, loss: float) -> HalfCycle:
    stroke, force = recording.stroke[half], recording.force[half]
    noise = noise_of(force)
    u, f, rows = _strips(stroke, force)
    least = max(_PEAK_SIGMAS * noise / math.sqrt(rows), _PEAK_SHARE * float(np.ptp(f)))
    falls = recording.direction_of(half) == "unloading"
    peaks, valleys = (_extremes(u, sign * f, sign, least, falls) for sign in (1.0, -1.0))
    onset = int(np.argmax(np.abs(f - f[0]) > least))
    far = _END * float(np.ptp(u))
    return HalfCycle(
        recording.name,
        number,
        recording.direction_of(half),
        float(stroke[0]),
        float(stroke[-1]),
        float(np.min(f)),
        float(np.max(f)),
        peaks,
        valleys,
        _jumps(recording, half),
        work,
        loss,
        _slope(u, f, u >= u[max(onset - 1, 0)], far),
        _slope(-u, -f, np.ones(len(u), bool), far),
        noise,
    )


def noise_of(force: Floats) -> float:
    """Standard deviation of the noise of forces (n,) [N] in recorded order.

    The median of fourth differences ignores jumps; a course of at most third order has none.
    """
    if len(force) < 8:
        return 0.0
    differences = np.abs(np.diff(force, 4))
    return 1.4826 * float(np.median(differences)) / math.sqrt(_FOURTH)


def _strips(stroke: Floats, force: Floats) -> tuple[Floats, Floats, float]:
    """Mean stroke and force of strips of equal width, stroke rising, and mean rows of a strip."""
    count = max(min(_STRIPS, len(stroke) // _ROWS), min(len(stroke), 2 * _ROWS))
    low, wide = float(np.min(stroke)), float(np.ptp(stroke)) or 1.0
    strip = np.minimum((stroke - low) / wide * count, count - 1).astype(int)
    rows = np.bincount(strip, minlength=count)
    full = rows > 0
    u = np.bincount(strip, stroke, count)[full] / rows[full]
    return u, np.bincount(strip, force, count)[full] / rows[full], len(stroke) / len(u)


def _extremes(
    stroke: Floats, force: Floats, sign: float, least: float, falls: bool
) -> tuple[Extreme, ...]:
    from scipy.signal import find_peaks

    places = find_peaks(force, prominence=least)[0] if least > 0 else np.zeros(0, int)
    found = [Extreme(float(stroke[k]), sign * float(force[k])) for k in places]
    return tuple(found[::-1] if falls else found)


def _jumps(recording: Recording, half: slice) -> tuple[MeasuredSnap, ...]:
    columns: Sequence[Floats] = [recording.stroke[half], recording.force[half]]
    time = recording.time[half]
    known = bool(np.all(np.isfinite(time)) and np.all(np.diff(time) >= 0))
    if (each := len(columns[0]) // _MOST) > 1:
        rows = len(columns[0]) // each * each
        *columns, time = (np.mean(c[:rows].reshape(-1, each), axis=1) for c in (*columns, time))
    low, high = float(np.min(columns[0])), float(np.max(columns[0]))
    quiet = [(-math.inf, low + _QUIET * (high - low)), (high - _QUIET * (high - low), math.inf)]
    stroke, force = columns
    clock = time if known else None
    gap = math.ceil(samples_of_jump(clock) / 2.0)
    return tuple(
        snap
        for snap in find_snaps(stroke, force, quiet, clock)
        if _step(stroke, force, snap.stroke, gap) / snap.jump >= _SUDDEN
    )


def _step(stroke: Floats, force: Floats, at: float, gap: int) -> float:
    """Force after less force before a stroke, each on the line through the rows at its side [N].

    A smooth fall, however steep, has no step: both lines meet. Rows nearer than `gap` are left out.
    """
    k, rows = int(np.argmin(np.abs(stroke - at))), max(min(_LINE, len(stroke) // _PARTS), 2)
    sides = slice(max(k - gap - rows, 0), max(k - gap, 0)), slice(k + gap, k + gap + rows)
    ends: list[float] = []
    for side in sides:
        u, f = stroke[side] - at, force[side]
        if len(u) < 2:
            return 0.0
        off = u - np.mean(u)
        slope = float(off @ f) / float(off @ off) if np.any(off) else 0.0
        ends.append(float(np.mean(f)) - slope * float(np.mean(u)))
    return ends[1] - ends[0]


def _slope(stroke: Floats, force: Floats, after: Bools, far: float) -> float:
    """Slope of the line through the first `far` [m] of the strokes in a mask [N/m]."""
    start = float(np.min(stroke[after]))
    near = after & (stroke <= start + far)
    if np.count_nonzero(near) < 2:
        near = np.isin(stroke, np.sort(stroke[after])[:2])
    off = stroke[near] - np.mean(stroke[near])
    size = float(off @ off)
    return float(off @ force[near]) / size if size else math.nan
