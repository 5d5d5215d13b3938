"""Measured against model: a verdict for every cell and pair, and bands fitted to a design's own."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell import base
from stepwell.base import grouped
from stepwell.lab.cell_test import CellTest, cell_test
from stepwell.lab.chain_test import ChainTest, chain_test
from stepwell.lab.pair_test import PairTest, pair_tests
from stepwell.lab.recordings.curve import rms
from stepwell.lab.recordings.recording import LabError, Recording
from stepwell.lab.rig import PAPER_RIG, Rig, predicted_force
from stepwell.lab.series import over_geometries, sort_series
from stepwell.mechanism import Chain, Linear

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class Comparison(base.ByValue, base.Drawn):
    """Comparison of a batch of recordings with the models.

    Attributes:
        cells, pairs, chains: unit cells, two-cell mechanisms, and chains of elements or of more
            cells.
        notes: a line for every recording that is in no series.
        rig: the test rig.
    """

    cells: tuple[CellTest, ...]
    pairs: tuple[PairTest, ...]
    notes: tuple[str, ...]
    rig: Rig
    chains: tuple[ChainTest, ...] = ()

    @property
    def tests(self) -> tuple[CellTest | PairTest | ChainTest, ...]:
        """Unit cells, then pairs, then chains."""
        return (*self.cells, *self.pairs, *self.chains)

    def mean_rmse(self, bands: int) -> float:
        """Mean over the geometries of unit cells of the RMSE in k r, for that number of bands."""
        tests = [test for test in self.cells if test.series.bands == bands]
        return over_geometries((test.series.geometry, test.rmse) for test in tests)

    def to_xarray(self) -> "xr.Dataset":
        """Dataset of measured and model force over "row", a row for each stroke of each series."""
        base.need("tables")
        import xarray as xr

        series, (stroke, force, model, inside) = self._columns()
        return xr.Dataset(
            {
                "of": ("row", series, {"units": "1", "long_name": "number of the series"}),
                "stroke": ("row", stroke, {"units": "m", "long_name": "from state 0 on"}),
                "force": ("row", force, {"units": "N", "long_name": "measured, less baseline"}),
                "model": ("row", model, {"units": "N"}),
                "judged": ("row", inside, {"long_name": "whether it counts"}),
            },
            {"series": [test.series.name for test in self.tests]},
            {"source": f"stepwell {base.__version__}, lab.compare"},
        )

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Write the same rows as CSV, units in the column names (mm, N)."""
        series, (stroke, force, model, inside) = self._columns()
        names = [test.series.name for test in self.tests]
        columns = [
            (base.Quantity("series"), [names[number] for number in series]),
            (base.Quantity("stroke", "mm"), stroke),
            (base.Quantity("measured", "N"), force),
            (base.Quantity("model", "N"), model),
            (base.Quantity("judged"), inside.astype(int)),
        ]
        base.write_csv(file, columns, 6)

    def _columns(self) -> tuple[Any, list[Any]]:
        """Number of the series and columns of `_rows`, for every stroke of every series."""
        rows = [_rows(test) for test in self.tests]
        series = np.concatenate([np.full(len(u), k) for k, (u, _, _, _) in enumerate(rows)])
        return series, [np.concatenate(column) for column in zip(*rows, strict=True)]

    def __repr__(self):
        chains = f", {len(self.chains)} chains" if self.chains else ""
        return f"Comparison({len(self.cells)} unit cells, {len(self.pairs)} pairs{chains})"


def compare(
    recordings: Sequence[Recording],
    designs: Sequence[Chain] = (),
    *,
    baseline: Sequence[Recording] | None = None,
    as_designed: bool = False,
    rig: Rig = PAPER_RIG,
) -> Comparison:
    """Compare recordings with the models of the tested mechanisms: a verdict for every series.

    Args:
        recordings: tests of unit cells, pairs and chains, baselines among them.
        designs: what file names leave open; see `sort_series`.
        baseline: runs without a band; by default found by name, empty for none.
        as_designed: use the design unchanged and ignore the names.
        rig: its stretch, starts, compliance and friction convert predictions for pairs to strokes
            of the machine. Its bar is used for the correction that is reported in addition to
            the plain result.

    Raises:
        LabError: nothing to compare.
    """
    sorted_series = sort_series(recordings, designs, baseline=baseline, as_designed=as_designed)
    kinds = grouped((_kind(one.chain), one) for one in sorted_series.series)
    cells = tuple(cell_test(one, rig) for one in kinds.get("cell", ()))
    pairs = tuple(pair_tests(kinds.get("pair", ()), rig))
    chains = tuple(map(chain_test, kinds.get("chain", ())))
    return Comparison(cells, pairs, sorted_series.notes, rig, chains)


def _kind(chain: Chain) -> str:
    """Whether a chain is compared as a unit cell, as a pair, or by its force alone."""
    kinds = {1: "cell", 2: "pair"}
    return "chain" if chain.elements else kinds.get(len(chain), "chain")


