"""One physical model of rubber and rig fitted to all cells at once, single and in pairs."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stepwell.base import ByValue, Drawn, Floats, grouped, need, notify
from stepwell.lab import comparison, fit_model
from stepwell.lab.bands.choice import independent
from stepwell.lab.bands.halves import student
from stepwell.lab.fit_samples import (
    Prepared,
    Sample,
    TensionCurve,
    Weighing,
    handovers,
    measured_law,
    rubber_name,
    tension_curve,
    weigh,
)
from stepwell.lab.pair_test import PairTest
from stepwell.lab.recordings.curve import rms
from stepwell.lab.recordings.recording import LabError
from stepwell.lab.rig import Rig
from stepwell.lab.series import Geometry, Series, geometry_of, over_geometries
from stepwell.mechanism import Band, Cell, Chain, Law

if TYPE_CHECKING:
    import xarray as xr


_FEW = 3
# Weight of a handover's stroke against forces [N/m]: a handover is known to 0.1 mm, a force of one
# band to about 0.02 N, and a sample has one handover but many forces.
_HANDOVER = 200.0
_STROKE = 0.05e-3  # uncertainty of a recorded stroke [m]
_WHOLE = 0.05  # tolerance of a whole number of bands
_LATE = 4  # the last quarter of the used travel
_NARROW = 0.5  # half width of the interval of an identified parameter, over its value


@dataclass(frozen=True, eq=False)
class FittedParameter(ByValue):
    """A fitted number; `stiffness_2`, for one, belongs to cells with two bands.

    Attributes:
        value: from the fit to all geometries.
        low, high: 95 % interval, by leaving out one geometry in turn.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float

    @property
    def known(self) -> bool:
        """Whether its interval is narrow: at most half of the value to either side."""
        return (self.high - self.low) / 2.0 <= _NARROW * abs(self.value)

    def __repr__(self):
        return (
            f"FittedParameter({self.name} {self.value:.4g}, 95 % {self.low:.4g} to {self.high:.4g} "
            f"{self.unit})"
        )


class Correlated(NamedTuple):
    """Two parameters that the data do not identify separately, and their correlation."""

    parameter: str
    other: str
    correlation: float


