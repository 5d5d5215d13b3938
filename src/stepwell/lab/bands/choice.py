"""Which force law to believe: the simplest that predicts a band it has not seen."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from stepwell.base import ByValue, Floats, InputError, brief
from stepwell.lab.bands.band import BandTest
from stepwell.lab.bands.laws import LAWS, Fitted, ForceLaw, fit
from stepwell.lab.bands.spread import Estimate, of_samples
from stepwell.lab.recordings import rms

NOTHING = "nothing"


@dataclass(frozen=True, eq=False)
class Candidate(ByValue):
    """A force law on trial.

    Attributes:
        fitted: the law through the mean curve of all samples.
        parameters: how many numbers it has.
        predicted: RMSE of each fold that was left out [N].
        estimates: each of its numbers with the interval that the scatter of the samples allows.
    """

    fitted: Fitted
    parameters: int
    predicted: tuple[float, ...] = field(repr=False)
    estimates: dict[str, Estimate] = field(repr=False)

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

    def __repr__(self):
        return brief(self)


@dataclass(frozen=True, eq=False)
class Choice(ByValue):
    """Force laws beside each other.

    Attributes:
        candidates: every law, fewest numbers first.
        best: the one with the least prediction error.
        chosen: the one with the fewest numbers among those as good as the best.
        folds: what was left out in turn: "sample", or "cycle" where there is one sample, or
            "nothing" where there is one curve.
        gauge: length of the bands at stroke 0 [m]; None where it was not given.
    """

    candidates: tuple[Candidate, ...]
    best: Candidate
    chosen: Candidate
    folds: str
    gauge: float | None

    def named(self, name: str) -> Candidate:
        """The candidate of this name."""
        return next(c for c in self.candidates if c.law.name == name)

    @property
    def rest_length(self) -> float | None:
        """ℓ0 [m] of the chosen law; None where the recordings cannot tell it."""
        return None if self.gauge is None else self.gauge + self.chosen.fitted.onset

    def rest_length_told(self, candidate: Candidate | None = None) -> str:
        """What may be said of the rest length by a law, the chosen one by default."""
        onset = (candidate or self.chosen).fitted.onset
        if self.gauge is not None:
            return (
                f"Rest length {(self.gauge + onset) * 1e3:.4g} mm: the length at stroke 0 that was "
                f"given, and the onset of the force law."
            )
        lengths = [c for c in self.candidates if c.law.needs_length]
        implied = ", ".join(
            f"{c.fitted.length * 1e3:.3g} mm by the {c.law.name} law" for c in lengths
        )
        return (
            f"The rest length cannot be identified from these recordings: they hold the "
            f"displacement of the grips, not the length of the band. Give the length at stroke 0, "
            f"to which an onset of {onset * 1e3:.4g} mm is added. (What the curvature alone would "
            f"imply is no measurement: {implied}.)"
        )

    @property
    def told(self) -> str:
        """How the law was chosen, in a sentence."""
        if self.folds == NOTHING:
            return (
                f"Chosen: {self.chosen.law.name}, the fewest numbers; there is one curve, so no "
                f"law could be tried on another."
            )
        return (
            f"Chosen: {self.chosen.law.name}, the fewest numbers within one standard error of the "
            f"best ({self.best.law.name}), one {self.folds} being left out in turn."
        )

    def __repr__(self):
        return (
            f"Choice({self.chosen.law.name}, best {self.best.law.name}, of "
            f"{len(self.candidates)} laws by leaving one {self.folds} out)"
        )


def choose_law(test: BandTest, gauge: float | None = None) -> Choice:
    """Fit every force law, and choose one by cross-validation.

    One sample is left out in turn (one cycle, where there is one sample) and predicted from the
    mean curve of the others, up to one factor: bands scatter in stiffness, and a law is about the
    shape. Chosen is the law of fewest numbers among those whose error is within one standard
    error of the best one's; of two with as many numbers, the better.

    Args:
        test: samples and cycles; with one curve alone no law can be tried, and the line is taken.
        gauge: length of the bands at stroke 0 [m], where it is known.

    Returns:
        The laws with their errors.

    Raises:
        ValueError: a gauge length that is not above zero.

    Source: one-standard-error rule, Breiman et al. 1984.
    """
    if gauge is not None and not 0 < gauge < math.inf:
        raise InputError(f"gauge = {gauge} m: must be > 0, the length of the band at stroke 0.")
    folds, curves = _curves(test)
    stroke = curves[0][0]
    forces = [np.interp(stroke, u, force) for u, force in curves]
    candidates: list[Candidate] = []
    for law in LAWS:
        predicted: list[float] = []
        for k, force in enumerate(forces):
            others = [f for j, f in enumerate(forces) if j != k] or [force]
            guess = fit(law, stroke, np.mean(others, axis=0), gauge)
            shape = guess.tension(stroke)
            factor = float(shape @ force / (shape @ shape))
            predicted.append(rms(factor * shape - force))
        whole = fit(law, stroke, np.mean(forces, axis=0), gauge)
        candidates.append(
            Candidate(whole, law.count(gauge), tuple(predicted), _estimates(test, law, gauge))
        )
    candidates.sort(key=lambda c: (c.parameters, c.score))
    best = min(candidates, key=lambda c: c.score)
    chosen = next(
        c for c in candidates if folds == NOTHING or c.score <= best.score + best.uncertainty
    )
    return Choice(tuple(candidates), best, chosen, folds, gauge)


def _curves(test: BandTest) -> tuple[str, list[tuple[Floats, Floats]]]:
    if len(test.samples) > 1 or len(test.used) == 1:
        folds = "sample" if len(test.samples) > 1 else NOTHING
        return folds, [test.curve(sample) for sample in test.samples]
    cycles = sorted({loop.cycle for loop in test.used})
    single = [replace(test, cycles=(cycle, cycle)) for cycle in cycles]
    return "cycle", [one.curve(sample) for one in single for sample in one.samples]


def _estimates(test: BandTest, law: ForceLaw, gauge: float | None) -> dict[str, Estimate]:
    each = {sample: fit(law, *test.curve(sample), gauge).values for sample in test.samples}
    names = next(iter(each.values()))
    return {name: of_samples({s: values[name] for s, values in each.items()}) for name in names}
