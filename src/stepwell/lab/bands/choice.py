"""Which force law to believe: what one curve tells, and what predicts a band not seen."""

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

# A load cell or a scale is true to about this share of its largest reading: what a law leaves below
# it, drift leaves too.
ACCURACY = 0.002
# A difference of the criterion up to this is not worth a further number (Kass & Raftery 1995).
WORTH = 2.0
_FEW = 8  # readings, too few to tell whether neighbours err alike
_STEP = 1e-6  # of the strokes, for slopes by differences


class Interval(NamedTuple):
    """A number with its 95 % interval; NaN where nothing is known of it."""

    value: float
    low: float
    high: float


def independent(left: Floats) -> float:
    """How many independent readings a curve is worth, by what a law leaves of it, (n,) [N].

    Source: Bayley and Hammersley 1946, for a first-order autoregression of neighbours.
    """
    n = len(left)
    off = left - np.mean(left)
    power = float(off @ off)
    if n <= _FEW or power == 0:
        return float(n)
    # Residuals of a fit are correlated by -1/n on average; three of them are gone in its numbers.
    alike = min(max(float(off[1:] @ off[:-1]) / power + 3.0 / n, 0.0), 0.98)
    return max(n * (1 - alike) / (1 + alike), 4.0)


def criterion(left: Floats, numbers: int, worth: float, doubt: float) -> float:
    """How badly a law explains a curve, by what it leaves (n,) [N]; less is better.

    `doubt` is what a reading may be off whatever the law [N]. Few readings make a number dearer,
    as in the criterion of Hurvich & Tsai 1989: by chance it explains more of them.

    Source: Schwarz 1978.
    """
    n = len(left)
    size = float(np.mean(left**2)) + doubt**2
    few = n / max(n - numbers, 0.5)
    return worth * math.log(max(size, 1e-300)) + numbers * math.log(worth) * few


def reading_doubt(fitted: Fitted, stroke: Floats, steps: tuple[float, float]) -> Floats:
    """Standard deviation (n,) [N] of readings told in steps of stroke [m] and force [N]."""
    slope = (fitted.tension(stroke + _STEP) - fitted.tension(stroke - _STEP)) / (2 * _STEP)
    return np.hypot(steps[1], slope * steps[0]) / math.sqrt(12.0)


def intervals(
    fitted: Fitted, gauge: float | None, stroke: Floats, force: Floats, steps: tuple[float, float]
) -> tuple[Interval, Interval]:
    """Slope of the line through a curve [N/m] and onset of its law [m], with 95 % intervals.

    They hold what this band has and others do not, by the scatter of its readings around the law
    and the steps of stroke [m] and force [N] in which they are told (Student).
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
    # What neighbours leave alike still tells something, if little.
    free = min(max(math.floor(worth) - slopes.shape[1], 1), spare)
    has_steps = any(steps)
    doubt = reading_doubt(fitted, u, steps) if has_steps else np.ones(len(u))
    scatter = float(np.sum((left / doubt) ** 2)) / spare
    if has_steps:
        # Few readings can lie on the law by luck: what their digits tell counts as one more.
        scatter = (free * scatter + 1.0) / (free + 1)
    # As many readings as are independent, spread over the strokes as all of them are.
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


_SPARE = 2  # readings beyond its numbers, below which only the line is tried
_LEAST_WORTH = 12
NOTHING = "nothing"


@dataclass(frozen=True, eq=False, repr=False)
class Candidate(ByValue):
    """A force law on trial, through the mean curve of all samples.

    Attributes:
        parameters: how many numbers it has.
        predicted: RMSE of each fold that was left out [N].
        estimates: each of its numbers with the interval that the scatter of the samples allows.
        above_best: with one curve, its criterion above the least one; 0 for the best. NaN where
            laws were tried on what was left out.
    """

    fitted: Fitted
    parameters: int
    predicted: tuple[float, ...] = field(repr=False)
    estimates: dict[str, Estimate] = field(repr=False)
    above_best: float = field(default=math.nan, repr=False)

    @property
    def law(self) -> ForceLaw:
        """The family."""
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
    """Force laws beside each other.

    Attributes:
        candidates: every law, fewest numbers first.
        best: the one with the least prediction error.
        chosen: the one with the fewest numbers among those as good as the best.
        folds: what was left out in turn: "sample", or "cycle" where there is one sample, or
            "nothing" where there is one curve.
        gauge: length of the bands at stroke 0 [m]; None where it is not known.
        worth: with one curve, how many independent readings it holds; else NaN.
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
        """ℓ0 [m] of the chosen law; None where the recordings cannot tell it."""
        return None if self.gauge is None else self.gauge + self.chosen.fitted.onset

    def rest_length_reason(self, candidate: Candidate | None = None) -> str:
        """What may be said of the rest length by a law, the chosen one by default."""
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
            f"The rest length cannot be identified from these recordings: they hold the "
            f"displacement of the grips, not the length of the band. Give the length at stroke 0, "
            f"to which an onset of {to_unit(onset, 'mm'):.4g} mm is added. (What the curvature "
            f"alone would imply is no measurement: {implied}.)"
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
                f"true to {ACCURACY:.1%} of the largest force or its last digit): "
                f"{', '.join(leaves)}. No law could be tried on another curve."
            )
        return (
            f"Chosen: {self.chosen.law.name}, the fewest numbers within one standard error of the "
            f"best ({self.best.law.name}), one {self.folds} being left out in turn."
        )

    def __repr__(self):
        how = "of one curve" if self.folds == NOTHING else f"by leaving one {self.folds} out"
        return (
            f"Choice({self.chosen.law.name}, best {self.best.law.name}, of "
            f"{len(self.candidates)} laws {how})"
        )