@dataclass(frozen=True, eq=False)
class Calibration(ByValue, Drawn):
    """The model that fits all cells best, and its prediction errors for left-out geometries.

    Attributes:
        law: "linear", "cubic", or the name of a table.
        samples: the fitted data: each cell that moves in a series, in one direction.
        fit_error, left_out_error: RMSE of each sample in k r, fitted and predicted from the other
            geometries; k is `reference` times the number of bands.
        correlations: (m, m) of the parameters, from the Jacobian of the fit.
        reference: stiffness of one band by which errors are scaled [N/m].
        shape: the fitted law of a band.
        tensions: of a band of each kind, at the lengths in the data.
        weighing: results of runs of pairs without bands.
        compliance: of the rig [m/N]; NaN where no pair identifies it.
        pairs, snaps: series of pairs with their model without a fit; their predicted snaps.
        notes: recordings that were used or dropped, and irregularities, a line each.
    """

    law: str
    parameters: tuple[FittedParameter, ...]
    samples: tuple[Sample, ...] = field(repr=False)
    fit_error: Floats = field(repr=False)
    left_out_error: Floats = field(repr=False)
    correlations: Floats = field(repr=False)
    reference: float
    shape: Law = field(repr=False)
    weighing: Weighing | None = None
    compliance: float = math.nan
    snaps: tuple[fit_model.SnapPrediction, ...] = field(repr=False, default=())
    pairs: tuple[PairTest, ...] = field(repr=False, default=())
    notes: tuple[str, ...] = field(repr=False, default=())
    tensions: tuple[TensionCurve, ...] = field(repr=False, default=())

    def __getitem__(self, name: str) -> FittedParameter:
        by_name = {parameter.name: parameter for parameter in self.parameters}
        if name not in by_name:
            raise KeyError(f"{name!r}: must be one of {', '.join(by_name)}.")
        return by_name[name]

    @property
    def values(self) -> dict[str, float]:
        """Fitted values by name, from the fit to all geometries."""
        return {parameter.name: parameter.value for parameter in self.parameters}

    @property
    def kinds(self) -> tuple[tuple[int, bool], ...]:
        """Kinds of samples: number of bands, and whether in pairs."""
        return tuple(sorted({(s.bands, s.in_pair) for s in self.samples}, key=lambda k: k[::-1]))

    def mean_error(self, bands: int, in_pair: bool = False, left_out: bool = True) -> float:
        """Mean over the geometries of the RMSE in k r, for cells with this number of bands.

        Args:
            bands: 1, 2, ...
            in_pair: cells in pairs; False for single cells.
            left_out: error of each geometry predicted from the others; False for the fit.
        """
        errors = self.left_out_error if left_out else self.fit_error
        return over_geometries(
            (sample.geometry, float(error))
            for sample, error in zip(self.samples, errors, strict=True)
            if sample.bands == bands and sample.in_pair == in_pair
        )

    @property
    def tied(self) -> tuple[Correlated, ...]:
        """Pairs of parameters that the data do not identify separately."""
        names = list(self.values)
        tied = np.argwhere(np.tril(np.abs(self.correlations) > comparison.TIED, -1))
        return tuple(
            Correlated(names[j], names[i], float(self.correlations[i, j])) for i, j in tied
        )

    @property
    def unknown(self) -> tuple[str, ...]:
        """Names of stiffnesses and of numbers of the law that the data do not identify."""
        names = {"rest_length", *fit_model.LAWS.get(self.law, ())}
        return tuple(
            one.name
            for one in self.parameters
            if (one.name in names or one.name.startswith("stiffness")) and not one.known
        )

    @cached_property
    def written(self) -> Law:
        """The law for a design: a table over the lengths in the data if its numbers are unknown."""
        if not self.unknown or not self.tensions:
            return self.shape
        return measured_law(self.shape, self["rest_length"].value, self.tensions)

    @property
    def missing(self) -> str:
        """Why no band can be written; "" if the tension of every band is known."""
        wide = [one for one in self.tensions if not one.known]
        if not wide:
            return ""
        worst = max(wide, key=lambda one: one.width)
        return (
            f"the tension of {worst.rubber.removeprefix('stiffness_')} is known to ±"
            f"{worst.width:.0%} only (95 %): add tension tests of the bands or other geometries"
        )

    def band(self, bands: int = 1, in_pair: bool = False) -> Band:
        """Loading law of one band on a cell with this number of bands, without hysteresis loss."""
        k = self[rubber_name(bands, in_pair)].value
        return Band((-0.010, 0.0), (0.010, 0.0), k, self["rest_length"].value, self.written)

    def applied(self, chain: Chain, bands: int | None = None) -> Chain:
        """A chain with the calibrated bands, and with weight and friction where they are known.

        The stiffness is that of the test with the nearest number of bands. It is taken from pairs
        if pairs were tested and the chain has two cells or more. Rest length and law are shared.
        Every cell but the outermost carries the block beyond it.

        Args:
            chain: of cells; anchors, levers and stops are kept.
            bands: number on each cell; by default its stiffness over that of the softest band.

        Raises:
            LabError: the chain has elements, the stiffness of a cell is no whole multiple of one
                band's, or the tension of the bands is not known.
        """
        if chain.elements:
            name = chain.elements[0].name or "its first cell"
            raise LabError("design", f"{name} is an element: it has no bands to calibrate.")
        if self.missing:
            raise LabError("calibration", f"{self.missing}.")
        kinds = [kind for kind in self.kinds if kind[1] == (len(chain) > 1)] or list(self.kinds)
        softest = min(band.stiffness for cell in chain.levers for band in cell.bands)

        def stiffness(cell: Cell) -> float:
            ratio = sum(band.stiffness for band in cell.bands) / softest
            if bands is None and abs(ratio - round(ratio)) > _WHOLE:
                raise LabError(
                    "design",
                    f"its bands are not of one kind: a cell has {ratio:.3g} times the stiffness of "
                    f"the softest band ({softest:.4g} N/m). Recordings of one kind apply to whole "
                    f"numbers of bands only: give each cell a whole multiple of it.",
                )
            count = round(ratio) if bands is None else bands
            nearest = min(kinds, key=lambda kind: abs(kind[0] - count))
            return count * self.band(*nearest).stiffness

        return replace(self._model, law=self.written).applied(chain, stiffness)

    def pair(self) -> Chain:
        """The first pair that was tested, with as many calibrated bands on each cell.

        Raises:
            LabError: no pair was tested, or the tension of the bands is not known.
        """
        if not self.pairs:
            raise LabError("calibration", "no pair was tested.")
        count = self.pairs[0].series.bands
        chain = self.applied(self.pairs[0].series.chain, count)
        if count == 1 or any(len(cell.bands) > 1 for cell in chain.levers):
            return chain

        def each(band: Band) -> list[Band]:
            return [replace(band, stiffness=band.stiffness / count)] * count

        return replace(chain, cells=[replace(c, band=each(c.bands[0])) for c in chain.levers])

    @property
    def weight(self) -> float:
        """Weight of the block between two cells [N]; 0 if it was not measured."""
        return self._model.weight

    @property
    def rig(self) -> Rig:
        """The rig on which the pairs were tested; the nominal rig without pairs."""
        return self._model.rig

    @property
    def joints(self) -> float:
        """Friction in the joints over the tension of the bands [1]; 0 if it was not identified."""
        return self.values.get("joints", 0.0)

    def tension(self, bands: int) -> float:
        """Tension of these bands in a cell of a pair, at mid-travel with d = (20, 0) mm [N]."""
        band, lever = self.band(bands, in_pair=True), self.samples[0].cell.lever
        return bands * float(band.tension(band.length(0.0, lever)))

    @property
    def _model(self) -> fit_model.Model:
        compliance = 0.0 if math.isnan(self.compliance) else self.compliance
        return fit_model.Model(self.values, self.shape, self.weighing, compliance)

    def force(self, sample: Sample) -> Floats:
        """Force F of the model [N] along a sample."""
        return self._model.force(sample)

    def snap_error(self, name: str = "left_out") -> float:
        """Mean distance between measured and predicted snaps [m]; NaN for none.

        `name` is "plain", "fitted" or "left_out", as in `SnapPrediction`.
        """
        gaps = [abs(getattr(one, name) - one.measured) for one in self.snaps]
        known = [gap for gap in gaps if not math.isnan(gap)]
        return float(np.mean(known)) if known else math.nan

    @property
    def orders(self) -> tuple[int, int]:
        """Number of series of pairs whose order is predicted right from the others, and of all."""
        return sum(one.order == one.order_seen for one in self.snaps), len(self.snaps)

    @property
    def scatter(self) -> float:
        """Relative standard deviation of the strength of bands between series.

        Each series is scaled separately to the common model; NaN for fewer than three series.
        """
        forces = [(sample.force, self.force(sample)) for sample in self.samples]
        scales = [float(model @ force) / float(model @ model) for force, model in forces]
        return float(np.std(scales, ddof=1)) if len(scales) >= _FEW else math.nan

    @property
    def open(self) -> list[str]:
        """Quantities that these recordings do not identify, and the experiment that would."""
        ways = {(sample.in_pair, sample.unloading) for sample in self.samples}
        pairs = sum(in_pair for in_pair, _ in ways)
        unknown = {
            "the loss of the rubber and friction in the joints: test cells in loading and "
            "unloading to separate them": len(ways) - pairs == 1 and pairs < 2,
            "friction of the machine and in the joints: test pairs in loading and unloading, "
            "with one band and with two, to separate them at mid-travel": pairs == 1,
            "the weight of the block between the cells, assumed zero: record the pair without "
            "a band, loading and unloading": pairs > 0 and self.weighing is None,
            "weight and friction, which is assumed equal for both cells: record runs without a "
            "band in the other direction to separate them": not (
                self.weighing is None or self.weighing.both
            ),
            "friction in the joints and recovery of the rubber at a stop, which both delay a "
            "snap: record a run that waits a minute before the snap to separate them": (pairs == 2),
        }
        return [line for line, holds in unknown.items() if holds]

    @property
    def coverage(self) -> tuple[int, int]:
        """Number of series of pairs whose 90 % interval contains the measured snap, and of all."""
        covered = [one.covered for one in self.snaps if one.covered is not None]
        return sum(covered), len(covered)

    def to_xarray(self) -> "xr.Dataset":
        """Dataset of errors over "series" and correlations over "parameter" and "other"."""
        need("tables")
        import xarray as xr

        names = list(self.values)
        return xr.Dataset(
            {
                "fit_error": ("series", self.fit_error, {"units": "k r"}),
                "left_out_error": ("series", self.left_out_error, {"units": "k r"}),
                "bands": ("series", [s.bands for s in self.samples], {"units": "1"}),
                "in_pair": ("series", [s.in_pair for s in self.samples]),
                "value": ("parameter", list(self.values.values())),
                "low": ("parameter", [p.low for p in self.parameters]),
                "high": ("parameter", [p.high for p in self.parameters]),
                "correlation": (("parameter", "other"), self.correlations, {"units": "1"}),
            },
            {"series": [s.name for s in self.samples], "parameter": names, "other": names},
            {"law": self.law, "k_N_per_m": self.reference},
        )

    def __repr__(self):
        errors = ", ".join(
            f"{n}{' in pairs' * pair}: {self.mean_error(n, pair):.3f}" for n, pair in self.kinds
        )
        return f"Calibration({self.law}, left-out error in k r by bands {errors})"


