"""Force laws of rubber: tension of a band against the displacement of its grips."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from stepwell.base import ByValue, Floats, InputError, to_unit
from stepwell.lab.recordings.curve import rms

# Bounds of the fit: distance of the onset of tension from stroke 0 [m], and rest length [m].
_ONSET = 0.060
_LENGTH = (0.002, 0.300)
_SLACK = 0.05  # fraction of the fitted strokes in which a band may still be slack
_SLACK_FORCE = 0.02  # fraction of the largest force, below which a band counts as slack
_NEXT = 0.9  # fraction of the distance from a slack reading to the next
_EDGE = 1e-4  # distance from a bound over its range


@dataclass(frozen=True, eq=False)
class ForceLaw(ByValue):
    """A family of tension curves, T = Σ c_j φ_j, its coefficients entering linearly.

    Attributes:
        coefficients: names and units of the c_j.
        basis: φ (n, m) of extension e [m], rest length L [m] and exponent [1].
        needs_length: whether L shapes the curve.
        exponents: bounds of the exponent of Ogden's law.
        source: publication of the law.
    """

    name: str
    coefficients: tuple[tuple[str, str], ...]
    basis: Callable[[Floats, float, float], Floats]
    needs_length: bool = False
    exponents: tuple[float, float] | None = None
    source: str = ""

    def count(self, gauge: float | None) -> int:
        """Count of the fitted numbers; the rest length is one if the gauge is unknown."""
        length = self.needs_length and gauge is None
        return len(self.coefficients) + 1 + length + (self.exponents is not None)


@dataclass(frozen=True, eq=False)
class Fitted(ByValue):
    """A fitted law.

    Attributes:
        onset: stroke at which its tension is zero [m].
        length: rest length L that shapes the curve [m]; NaN for laws without it.
        exponent: Ogden's α; NaN for other laws.
        coefficients: (m,) in the units of the law.
        rmse: root mean square of the residuals [N].
        at_bound: numbers at a bound of the search, which the data do not identify.
    """

    law: ForceLaw
    onset: float
    length: float
    exponent: float
    coefficients: Floats
    rmse: float
    at_bound: tuple[str, ...] = ()

    def tension(self, stroke: Floats) -> Floats:
        """Tension [N] at strokes [m]; zero before the onset."""
        e = np.maximum(np.asarray(stroke, float) - self.onset, 0.0)
        return self.law.basis(e, self.length, self.exponent) @ self.coefficients

    def slopes(self, stroke: Floats, gauge: float | None) -> Floats:
        """Derivatives (n, m) of the tension with respect to the fitted numbers, the onset first.

        Strokes (n,) [m] are beyond the onset. `gauge` is the length of the band at stroke 0 [m], if
        known. Numbers at their bounds are left out.
        """
        e, length, exponent, basis = stroke - self.onset, self.length, self.exponent, self.law.basis
        base, c, step = basis(e, length, exponent), self.coefficients, 1e-6 * float(np.ptp(stroke))
        moved = [basis(e - step, length if gauge is None else length + step, exponent)]
        if self.law.needs_length and gauge is None and "rest length [m]" not in self.at_bound:
            moved.append(basis(e, length + step, exponent))
        if self.law.exponents is not None and "exponent [1]" not in self.at_bound:
            moved.append(basis(e, length, exponent + step))
        return np.stack([*((m @ c - base @ c) / step for m in moved), *base.T], axis=1)

    @property
    def values(self) -> dict[str, float]:
        """Fitted numbers in SI, by name with unit."""
        values = {"onset [m]": self.onset}
        if self.law.needs_length:
            values["rest length [m]"] = self.length
        if self.law.exponents is not None:
            values["exponent [1]"] = self.exponent
        names = (f"{name} [{unit}]" for name, unit in self.law.coefficients)
        return values | dict(zip(names, self.coefficients.tolist(), strict=True))

    def __repr__(self):
        numbers = ", ".join(f"{name} {value:.4g}" for name, value in self.values.items())
        return f"Fitted({self.law.name}: {numbers}; leaves {to_unit(self.rmse, 'mN'):.3g} mN)"


def fit(law: ForceLaw, stroke: Floats, force: Floats, gauge: float | None = None) -> Fitted:
    """Least-squares fit of a law to a tension curve.

    Only onset, length and exponent are searched. The coefficients follow from a linear problem
    (variable projection, Golub and Pereyra 1973).

    Args:
        law: one of LAWS.
        stroke, force: (n,) [m], [N].
        gauge: length of the band at stroke 0 [m], if known.

    Raises:
        ValueError: there are fewer samples than numbers of the law.
    """
    from scipy.optimize import least_squares

    stroke, force = np.asarray(stroke, float), np.asarray(force, float)
    if len(stroke) < law.count(gauge):
        raise InputError(
            f"{len(stroke)} samples for the {law.count(gauge)} numbers of the {law.name} law: "
            f"must be at least as many."
        )
    # A law is zero up to its onset, so nearly all data must be beyond it.
    latest = float(np.min(stroke)) + _SLACK * float(np.ptp(stroke))
    if len(stroke) > 1 and force[0] <= _SLACK_FORCE * float(np.max(force)):
        # After a first reading without load, the onset may be anywhere up to the next one.
        latest = max(latest, float(stroke[0] + _NEXT * (stroke[1] - stroke[0])))
    earliest = latest - _ONSET if gauge is None else _LENGTH[0] - gauge
    # Bounds of the search, and starts as fractions of the range.
    searched = {"onset [m]": (min(earliest, latest - _LENGTH[0]), latest, (0.3, 0.9))}
    if law.needs_length and gauge is None:
        searched["rest length [m]"] = (*_LENGTH, (0.05, 0.3))
    if law.exponents is not None:
        searched["exponent [1]"] = (*law.exponents, (0.2, 0.7))
    low, high = (np.array([row[k] for row in searched.values()]) for k in (0, 1))
    starts = product(*(row[2] for row in searched.values()))

    def fitted(x: Floats) -> Fitted:
        onset = float(x[0])
        exponent = np.nan if law.exponents is None else float(x[-1])
        length = np.nan
        if law.needs_length:
            length = max(gauge + onset, _LENGTH[0]) if gauge is not None else float(x[1])
        basis = law.basis(np.maximum(stroke - onset, 0.0), length, exponent)
        scale = np.linalg.norm(basis, axis=0)
        scale[scale == 0] = 1.0
        coefficients = np.linalg.lstsq(basis / scale, force, rcond=1e-10)[0] / scale
        rmse = rms(basis @ coefficients - force)
        return Fitted(law, onset, length, exponent, coefficients, rmse)

    def residual(x: Floats) -> Floats:
        return fitted(x).tension(stroke) - force

    span = high - low
    tries = [
        least_squares(residual, low + span * start, bounds=(low, high), x_scale=span, xtol=1e-9)
        for start in starts
    ]
    x = min(tries, key=lambda solution: solution.cost).x
    edge = np.minimum(x - low, high - x) < _EDGE * span
    return replace(fitted(x), at_bound=tuple(np.array(list(searched))[edge].tolist()))


def _neo_hooke(e: Floats, length: float, _: float) -> Floats:
    x = 1.0 + e / length
    return (x - x**-2)[:, None]


def _yeoh(e: Floats, length: float, _: float) -> Floats:
    x = 1.0 + e / length
    over = x**2 + 2 / x - 3  # I1 - 3 in uniaxial tension
    return np.stack([(x - x**-2) * over**j for j in range(3)], axis=1)


def _ogden(e: Floats, length: float, exponent: float) -> Floats:
    x = 1.0 + e / length
    return (x ** (exponent - 1) - x ** (-exponent / 2 - 1))[:, None]


_AREA = (("modulus times area", "N"),)
LAWS: tuple[ForceLaw, ...] = (
    ForceLaw("linear", (("stiffness", "N/m"),), lambda e, _l, _a: e[:, None], source="Hooke's law"),
    ForceLaw("neo-Hookean", _AREA, _neo_hooke, needs_length=True, source="Treloar 1943"),
    ForceLaw(
        "cubic",
        (("stiffness", "N/m"), ("quadratic", "N/m²"), ("cubic", "N/m³")),
        lambda e, _l, _a: np.stack([e, e**2, e**3], axis=1),
        source="a polynomial",
    ),
    ForceLaw("Ogden", _AREA, _ogden, True, exponents=(1.01, 12.0), source="Ogden 1972, one term"),
    ForceLaw(
        "Yeoh",
        (("first modulus", "N"), ("second modulus", "N"), ("third modulus", "N")),
        _yeoh,
        needs_length=True,
        source="Yeoh 1993",
    ),
)