def choose_law(test: BandTest, gauge: float | None = None) -> Choice:
    """Fit every force law that has readings enough, and choose one.

    One sample is left out in turn (one cycle, where there is one sample) and predicted from the
    mean curve of the others, up to one factor: bands scatter in stiffness, and a law is about the
    shape. Chosen is the law of fewest numbers among those whose error is within one standard
    error of the best one's; of two with as many numbers, the better. With one curve nothing can be
    left out: Schwarz's criterion decides, for as many readings as are independent.

    Args:
        gauge: length of the bands at stroke 0 [m], where it is known and not in the files.

    Raises:
        ValueError: a gauge length that is not above zero, or not that of the files.

    Source: one-standard-error rule, Breiman et al. 1984; criterion, Schwarz 1978.
    """
    if gauge is not None and not 0 < gauge < math.inf:
        raise InputError(f"gauge = {gauge} m: must be > 0, the length of the band at stroke 0.")
    if gauge is not None and test.gauge is not None:
        raise InputError(
            f"gauge = {gauge} m: the files hold the length of the band, {test.gauge:.5g} m at "
            f"stroke 0: leave it out."
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
    """Slope [N/m] and onset [m], with 95 % intervals by its readings, of a band tested alone."""
    sample, *others = test.samples
    if others:
        return None
    steps = test.steps_of(sample)
    slope, onset = intervals(choice.chosen.fitted, choice.gauge, *test.curve(sample), steps)
    # Of all readings, as `stiffness` has it, and not of the curve's means.
    k = stiffness(test).value
    return Interval(k, *(k + edge - slope.value for edge in slope[1:])), onset


def _choice_of_one_curve(test: BandTest, laws: Sequence[ForceLaw], gauge: float | None) -> Choice:
    """The choice for one curve: the fewest numbers that are not worth another."""
    (sample,) = test.samples
    stroke, force = test.curve(sample)
    candidates: list[Candidate] = []
    for law in laws:
        one = fit(law, stroke, force, gauge)
        alone = {name: of_samples({sample: value}) for name, value in one.values.items()}
        candidates.append(Candidate(one, law.count(gauge), (one.rmse,), alone))
    # By what the line leaves: what it cannot follow counts as few readings, so that drift of a
    # load cell, which is as smooth, is no reason for a richer law. Not fewer than a dozen, or no
    # bend would be reason enough.
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
    """Strokes that all curves reach [m], and the forces of each there [N]."""
    stroke = curves[0][0]
    if all(len(u) == len(stroke) and np.ptp(u - stroke) < REACH for u, _ in curves):
        return stroke, [np.interp(stroke, u, force) for u, force in curves]
    # A few readings each, not at the same strokes: a straight line between two cuts the corner.
    from scipy.interpolate import PchipInterpolator  # pyright: ignore[reportMissingTypeStubs]

    low, high = max(u[0] for u, _ in curves), min(u[-1] for u, _ in curves)
    stroke = np.linspace(low, high, min(len(u) for u, _ in curves))
    return stroke, [PchipInterpolator(u, force)(stroke) for u, force in curves]


def _estimates(test: BandTest, law: ForceLaw, gauge: float | None) -> dict[str, Estimate]:
    each = {sample: fit(law, *test.curve(sample), gauge).values for sample in test.samples}
    names = next(iter(each.values()))
    return {name: of_samples({s: values[name] for s, values in each.items()}) for name in names}