def calibrate(
    data: Prepared,
    law: str | None = None,
    *,
    reference: float = 28.5,
    progress: Callable[[int, int], None] | None = None,
) -> Calibration:
    """Fit band law, loss, friction and rig to the curves of all cells, single and in pairs.

    While a band is longer than at any time before, its tension is T(l) = k (e + a2 e² + a3 e³),
    e = l - l0, or k times a table. When it is shorter than its maximum by x, its tension is lower
    by the fraction h (1 - exp(-x/c)). Bands tested together share one stiffness, and all bands
    share the other numbers. Friction beyond the baseline acts against the motion. For pairs that
    were loaded and unloaded, a fraction of the tension is added to it. Snaps are not used in the
    fit. They are predicted afterwards with the loading law, because rubber recovers at a stop.

    Geometries with the same d = q - p of the outermost cell are one fold, with all their bands and
    directions. Intervals are those of the jackknife over geometries: residuals along a stroke are
    not independent, geometries nearly are.

    Args:
        data: samples of three geometries or more.
        law: "linear" (a2 = a3 = 0), "cubic", or the name of one of the tables of `data`; by
            default the law that predicts left-out geometries best.
        reference: stiffness of one band by which errors are scaled [N/m].
        progress: called with (done, total) fits.

    Raises:
        LabError: fewer than three geometries, or an unknown law.

    Source: delete-one-group jackknife, Quenouille 1956, Tukey 1958.
    """
    known = [*fit_model.LAWS, *data.tables]
    if law is not None and law not in known:
        raise LabError("law", f"{law!r}: must be one of {', '.join(known)}.")
    folds = sorted({sample.fold for sample in data.samples})
    if len(folds) < _FEW:
        raise LabError(
            "data",
            f"unit cells of {len(folds)} different q - p: calibration needs {_FEW} or more, "
            f"to predict each from the others. Add recordings of other geometries.",
        )
    each = [one.compliance for test in data.pairs for one in handovers(test)]
    compliance = float(np.median(each)) if each else math.nan
    laws, stiff = known if law is None else [law], compliance if each else 0.0
    weighing = weigh(data.pairs)
    fits = [_Fit(data, name, stiff, weighing, reference) for name in laws]
    for done, (fit, fold) in enumerate(product(fits, folds), 1):
        fit.leave_out(fold)
        notify(progress, done, len(laws) * len(folds))
    best = min(fits, key=lambda one: float(np.mean(one.errors[1])))
    return Calibration(
        best.law,
        best.parameters(),
        data.samples,
        *best.errors,
        comparison.correlations(best.jacobian),
        reference,
        best.model(best.whole).law,
        weighing,
        compliance,
        tuple(map(best.predict, data.pairs)),
        data.pairs,
        data.notes,
        best.tensions(),
    )


