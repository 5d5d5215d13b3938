"""One physical model of rubber and rig fitted to every unit cell at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stepwell.base import ByValue, Drawn, Floats, brief, need, record
from stepwell.lab.bands import student
from stepwell.lab.mechanisms import (
    ERROR,
    PARAMETER,
    TIED,
    Geometry,
    Series,
    correlations,
    over_geometries,
)
from stepwell.lab.recordings import LabError, rms
from stepwell.mechanism import Band, Cell, Cubic, band_force, cubic, length_slopes

if TYPE_CHECKING:
    import xarray as xr


_POINTS = 60
# What is fitted: unit, start, bounds and typical size. Stiffness has one for each number of bands.
_FITTED = {
    "stiffness": ("N/m", 40.0, 0.1, 1e4, 10.0),
    "rest_length": ("m", 0.010, 0.0, 0.1, 0.005),
    "quadratic": ("1/m", 0.0, -1e3, 1e3, 20.0),
    "cubic": ("1/m²", 0.0, -1e6, 1e6, 500.0),
    "loss": ("1", 0.1, 0.0, 0.95, 0.1),
    "loss_length": ("m", 0.003, 1e-4, 0.1, 0.003),
    "friction": ("N", 0.0, -1.0, 1.0, 0.02),
}
LAWS = {"linear": (), "cubic": ("quadratic", "cubic")}
_FEW = 3


@dataclass(frozen=True, eq=False)
class FittedParameter(ByValue):
    """A fitted number with its interval.

    Attributes:
        name, unit: what it is; `stiffness_2` belongs to cells with two bands.
        value: the fit to all geometries.
        low, high: 95 % interval, by leaving out one geometry after the other.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float

    def __repr__(self):
        return (
            f"FittedParameter({self.name} {self.value:.4g}, 95 % {self.low:.4g} to {self.high:.4g} "
            f"{self.unit})"
        )


@dataclass(frozen=True, eq=False)
class Sample(ByValue):
    """A series made ready for the fit: F of the block on even travels, in the order of motion."""

    name: str
    geometry: Geometry
    bands: int
    cell: Cell = field(repr=False)
    theta: Floats = field(repr=False)
    force: Floats = field(repr=False)
    unloading: bool

    def __repr__(self):
        return brief(self)


@dataclass(frozen=True, eq=False)
class Calibration(ByValue, Drawn):
    """The model that fits all unit cells best, and how well it predicts one that it has not seen.

    Attributes:
        law: "linear" or "cubic".
        parameters: every number with its interval.
        samples: the series, one for each geometry, number of bands and direction.
        fit_error, left_out_error: for each sample RMSE in k r, fitted and predicted from the other
            geometries; k r is that of `reference` and the number of bands.
        correlations: (m, m) of the parameters, from the Jacobian of the fit.
        reference: stiffness of one band by which errors are scaled [N/m].
    """

    law: str
    parameters: tuple[FittedParameter, ...]
    samples: tuple[Sample, ...] = field(repr=False)
    fit_error: Floats = field(repr=False)
    left_out_error: Floats = field(repr=False)
    correlations: Floats = field(repr=False)
    reference: float

    def __getitem__(self, name: str) -> FittedParameter:
        found = {parameter.name: parameter for parameter in self.parameters}
        if name not in found:
            raise KeyError(f"{name!r}: must be one of {', '.join(found)}.")
        return found[name]

    @property
    def values(self) -> dict[str, float]:
        """The fit to all geometries: every number by its name."""
        return {parameter.name: parameter.value for parameter in self.parameters}

    @property
    def counts(self) -> tuple[int, ...]:
        """The numbers of bands there are."""
        return tuple(sorted({sample.bands for sample in self.samples}))

    def mean_error(self, bands: int, left_out: bool = True) -> float:
        """Mean over the geometries of the RMSE in k r, for cells with so many bands.

        Args:
            bands: 1, 2, ...
            left_out: each geometry predicted from the others; False for the fit.
        """
        errors = self.left_out_error if left_out else self.fit_error
        return over_geometries(
            (sample.geometry, float(error))
            for sample, error in zip(self.samples, errors, strict=True)
            if sample.bands == bands
        )

    @property
    def tied(self) -> tuple[tuple[str, str, float], ...]:
        """Pairs of numbers that the data cannot tell apart, with their correlation."""
        names = list(self.values)
        tied = np.argwhere(np.tril(np.abs(self.correlations) > TIED, -1))
        return tuple((names[j], names[i], float(self.correlations[i, j])) for i, j in tied)

    def band(self, bands: int = 1) -> Band:
        """A band of a cell with so many, as it loads; anchors at their defaults.

        The loss on the way back is not in it: a band of a mechanism has one law.
        """
        values = self.values
        law = Cubic(values.get("quadratic", 0.0), values.get("cubic", 0.0))
        stiffness = self[f"stiffness_{bands}"].value
        band = Band((-0.010, 0.0), (0.010, 0.0), stiffness, values["rest_length"])
        return replace(band, law=law) if law.a2 or law.a3 else band

    def force(self, sample: Sample) -> Floats:
        """F of the model [N] at the angles of a sample."""
        return _force(self.values, sample)

    def to_xarray(self) -> xr.Dataset:
        """Errors over "series" and correlations over "parameter" and "other"."""
        need("tables")
        import xarray as xr

        names = list(self.values)
        return xr.Dataset(
            {
                "fit_error": ("series", self.fit_error, {"units": "k r"}),
                "left_out_error": ("series", self.left_out_error, {"units": "k r"}),
                "bands": ("series", [s.bands for s in self.samples], {"units": "1"}),
                "value": ("parameter", list(self.values.values())),
                "low": ("parameter", [p.low for p in self.parameters]),
                "high": ("parameter", [p.high for p in self.parameters]),
                "correlation": (("parameter", "other"), self.correlations, {"units": "1"}),
            },
            {"series": [s.name for s in self.samples], "parameter": names, "other": names},
            {"law": self.law, "k_N_per_m": self.reference},
        )

    def __repr__(self):
        errors = ", ".join(f"{n}: {self.mean_error(n):.3f}" for n in self.counts)
        return f"Calibration({self.law}, left-out error in k r by bands {errors})"


