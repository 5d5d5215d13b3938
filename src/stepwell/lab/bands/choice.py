"""Selection of a force law, by a criterion for one curve or by prediction of other bands."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from stepwell.base import ByValue, Floats, InputError, to_unit
from stepwell.lab.bands.band import BandTest, stiffness
from stepwell.lab.bands.halves import REACH, Estimate, of_samples, student, taut
from stepwell.lab.bands.laws import LAWS, Fitted, ForceLaw, fit
from stepwell.lab.recordings.curve import rms

# Accuracy of a load cell or a scale over its largest reading: smaller residuals may be drift.
ACCURACY = 0.002
# A larger difference of the criterion justifies a further number (Kass & Raftery 1995).
WORTH = 2.0
_FEW = 8  # readings, too few to estimate the correlation of neighbours
_STEP = 1e-6  # step of the stroke for finite differences


class Interval(NamedTuple):
    """A number with its 95 % interval; NaN if unknown."""

    value: float
    low: float
    high: float


def independent(left: Floats) -> float:
    """Effective number of independent readings of a curve, from residuals (n,) of a law [N].

    Source: Bayley and Hammersley 1946, for a first-order autoregression of neighbours.
    """
    n = len(left)
    off = left - np.mean(left)
    power = float(off @ off)
    if n <= _FEW or power == 0:
        return float(n)
    # Residuals of a fit are correlated by -1/n on average; 3/n corrects for three fitted numbers.
    alike = min(max(float(off[1:] @ off[:-1]) / power + 3.0 / n, 0.0), 0.98)
    return max(n * (1 - alike) / (1 + alike), 4.0)


def criterion(left: Floats, numbers: int, worth: float, doubt: float) -> float:
    """Information criterion of a law for a curve, from its residuals (n,) [N]; less is better.

    `doubt` is the uncertainty of a reading [N]. With few readings each number has a larger penalty,
    as in the criterion of Hurvich & Tsai 1989, because it fits more of them by chance.

    Source: Schwarz 1978.
    """
    n = len(left)
    size = float(np.mean(left**2)) + doubt**2
    few = n / max(n - numbers, 0.5)
    return worth * math.log(max(size, 1e-300)) + numbers * math.log(worth) * few


def reading_doubt(fitted: Fitted, stroke: Floats, steps: tuple[float, float]) -> Floats:
    """Rounding error (n,) [N] of readings with steps of stroke [m] and force [N]."""
    slope = (fitted.tension(stroke + _STEP) - fitted.tension(stroke - _STEP)) / (2 * _STEP)
    return np.hypot(steps[1], slope * steps[0]) / math.sqrt(12.0)


def intervals(
    fitted: Fitted, gauge: float | None, stroke: Floats, force: Floats, steps: tuple[float, float]
) -> tuple[Interval, Interval]:
    """Slope of the line through a curve [N/m] and onset of its law [m], with 95 % intervals.

    Student intervals for this band alone, from the scatter of its readings around the law and the
    resolution `steps` of stroke [m] and force [N].
    """
    pulls = taut(force, steps[1])
    x = stroke[pulls] - np.mean(stroke[pulls])
    k = float(x @ force[pulls] / (x @ x)) if len(x) > 1 else math.nan
    beyond = stroke > fitted.onset
    u, f = stroke[beyond], force[beyond]
    if len(u) <= fitted.law.count(gauge):
        return _interval(k, math.nan), _interval(fitted.onset, math.nan)
    slopes = fitted.slopes(u, gauge)
    left = f - fitted.tension(u)
    worth = independent(left)
    spare = len(u) - slopes.shape[1]
    # Correlated residuals still contain some information.
    free = min(max(math.floor(worth) - slopes.shape[1], 1), spare)
    has_steps = any(steps)
    doubt = reading_doubt(fitted, u, steps) if has_steps else np.ones(len(u))
    scatter = float(np.sum((left / doubt) ** 2)) / spare
    if has_steps:
        # Few readings can fit the law by chance: their resolution counts as one more residual.
        scatter = (free * scatter + 1.0) / (free + 1)
    # For the number of independent readings, distributed over the strokes like all readings.
    wide = student(free + has_steps) * math.sqrt(scatter * len(u) / worth)
    scale = np.linalg.norm(slopes, axis=0)
    to_onset = np.linalg.pinv(slopes / scale)[0] / scale[0]
    to_slope = x / float(x @ x)
    at_pulls = reading_doubt(fitted, stroke[pulls], steps) if has_steps else np.ones(len(x))
    k_error = wide * float(np.linalg.norm(to_slope * at_pulls))
    onset_error = wide * float(np.linalg.norm(to_onset * doubt))
    return _interval(k, k_error), _interval(fitted.onset, onset_error)


def _interval(value: float, error: float) -> Interval:
    return Interval(value, value - error, value + error)


_SPARE = 2  # least number of readings beyond the numbers of a law; below it only the line is tried
_LEAST_WORTH = 12
NOTHING = "nothing"


@dataclass(frozen=True, eq=False, repr=False)
class Candidate(ByValue):
    """A force law fitted to the mean curve of all samples, with its prediction errors.

    Attributes:
        parameters: number of fitted numbers.
        predicted: RMSE of each left-out fold [N].
        estimates: each fitted number with its interval from the scatter of the samples.
        above_best: for one curve, its criterion above the least one; 0 for the best. NaN if laws
            were compared by left-out folds.
    """

    fitted: Fitted
    parameters: int
    predicted: tuple[float, ...] = field(repr=False)
    estimates: dict[str, Estimate] = field(repr=False)
    above_best: float = field(default=math.nan, repr=False)

    @property
    def law(self) -> ForceLaw:
        """Family of the law."""
        return self.fitted.law

    @property
    def score(self) -> float:
        """Mean RMSE over the folds [N]."""
        return float(np.mean(self.predicted))

    @property
    def uncertainty(self) -> float:
        """Standard error of the score over the folds [N]."""
        n = len(self.predicted)
        return float(np.std(self.predicted, ddof=1)) / math.sqrt(n) if n > 1 else 0.0


@dataclass(frozen=True, eq=False)
class Choice(ByValue):
    """Comparison of force laws, and the chosen one.

    Attributes:
        candidates: every law, fewest numbers first.
        best: the law with the least prediction error.
        chosen: the law with the fewest numbers of those as good as the best.
        folds: left out in turn: "sample", or "cycle" for one sample, or "nothing" for one curve.
        gauge: length of the bands at stroke 0 [m]; None if unknown.
        worth: for one curve, its effective number of independent readings; else NaN.
    """

    candidates: tuple[Candidate, ...]
    best: Candidate
    chosen: Candidate
    folds: str
    gauge: float | None
    worth: float = math.nan

    def named(self, name: str) -> Candidate:
        """The candidate of this name."""
        return next(c for c in self.candidates if c.law.name == name)

    @property
    def rest_length(self) -> float | None:
        """ℓ0 [m] of the chosen law; None if the recordings do not identify it."""
        return None if self.gauge is None else self.gauge + self.chosen.fitted.onset

    def rest_length_reason(self, candidate: Candidate | None = None) -> str:
        """Rest length by a law, the chosen one by default, or the reason why it is unknown."""
        onset = (candidate or self.chosen).fitted.onset
        if self.gauge is not None:
            return (
                f"Rest length {to_unit(self.gauge + onset, 'mm'):.4g} mm: the length at stroke 0, "
                f"{to_unit(self.gauge, 'mm'):.4g} mm, and the onset of the force law."
            )
        implied = ", ".join(
            f"{to_unit(c.fitted.length, 'mm'):.3g} mm by the {c.law.name} law"
            for c in self.candidates
            if c.law.needs_length
        )
        return (
            f"The rest length cannot be identified from these recordings: they contain the "
            f"displacement of the grips, not the length of the band. Give the length at stroke 0; "
            f"an onset of {to_unit(onset, 'mm'):.4g} mm is added to it. (The curvature alone "
            f"implies values that are no measurement: {implied}.)"
        )

    @property
    def reason(self) -> str:
        """How the law was chosen, in a sentence."""
        if self.folds == NOTHING:
            line, richest = self.candidates[0], min(self.candidates, key=lambda c: c.fitted.rmse)
            leaves = [
                f"{one.law.name} leaves {to_unit(one.fitted.rmse, 'mN'):.2g} mN"
                for one in dict.fromkeys((line, self.chosen, richest))
            ]
            return (
                f"Chosen: {self.chosen.law.name}, the fewest numbers that explain the one curve as "
                f"well as any (Schwarz's criterion, {self.worth:.0f} independent readings, each "
                f"accurate to {ACCURACY:.1%} of the largest force or its last digit): "
                f"{', '.join(leaves)}. No law could be tested on another curve."
            )
        return (
            f"Chosen: {self.chosen.law.name}, the fewest numbers within one standard error of the "
            f"best ({self.best.law.name}), leaving out one {self.folds} in turn."
        )

    def __repr__(self):
        how = "of one curve" if self.folds == NOTHING else f"by leaving one {self.folds} out"
        return (
            f"Choice({self.chosen.law.name}, best {self.best.law.name}, of "
            f"{len(self.candidates)} laws {how})"
        )


def choose_law(test: BandTest, gauge: float | None = None) -> Choice:
    """Fit every force law for which there are enough readings, and choose one.

    One sample (or one cycle of a single sample) is left out in turn and predicted from the mean
    curve of the others. A factor is fitted, because bands differ in stiffness and a law describes
    the shape. The chosen law has the fewest numbers of those within one standard error of the
    best. Of two with equally many, it is the better one. For one curve Schwarz's criterion decides,
    with the effective number of independent readings.

    Args:
        gauge: length of the bands at stroke 0 [m], if known and not in the files.

    Raises:
        ValueError: a gauge length is not above zero, or is given twice.

    Source: one-standard-error rule, Breiman et al. 1984; criterion, Schwarz 1978.
    """
    if gauge is not None and not 0 < gauge < math.inf:
        raise InputError(f"gauge = {gauge} m: must be > 0, the length of the band at stroke 0.")
    if gauge is not None and test.gauge is not None:
        raise InputError(
            f"gauge = {gauge} m: the files contain the length of the band, {test.gauge:.5g} m at "
            f"stroke 0: leave gauge out."
        )
    gauge = test.gauge if gauge is None else gauge
    folds, curves = _curves(test)
    stroke, forces = _together(curves)
    spare = min(len(u) for u, _ in curves) - _SPARE
    laws = [law for law in LAWS if law is LAWS[0] or law.count(gauge) <= spare]
    if folds == NOTHING:
        return _choice_of_one_curve(test, laws, gauge)
    candidates: list[Candidate] = []
    for law in laws:
        predicted: list[float] = []
        for k, force in enumerate(forces):
            guess = fit(law, stroke, np.mean([*forces[:k], *forces[k + 1 :]], axis=0), gauge)
            shape = guess.tension(stroke)
            factor = float(shape @ force / (shape @ shape))
            predicted.append(rms(factor * shape - force))
        whole = fit(law, stroke, np.mean(forces, axis=0), gauge)
        candidates.append(
            Candidate(whole, law.count(gauge), tuple(predicted), _estimates(test, law, gauge))
        )
    candidates.sort(key=lambda c: (c.parameters, c.score))
    best = min(candidates, key=lambda c: c.score)
    chosen = next(c for c in candidates if c.score <= best.score + best.uncertainty)
    return Choice(tuple(candidates), best, chosen, folds, gauge)


def this_band(test: BandTest, choice: Choice) -> tuple[Interval, Interval] | None:
    """Slope [N/m] and onset [m] of a single tested band, with 95 % intervals of its readings."""
    sample, *others = test.samples
    if others:
        return None
    steps = test.steps_of(sample)
    slope, onset = intervals(choice.chosen.fitted, choice.gauge, *test.curve(sample), steps)
    # The value of `stiffness` from all readings replaces that from the means of the curve.
    k = stiffness(test).value
    return Interval(k, *(k + edge - slope.value for edge in slope[1:])), onset


def _choice_of_one_curve(test: BandTest, laws: Sequence[ForceLaw], gauge: float | None) -> Choice:
    """Choice of a law for one curve by the criterion."""
    (sample,) = test.samples
    stroke, force = test.curve(sample)
    candidates: list[Candidate] = []
    for law in laws:
        one = fit(law, stroke, force, gauge)
        alone = {name: of_samples({sample: value}) for name, value in one.values.items()}
        candidates.append(Candidate(one, law.count(gauge), (one.rmse,), alone))
    # Independent readings are counted in the residuals of the line. A smooth deviation counts as
    # few readings, so drift of a load cell, which is smooth too, does not justify a richer law. The
    # least number is 12; with fewer, no curvature would justify one.
    line = candidates[0].fitted
    worth = max(independent(force - line.tension(stroke)), min(len(stroke), _LEAST_WORTH))
    reading_error = rms(reading_doubt(line, stroke, test.steps_of(sample)))
    doubt = math.hypot(ACCURACY * float(np.max(force)), reading_error)
    scores = [
        criterion(force - one.fitted.tension(stroke), one.parameters, worth, doubt)
        for one in candidates
    ]
    judged = [
        replace(candidate, above_best=score - min(scores))
        for candidate, score in zip(candidates, scores, strict=True)
    ]
    judged.sort(key=lambda c: c.parameters)
    best = min(judged, key=lambda c: c.above_best)
    chosen = next(c for c in judged if c.above_best <= WORTH)
    return Choice(tuple(judged), best, chosen, NOTHING, gauge, worth)


def _curves(test: BandTest) -> tuple[str, list[tuple[Floats, Floats]]]:
    if len(test.samples) > 1 or len(test.used) == 1:
        folds = "sample" if len(test.samples) > 1 else NOTHING
        return folds, [test.curve(sample) for sample in test.samples]
    cycles = sorted({loop.cycle for loop in test.used})
    single = [replace(test, cycles=(cycle, cycle)) for cycle in cycles]
    return "cycle", [one.curve(sample) for one in single for sample in one.samples]


def _together(curves: list[tuple[Floats, Floats]]) -> tuple[Floats, list[Floats]]:
    """Strokes common to all curves [m], and the force of each curve there [N]."""
    stroke = curves[0][0]
    if all(len(u) == len(stroke) and np.ptp(u - stroke) < REACH for u, _ in curves):
        return stroke, [np.interp(stroke, u, force) for u, force in curves]
    # Few readings at different strokes: linear interpolation would cut corners.
    from scipy.interpolate import PchipInterpolator  # pyright: ignore[reportMissingTypeStubs]

    low, high = max(u[0] for u, _ in curves), min(u[-1] for u, _ in curves)
    stroke = np.linspace(low, high, min(len(u) for u, _ in curves))
    return stroke, [PchipInterpolator(u, force)(stroke) for u, force in curves]


def _estimates(test: BandTest, law: ForceLaw, gauge: float | None) -> dict[str, Estimate]:
    each = {sample: fit(law, *test.curve(sample), gauge).values for sample in test.samples}
    names = next(iter(each.values()))
    return {name: of_samples({s: values[name] for s, values in each.items()}) for name in names}
