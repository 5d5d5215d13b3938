"""A chain of elements, or of three cells or more, on the test machine compared with its model."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from stepwell.base import Bools, ByValue, Drawn, Floats, Measure, percent, to_unit
from stepwell.lab.pair_test import AGREE, time_of
from stepwell.lab.recordings.curve import rms
from stepwell.lab.recordings.recording import LabError, Recording
from stepwell.lab.rig import END, SETTLE, judged, on_path
from stepwell.lab.series import Series
from stepwell.lab.snaps import MeasuredSnap, find_snaps, matched, samples_of_jump
from stepwell.mechanism import Chain
from stepwell.statics import EventKind

# Largest RMSE that counts as agreement, over the range of the force of the model.
CLOSE_SHARE = 0.10
# Least uncertainty of a force over that range, and parts of the stroke: not judged at either end,
# and before a snap for the slope of the force.
_FORCE, _ENDS, _BEFORE = 0.02, 0.025, 0.025


class SnapComparison(NamedTuple):
    """A predicted jump of the force, a snap or a steep continuous change, and the measured ones.

    Attributes:
        predicted: stroke in the model [m].
        jump: force after less force before in the model [N].
        measured: mean stroke over the runs that show it [m]; NaN if none does.
        runs: number of these runs.
        doubt: standard deviation of the measured less the predicted stroke [m].
        continuous: whether the force of the model changes continuously there, without a snap.
    """

    predicted: float
    jump: float
    measured: float
    runs: int
    doubt: float
    continuous: bool = False

    @property
    def error(self) -> float:
        """Measured less predicted stroke [m]; NaN if no run shows the jump."""
        return self.measured - self.predicted

    @property
    def agrees(self) -> bool:
        """Whether the error is within two standard deviations."""
        return abs(self.error) <= AGREE * self.doubt


@dataclass(frozen=True, eq=False)
class ChainTest(ByValue, Drawn):
    """Comparison of a series of a chain with its model.

    Attributes:
        stroke: (n,) from state 0 on [m].
        force: (n,) measured force less the baseline [N].
        model: (n,) force of the model [N].
        inside: (n,) mask of the judged strokes: without both ends, and without the strokes between
            a predicted jump and the measured one.
        spread: mean standard deviation between repeats [N].
        range: of the force of the model [N].
        tie: whether the motion of the model is undecided.
        jumps: predicted jumps of the force, in the order of motion, with the measured ones. A fall
            so steep that a test machine records a jump is one.
        snaps: for each run the strokes of its jumps that match a predicted snap [m].
        slips: for each run the strokes of its other jumps [m].
    """

    series: Series
    stroke: Floats = field(repr=False)
    force: Floats = field(repr=False)
    model: Floats = field(repr=False)
    inside: Bools = field(repr=False)
    spread: float
    range: float
    tie: bool
    jumps: tuple[SnapComparison, ...]
    snaps: tuple[tuple[float, ...], ...] = field(repr=False)
    slips: tuple[tuple[float, ...], ...] = field(repr=False)

    @property
    def snaps_predicted(self) -> tuple[float, ...]:
        """Strokes of the snaps of the model [m]."""
        return tuple(one.predicted for one in self.jumps if not one.continuous)

    @property
    def rmse(self) -> float:
        """Root mean square of measured less model force [N]."""
        return rms(self._gap)

    @property
    def worst(self) -> tuple[float, float]:
        """Stroke [m] and size [N] of the largest difference."""
        k = int(np.argmax(np.abs(self._gap)))
        return float(self.stroke[self.inside][k]), float(self._gap[k])

    @property
    def agrees(self) -> bool:
        """Whether the force is within `CLOSE_SHARE` of its range, and every jump agrees."""
        close = self.rmse <= CLOSE_SHARE * self.range
        most = 2 * sum(bool(slips) for slips in self.slips) < len(self.slips)
        return close and most and all(one.agrees for one in self.jumps)

    @property
    def verdict(self) -> str:
        """Verdict on force and snaps, with the errors."""
        at, off = self.worst
        words = [
            f"{'agrees' if self.agrees else 'differs'}: force within {self.rmse:.3g} N, "
            f"{percent(self.rmse / self.range)} of its range; most {off:+.3g} N at "
            f"{to_unit(at, 'mm'):.3g} mm"
        ]
        words += [_in_words(one, len(self.snaps)) for one in self.jumps]
        if not self.jumps:
            words.append("no snap predicted")
        if others := [f"{to_unit(u, 'mm'):.2f}" for slips in self.slips for u in slips]:
            words.append(f"other jumps at {', '.join(others[:4])} mm")
        if self.tie:
            words.append("tie: the model has no unique motion")
        return "; ".join(words)

    @property
    def _gap(self) -> Floats:
        return (self.force - self.model)[self.inside]

    def __repr__(self):
        return f"ChainTest({self.series.name}: {self.verdict})"


def chain_test(series: Series) -> ChainTest:
    """Compare a series of a chain with its model at the strokes of its mean curve.

    Jumps are searched in the same way in the runs and in the force of the model at the strokes of
    each run, so a steep fall is compared with a steep fall.

    Raises:
        LabError: the chain is not one of travel and force.
    """
    chain = series.chain
    require_travel(chain, series.recordings[0].source)
    curve, path = series.curve, series.path
    base = series.baseline_curve
    force = curve.force if base is None else curve.force - base.at(curve.stroke)
    model = on_path(path, curve.stroke)
    span = float(np.ptp(model)) or float(np.ptp(path.force)) or 1.0
    ends = _end_zones(chain.full_stroke)
    predicted = _predicted(series, ends)
    matches, slips = _measured(series, predicted, ends, _FORCE * span)
    doubt = max(_FORCE * span, float(np.mean(curve.spread)), *_bands(series))
    jumps = tuple(
        _compared(series, one, [row[k] for row in matches], doubt)
        for k, one in enumerate(predicted)
    )
    wide = _sampled(series)
    between = [
        (min(one.predicted, one.measured) - wide, max(one.predicted, one.measured) + wide)
        for one in jumps
        if one.runs
    ]
    return ChainTest(
        series,
        curve.stroke,
        force,
        model,
        judged(curve.stroke, [*ends, *between]),
        float(np.mean(curve.spread)),
        span,
        bool(path.degenerate),
        jumps,
        tuple(
            tuple(
                one.stroke for one, to in zip(row, jumps, strict=True) if one and not to.continuous
            )
            for row in matches
        ),
        tuple(slips),
    )


def require_travel(chain: Chain, source: str) -> None:
    """Raise a LabError if recordings of stroke and force do not suit a design.

    `source` is the name of the recording.
    """
    if chain.measure is not Measure.TRAVEL:
        raise LabError(
            source,
            f"its design has {chain.measure.travel} and {chain.measure.force}, a recording has "
            "stroke and force: give recordings with a design of travel and force.",
        )


def _end_zones(full: float) -> list[tuple[float, float]]:
    start, end = min(SETTLE, _ENDS * full), min(END, _ENDS * full)
    return [(-math.inf, start), (full - end, math.inf)]


def _predicted(series: Series, ends: Sequence[tuple[float, float]]) -> list[MeasuredSnap]:
    """Snaps of the model, and falls that the sampling of the first run shows as jumps."""
    run: Recording = series.recordings[0]
    stroke, path = series.placed(run), series.path
    snaps = [
        MeasuredSnap(event.stroke, event.force_after - event.force_before)
        for event in path.events
        if event.kind is EventKind.SNAP
    ]
    steep = find_snaps(stroke, on_path(path, stroke), ends, time_of(run))
    near = 2.0 * _sampled(series)
    snaps += [s for s in steep if all(abs(s.stroke - one.stroke) > near for one in snaps)]
    return sorted(snaps, key=lambda one: one.stroke, reverse=series.unloading)


def _measured(
    series: Series,
    predicted: Sequence[MeasuredSnap],
    ends: Sequence[tuple[float, float]],
    least: float,
) -> tuple[list[tuple[MeasuredSnap | None, ...]], list[tuple[float, ...]]]:
    """For each run its jumps above `least` [N] that match a predicted one, and other strokes."""
    matches: list[tuple[MeasuredSnap | None, ...]] = []
    slips: list[tuple[float, ...]] = []
    for run in series.recordings:
        found = find_snaps(series.placed(run), run.force, ends, time_of(run))
        large = [one for one in found if abs(one.jump) > least]
        row = matched(large, predicted)
        matches.append(row)
        slips.append(tuple(one.stroke for one in large if one not in row))
    return matches, slips


def _sampled(series: Series) -> float:
    """Largest stroke over which a jump is detected in the runs [m]."""
    return max(
        float(np.median(np.abs(np.diff(run.stroke)))) * samples_of_jump(time_of(run))
        for run in series.recordings
    )


def _bands(series: Series) -> list[float]:
    """Error bands of the force curves of its elements [N]."""
    return [element.error_band for element in series.chain.elements]


def _compared(
    series: Series, snap: MeasuredSnap, found: Sequence[MeasuredSnap | None], doubt: float
) -> SnapComparison:
    strokes = [one.stroke for one in found if one is not None]
    mean = float(np.mean(strokes)) if strokes else math.nan
    scatter = float(np.std(strokes, ddof=1)) if len(strokes) > 1 else 0.0
    sampling = _sampled(series) / math.sqrt(12.0)
    moved = math.hypot(scatter, sampling, doubt / _slope_before(series, snap.stroke))
    events = [event.stroke for event in series.path.events if event.kind is EventKind.SNAP]
    return SnapComparison(
        snap.stroke, snap.jump, mean, len(strokes), moved, snap.stroke not in events
    )


def _slope_before(series: Series, stroke: float) -> float:
    """Size of the slope of the model's force before a jump [N/m], at least its mean slope."""
    full, way = series.chain.full_stroke, -1.0 if series.unloading else 1.0
    ends = np.array([stroke - way * _BEFORE * full, stroke - way * 1e-3 * full])
    order = np.argsort(ends)
    rise = np.diff(on_path(series.path, ends[order]))[0] / np.ptp(ends)
    least = float(np.ptp(series.path.force)) / full
    return max(abs(float(rise)), least)


def _in_words(one: SnapComparison, runs: int) -> str:
    at = f"{to_unit(one.predicted, 'mm'):.2f} mm"
    what = "fall" if one.jump < 0.0 else "rise"
    if not one.runs:
        steep = f"no steep {what} measured, predicted at {at} (continuous, no snap)"
        return steep if one.continuous else f"no snap measured, predicted at {at}"
    seen = f"continuous {what} of the force, no snap," if one.continuous else "snap"
    return (
        f"{seen} at {to_unit(one.measured, 'mm'):.2f} mm in {one.runs} of {runs} runs, predicted "
        f"at {at} ({to_unit(one.error, 'mm'):+.2f} mm, σ = {to_unit(one.doubt, 'mm'):.2f} mm)"
    )