def prepare(series: Sequence[Series]) -> tuple[Sample, ...]:
    """Net forces of unit cells on even travels, in the order of motion.

    Args:
        series: any; those of two cells are left out.

    Returns:
        A sample for each series of one cell.
    """
    return tuple(_sample(one) for one in series if len(one.chain) == 1)


def calibrate(
    samples: Sequence[Sample],
    law: str | None = None,
    *,
    reference: float = 28.5,
    progress: Callable[[int, int], None] | None = None,
) -> Calibration:
    """Fit band law, loss and friction to all unit cells, and predict each geometry left out.

    Tension while a band gets longer than ever before in the stroke is T(ℓ) = k (e + a2 e² + a3 e³),
    e = ℓ - ℓ0; once it is shorter by x than it has been, it is less by the share h (1 - exp(-x/c)).
    Bands of cells with one and with two bands are other pieces of rubber, and have a stiffness
    each; all else is shared. Friction is what is left beyond the baseline, against the motion.

    Geometries that share d = q - p are one fold, with all their bands and directions, because the
    model knows of d alone. Intervals are those of the jackknife over geometries: residuals along
    a stroke are no independent samples, geometries nearly are.

    Args:
        samples: of three geometries or more.
        law: "linear" (a2 = a3 = 0) or "cubic"; by default the one that predicts the geometries
            left out better.
        reference: stiffness of one band by which errors are scaled [N/m].
        progress: called with (done, total) fits.

    Returns:
        The calibration.

    Raises:
        LabError: fewer than three geometries, or a law that is not known.

    Source: delete-one-group jackknife, Quenouille 1956, Tukey 1958.
    """
    if law is None:
        found = [calibrate(samples, name, reference=reference, progress=progress) for name in LAWS]
        return min(found, key=lambda c: float(np.mean(c.left_out_error)))
    if law not in LAWS:
        raise LabError("law", f"{law!r}: must be one of {', '.join(LAWS)}.")
    geometries = sorted({sample.geometry for sample in samples})
    if len(geometries) < _FEW:
        raise LabError(
            "data",
            f"unit cells of {len(geometries)} different q - p: calibration needs {_FEW} or more, "
            f"to predict each from the others.",
        )
    counts = sorted({sample.bands for sample in samples})
    stiffness = [f"stiffness_{n}" for n in counts]
    names = [*stiffness, "rest_length", *LAWS[law], "loss", "loss_length", "friction"]
    whole, jacobian = _fit(samples, names, None)
    folds: dict[Geometry, Floats] = {}
    for geometry in geometries:
        others = [sample for sample in samples if sample.geometry != geometry]
        folds[geometry], _ = _fit(others, names, whole)
        if progress is not None:
            progress(len(folds), len(geometries))
    n, each = len(folds), np.array(list(folds.values()))
    scatter = np.sum((each - np.mean(each, axis=0)) ** 2, axis=0)
    wide = student(n - 1) * np.sqrt((n - 1) / n * scatter)

    def error(values: Floats, sample: Sample) -> float:
        gap = _force(dict(zip(names, values, strict=True)), sample) - sample.force
        return rms(gap / (sample.bands * reference * sample.cell.lever))

    return Calibration(
        law,
        tuple(
            FittedParameter(name, _FITTED[name.rstrip("_0123456789")][0], *map(float, row))
            for name, *row in zip(names, whole, whole - wide, whole + wide, strict=True)
        ),
        tuple(samples),
        np.array([error(whole, sample) for sample in samples]),
        np.array([error(folds[sample.geometry], sample) for sample in samples]),
        correlations(jacobian),
        reference,
    )