class _Fit:
    """Fit of one law to all samples, and to all but one geometry."""

    def __init__(
        self, data: Prepared, law: str, rig: float, weighing: Weighing | None, reference: float
    ):
        self.data, self.law, self.compliance, self.weighing = data, law, rig, weighing
        self.reference = reference
        self.names = fit_model.numbers_of(data.samples, law)
        self.left: dict[Geometry, Floats] = {}
        self.whole, self.jacobian = self._fitted(data.samples, None)

    def leave_out(self, fold: Geometry) -> None:
        kept = [sample for sample in self.data.samples if sample.fold != fold]
        self.left[fold], _ = self._fitted(kept, self.whole)

    def model(self, numbers: Floats) -> fit_model.Model:
        values = dict(zip(self.names, numbers.tolist(), strict=True))
        law = fit_model.law_of(self.law, values, self.data.tables)
        return fit_model.Model(values, law, self.weighing, self.compliance)

    @cached_property
    def errors(self) -> tuple[Floats, Floats]:
        """RMSE of each sample in k r, fitted and left out."""

        def rmse(sample: Sample, numbers: Floats) -> float:
            return rms(self.model(numbers).force(sample) - sample.force) / self._scale(sample)

        fitted = np.array([rmse(one, self.whole) for one in self.data.samples])
        return fitted, np.array([rmse(one, self.left[one.fold]) for one in self.data.samples])

    def _scale(self, sample: Sample) -> float:
        return sample.bands * self.reference * sample.cell.lever

    def parameters(self) -> tuple[FittedParameter, ...]:
        n, each = len(self.left), np.array(list(self.left.values()))
        scatter = np.sum((each - np.mean(each, axis=0)) ** 2, axis=0)
        wide = student(n - 1) * np.sqrt((n - 1) / n * scatter)
        units = [fit_model.number(name).unit for name in self.names]
        values = (one.tolist() for one in (self.whole, self.whole - wide, self.whole + wide))
        return tuple(map(FittedParameter, self.names, units, *values))

    def tensions(self) -> tuple[TensionCurve, ...]:
        """Tension of one band of each kind at the lengths in its data."""

        def tension(numbers: Floats, rubber: str) -> Callable[[Floats], Floats]:
            model = self.model(numbers)
            rest, k = model.values["rest_length"], model.values[rubber]
            return Band((0.0, 0.0), (1.0, 0.0), k, rest, model.law).tension

        each = grouped((sample.rubber, sample) for sample in self.data.samples)
        return tuple(
            tension_curve(
                rubber,
                samples,
                tension(self.whole, rubber),
                [tension(numbers, rubber) for numbers in self.left.values()],
            )
            for rubber, samples in sorted(each.items())
        )

    @cached_property
    def axes(self) -> Floats:
        """(m, m) half axes of the covariance of the fitted numbers, a row each.

        From the Jacobian and the residual, which has as many independent readings as its
        correlation leaves.
        """
        forces = [(self.model(self.whole).force(one) - one.force) for one in self.data.samples]
        residual = np.concatenate(forces) / np.concatenate(
            [np.full(len(one.force), one.bands) for one in self.data.samples]
        )
        worth = max(sum(map(independent, forces)) - len(self.names), 1.0)
        size = np.array([fit_model.number(name).size for name in self.names])
        scaled = np.linalg.pinv(self.jacobian.T @ self.jacobian)
        power, ways = np.linalg.eigh(scaled * float(residual @ residual) / worth)
        return (ways * np.sqrt(np.maximum(power, 0.0))).T * size

    def _law_doubt(self, series: Series, stroke: float) -> float:
        """Standard deviation of a snap from the covariance of the fitted numbers [m]."""
        low, high = np.array([fit_model.number(name)[2:4] for name in self.names]).T
        squares = 0.0
        for axis in self.axes:
            ends = (np.clip(self.whole + sign * axis, low, high) for sign in (1.0, -1.0))
            moved = [abs(self.model(x).snap_of(series)[0] - stroke) for x in ends]
            known = [one for one in moved if not math.isnan(one)]
            squares += float(np.mean(known)) ** 2 if known else 0.0
        return math.sqrt(squares)

    def predict(self, test: PairTest) -> fit_model.SnapPrediction:
        """Snaps and order of a pair, from all samples and from the other geometries."""
        series = test.series
        fold = geometry_of(series.chain.levers[-1])
        whole, others = self.model(self.whole), self.model(self.left[fold])
        fitted, _ = whole.snap_of(series, self._force_deficits(series, whole, True))
        left_out, steep = others.snap_of(series, self._force_deficits(series, others, False))
        strokes = np.array([self.model(one).snap_of(series)[0] for one in self.left.values()])
        strokes = strokes[~np.isnan(strokes)]
        n = max(len(strokes), 1)
        moved = (n - 1) / n * float(np.sum((strokes - np.mean(strokes)) ** 2)) if n > 1 else 0.0
        plain, _ = whole.snap_of(series)
        if not math.isnan(plain):
            moved = max(moved, self._law_doubt(series, plain) ** 2)
        off = [
            error * self._scale(sample)
            for sample, error in zip(self.data.samples, self.errors[1], strict=True)
            if sample.in_pair and sample.bands == series.bands
        ]
        measured, spread, count = test.snap_strokes
        scatter = 0.0 if math.isnan(spread) else spread**2 / count
        # At a snap two forces are equal, and both have this error.
        forces = 2.0 * (rms(np.array(off)) / steep) ** 2
        return fit_model.SnapPrediction(
            series.name,
            fold,
            measured,
            spread,
            float(test.stroke[0] if series.unloading else test.stroke[-1]),
            test.snaps_predicted[0] if test.snaps_predicted else math.nan,
            fitted,
            left_out,
            math.sqrt(moved + forces + scatter + _STROKE**2 + test.seen_within**2),
            tuple(test.names(test.shown)),
            others.order_of(series),
            test.ratio,
        )

    def _force_deficits(self, series: Series, model: fit_model.Model, own: bool) -> list[float]:
        """Mean of measured less model force of each cell, late in its travel [N].

        From the pair itself (`own`), or from other geometries with equal bands and direction.
        """
        gaps: list[list[float]] = [[] for _ in series.chain.cells]
        fold, kind = geometry_of(series.chain.levers[-1]), (True, series.bands, series.unloading)
        for sample in self.data.samples:
            alike = (sample.in_pair, sample.bands, sample.unloading) == kind
            if sample.series == series.name if own else alike and sample.fold != fold:
                gap = sample.force - model.force(sample)
                gaps[sample.place].append(float(np.mean(gap[-len(gap) // _LATE :])))
        return [float(np.mean(one)) if one else 0.0 for one in gaps]

    def _fitted(self, samples: Sequence[Sample], start: Floats | None) -> tuple[Floats, Floats]:
        """Fitted values, and the Jacobian scaled by typical sizes."""
        from scipy.optimize import least_squares

        limits = np.array([fit_model.number(name)[1:] for name in self.names])
        first, low, high, size = limits.T
        data = fit_model.rows(samples, self.compliance)

        def residual(x: Floats) -> Floats:
            # Per band, so that two bands have no double weight.
            model = self.model(x)
            gaps = (fit_model.force(model.values, data, model.law) - data.force) / data.bands
            return np.concatenate([gaps, _HANDOVER * fit_model.handover_errors(model.values, data)])

        inside = np.clip(first if start is None else start, low + 1e-9 * size, high - 1e-9 * size)
        solution = least_squares(
            residual, inside, bounds=(low, high), x_scale=size, xtol=1e-10, ftol=1e-10
        )
        return solution.x, solution.jac * size