def _rows(test: CellTest | PairTest | ChainTest) -> tuple[Any, Any, Any, Any]:
    if not isinstance(test, CellTest):
        return test.stroke, test.force, test.model, test.inside
    reading = test.plain
    return test.cell.travel(reading.theta), reading.force, test.model, reading.inside


TIED = 0.95  # correlation above which the data do not identify two numbers separately
_LOW, _HIGH, _SIZE = (0.1, 0.0), (1e4, 0.1), (10.0, 0.005)


@dataclass(frozen=True, eq=False, repr=False)
class Refit(base.ByValue):
    """Stiffness and rest length of a design's bands, fitted to its recordings.

    Attributes:
        chain: the design with the fitted bands.
        stiffness, rest_length: k [N/m] and ℓ0 [m] of every band.
        before, after: root mean square of measured less model, with the numbers of the design and
            with these [N].
        correlation: of both numbers; near ±1 the recordings do not identify them separately.
    """

    chain: Chain
    stiffness: float
    rest_length: float
    before: float
    after: float
    correlation: float

    @property
    def tied(self) -> bool:
        """Whether the recordings do not identify both numbers separately."""
        return abs(self.correlation) > TIED

    def record(self) -> dict[str, Any]:
        """The result as JSON values."""
        return base.record(_REFIT, self)


_REFIT: base.Schema = (
    base.Quantity("stiffness", "N/m"),
    base.Quantity("rest_length", "mm"),
    base.Quantity("rms_before", "N", read="before"),
    base.Quantity("rms_after", "N", read="after"),
    base.Quantity("correlation"),
    base.Quantity("strongly_correlated", read="tied"),
)


def refit(comparison: Comparison) -> Refit:
    """Fit one stiffness and one rest length to the recordings of one design.

    Strokes that the comparison does not judge are left out. So are strokes past the first snap: a
    fit to them follows the stroke of the snap, not the stiffness. Friction beyond the baseline is
    not fitted. It cancels with loading and unloading, but not with one of both.

    Raises:
        LabError: several designs, or bands that are not alike or do not follow the linear law.
    """
    from scipy.optimize import least_squares

    chain = comparison.tests[0].series.chain
    if any(test.series.chain != chain for test in comparison.tests):
        raise LabError("design", "recordings of several designs: fit one at a time.")
    if comparison.chains:
        raise LabError(
            "design", "a chain of elements or of more than two cells: nothing is fitted."
        )
    bands = [band for cell in chain.levers for band in cell.bands]
    kinds = {(band.stiffness, band.rest_length) for band in bands}
    if len(kinds) > 1 or not all(type(band.law) is Linear for band in bands):
        raise LabError(
            "design",
            "its bands differ or do not follow the linear law: stiffness and rest length "
            "are fitted where all bands share them.",
        )
    points = [_points(test) for test in (*comparison.cells, *comparison.pairs)]

    def gap(x: base.Floats) -> base.Floats:
        model = _with_bands(chain, float(x[0]), float(x[1]))
        return np.concatenate([predicted_force(model, way, u) - force for way, u, force in points])

    start = np.array(next(iter(kinds)))
    solution = least_squares(
        gap, np.clip(start, np.array(_LOW) + 1e-6, _HIGH), bounds=(_LOW, _HIGH), x_scale=_SIZE
    )
    stiffness, rest_length = map(float, solution.x)
    return Refit(
        _with_bands(chain, stiffness, rest_length),
        stiffness,
        rest_length,
        rms(gap(start)),
        rms(solution.fun),
        float(correlations(solution.jac * _SIZE)[0, 1]),
    )


def _points(test: CellTest | PairTest) -> tuple[bool, base.Floats, base.Floats]:
    """Data of one series for the fit: whether it unloads, its strokes and its forces."""
    series = test.series
    if isinstance(test, PairTest):
        return series.unloading, test.stroke[test.fitted], test.force[test.fitted]
    use, stroke = series.judged(), series.curve.stroke
    return series.unloading, stroke[use], series.net(stroke, series.curve.force)[use]


def _with_bands(chain: Chain, stiffness: float, rest_length: float) -> Chain:
    sizes = {"stiffness": stiffness, "rest_length": rest_length}
    bands = [tuple(replace(band, **sizes) for band in cell.bands) for cell in chain.levers]
    cells = [replace(cell, band=band) for cell, band in zip(chain.levers, bands, strict=True)]
    return replace(chain, cells=cells)


def correlations(jacobian: base.Floats) -> base.Floats:
    """(m, m) correlations of fitted numbers, from the Jacobian (n, m) of the residuals."""
    covariance = np.linalg.pinv(jacobian.T @ jacobian)
    size = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    return np.clip(covariance / np.outer(size, size), -1.0, 1.0)