def fit_record(calibration: Calibration) -> dict[str, Any]:
    """The calibration as JSON can hold it; docs/commands.md describes the names."""
    names = list(calibration.values)
    errors = calibration.fit_error, calibration.left_out_error
    return {
        "law": calibration.law,
        "k_N_per_m": calibration.reference,
        "parameters": [record(PARAMETER, p) for p in calibration.parameters],
        "errors": [
            record(ERROR, sample, fit=fit, left_out=out)
            for sample, fit, out in zip(calibration.samples, *errors, strict=True)
        ],
        "mean_errors": [
            {
                "bands": n,
                "fit_over_kr": calibration.mean_error(n, left_out=False),
                "left_out_over_kr": calibration.mean_error(n),
            }
            for n in calibration.counts
        ],
        "correlations": {
            name: dict(zip(names, row.tolist(), strict=True))
            for name, row in zip(names, calibration.correlations, strict=True)
        },
        "not_told_apart": [list(pair) for pair in calibration.tied],
    }


def _sample(series: Series) -> Sample:
    cell, curve, use = series.chain.levers[0], series.curve, series.judged()
    stroke, net = curve.stroke[use], series.net(curve.stroke, curve.force)[use]
    # Means over strips: what is fitted is the curve, not the noise of single samples.
    travel, force = (
        np.array([float(np.mean(part)) for part in np.array_split(values, _POINTS) if len(part)])
        for values in (stroke, net)
    )
    if series.unloading:
        travel, force = travel[::-1], force[::-1]
    return Sample(
        series.name,
        series.geometry,
        series.bands,
        cell,
        cell.angle(travel),
        force,
        series.unloading,
    )


class _Rows(NamedTuple):
    """What does not depend on the numbers that are fitted, all samples in a row."""

    length: Floats  # of the band [m]
    slope: Floats  # of the length by travel [1]
    shorter: Floats  # than it has been in this run [m]
    bands: Floats
    direction: Floats  # +1 loading, -1 unloading
    force: Floats


def _rows(samples: Sequence[Sample]) -> _Rows:
    parts: list[tuple[Floats, ...]] = []
    for sample in samples:
        lever, limit, theta = sample.cell.lever, sample.cell.limit, sample.theta
        dx, dy = sample.geometry
        band = Band((0.0, 0.0), (dx, dy))
        # The band was taut at the stop where the run began.
        start = limit if sample.unloading else -limit
        length = band.length(np.concatenate([[start], theta]), lever)
        shorter = (np.maximum.accumulate(length) - length)[1:]
        slope, _, _ = length_slopes(np.sin(theta), np.cos(theta), length[1:], dx, dy, lever)
        one = np.ones(len(theta))
        direction = -one if sample.unloading else one
        parts.append((length[1:], slope, shorter, sample.bands * one, direction, sample.force))
    return _Rows(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _model(values: dict[str, float], rows: _Rows) -> Floats:
    """F of every row [N]; the tension is `Band.tension` written out, for speed."""
    e = np.maximum(rows.length - values["rest_length"], 0.0)
    shape = cubic(e, 0.0, 1.0, values.get("quadratic", 0.0), values.get("cubic", 0.0))[0]
    k = np.zeros(len(e))
    for name, value in values.items():
        if name.startswith("stiffness_"):
            k[rows.bands == float(name.removeprefix("stiffness_"))] = value
    kept = 1.0 - values["loss"] * (1.0 - np.exp(-rows.shorter / values["loss_length"]))
    tension = rows.bands * k * shape * kept
    return band_force(tension, rows.slope) + rows.direction * values["friction"]


def _force(values: dict[str, float], sample: Sample) -> Floats:
    return _model(values, _rows([sample]))


def _fit(
    samples: Sequence[Sample], names: list[str], start: Floats | None
) -> tuple[Floats, Floats]:
    """Values of the parameters, and the Jacobian by their typical sizes."""
    from scipy.optimize import least_squares

    limits = np.array([_FITTED[name.rstrip("_0123456789")][1:] for name in names])
    first, low, high, size = limits.T
    data = _rows(samples)

    def residual(x: Floats) -> Floats:
        # Per band, so that double bands do not count double.
        return (_model(dict(zip(names, x, strict=True)), data) - data.force) / data.bands

    inside = np.clip(first if start is None else start, low + 1e-9 * size, high - 1e-9 * size)
    found = least_squares(
        residual, inside, bounds=(low, high), x_scale=size, xtol=1e-10, ftol=1e-10
    )
    return found.x, found.jac * size
