"""Stiffness and rest length of the bands of one design, fitted to its own recordings."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stepwell.base import ByValue, Floats, Quantity, Schema, brief, record
from stepwell.lab.mechanisms.cell_test import CellTest
from stepwell.lab.mechanisms.compare import Comparison
from stepwell.lab.mechanisms.pair_test import PairTest
from stepwell.lab.mechanisms.predict import predicted_force
from stepwell.lab.recordings import LabError, rms
from stepwell.mechanism import Chain, Linear

TIED = 0.95  # correlation above which two numbers are not told apart
_LOW, _HIGH, _SIZE = (0.1, 0.0), (1e4, 0.1), (10.0, 0.005)


@dataclass(frozen=True, eq=False)
class Refit(ByValue):
    """The two numbers of a design's bands that bring its force nearest to its recordings.

    Attributes:
        chain: the design with them.
        stiffness: k of every band [N/m].
        rest_length: ℓ0 of every band [m].
        before, after: root mean square of measured less model, with the numbers of the design and
            with these [N].
        correlation: of the two numbers; near ±1 the recordings cannot tell them apart.
    """

    chain: Chain
    stiffness: float
    rest_length: float
    before: float
    after: float
    correlation: float

    @property
    def tied(self) -> bool:
        """Whether the recordings cannot tell the two numbers apart."""
        return abs(self.correlation) > TIED

    def record(self) -> dict[str, Any]:
        """As JSON can hold it."""
        return record(_REFIT, self)

    def __repr__(self):
        return brief(self)


_REFIT: Schema = (
    Quantity("stiffness", "N/m"),
    Quantity("rest_length", "mm"),
    Quantity("rms_before", "N", read="before"),
    Quantity("rms_after", "N", read="after"),
    Quantity("correlation"),
    Quantity("not_told_apart", read="tied"),
)


@dataclass(frozen=True)
class _Points:
    """What is fitted of one series."""

    unloading: bool
    stroke: Floats
    force: Floats


def refit(comparison: Comparison) -> Refit:
    """Fit one stiffness and one rest length to everything that recordings of one design show.

    Strokes that the comparison does not judge do not count, nor do those past the first snap,
    which would fit where the mechanism snaps and not how stiff it is. Friction beyond the baseline
    is not fitted: with loading and unloading it cancels, with one of them it does not.

    Args:
        comparison: of recordings with one design; its bands are alike and follow the linear law.

    Returns:
        The two numbers, and how near they come.

    Raises:
        LabError: several designs, or bands that are not alike.
    """
    from scipy.optimize import least_squares

    chain = comparison.tests[0].series.chain
    if any(test.series.chain != chain for test in comparison.tests):
        raise LabError("design", "recordings of several designs: fit one at a time.")
    bands = [band for cell in chain.levers for band in cell.bands]
    kinds = {(band.stiffness, band.rest_length) for band in bands}
    if len(kinds) > 1 or not all(type(band.law) is Linear for band in bands):
        raise LabError(
            "design",
            "its bands are not alike, or do not follow the linear law: stiffness and rest length "
            "are fitted where all bands share them.",
        )
    points = [_points(test) for test in comparison.tests]

    def gap(x: Floats) -> Floats:
        model = _with_bands(chain, float(x[0]), float(x[1]))
        return np.concatenate(
            [predicted_force(model, p.unloading, p.stroke) - p.force for p in points]
        )

    start = np.array(next(iter(kinds)))
    found = least_squares(
        gap, np.clip(start, np.array(_LOW) + 1e-6, _HIGH), bounds=(_LOW, _HIGH), x_scale=_SIZE
    )
    stiffness, rest_length = map(float, found.x)
    return Refit(
        _with_bands(chain, stiffness, rest_length),
        stiffness,
        rest_length,
        rms(gap(start)),
        rms(found.fun),
        float(correlations(found.jac * _SIZE)[0, 1]),
    )


def _points(test: CellTest | PairTest) -> _Points:
    series = test.series
    if isinstance(test, CellTest):
        use = series.judged()
        stroke, force = series.curve.stroke, series.net(series.curve.stroke, series.curve.force)
    else:
        stroke, force = test.stroke, test.force
        use = test.fitted
    return _Points(series.unloading, stroke[use], force[use])


def _with_bands(chain: Chain, stiffness: float, rest_length: float) -> Chain:
    """The chain, all its bands with these numbers [N/m], [m]."""
    return replace(
        chain,
        cells=tuple(
            replace(
                cell,
                band=tuple(
                    replace(band, stiffness=stiffness, rest_length=rest_length)
                    for band in cell.bands
                ),
            )
            for cell in chain.levers
        ),
    )


def correlations(jacobian: Floats) -> Floats:
    """(m, m) correlations of fitted numbers, from the Jacobian (n, m) of the residuals."""
    covariance = np.linalg.pinv(jacobian.T @ jacobian)
    size = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    return np.clip(covariance / np.outer(size, size), -1.0, 1.0)
