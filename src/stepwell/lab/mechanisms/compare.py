"""Measured against model: every unit cell and every pair of a batch, with a verdict each."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stepwell.base import ByValue, Drawn, Quantity, __version__, need, record, versions, write_csv
from stepwell.lab.mechanisms.cell_test import RISE, CellTest, cell_test
from stepwell.lab.mechanisms.pair_test import PairTest, pair_tests
from stepwell.lab.mechanisms.rig import NOT_JUDGED, PAPER_RIG, Rig
from stepwell.lab.mechanisms.schema import RIG
from stepwell.lab.mechanisms.series import over_geometries, sort_series
from stepwell.lab.recordings import LabError, Recording
from stepwell.mechanism import Chain

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class Comparison(ByValue, Drawn):
    """What a batch of recordings shows.

    Attributes:
        cells: unit cells.
        pairs: two-cell mechanisms.
        told: what became of recordings that are in no series.
        rig: on which was measured.
    """

    cells: tuple[CellTest, ...]
    pairs: tuple[PairTest, ...]
    told: tuple[str, ...]
    rig: Rig

    @property
    def tests(self) -> tuple[CellTest | PairTest, ...]:
        """All of them."""
        return (*self.cells, *self.pairs)

    def mean_rmse(self, bands: int) -> float:
        """Mean over the geometries of unit cells with so many bands of the RMSE, in k r."""
        tests = [test for test in self.cells if test.series.bands == bands]
        return over_geometries((test.series.geometry, test.rmse) for test in tests)

    def to_xarray(self) -> xr.Dataset:
        """Measured and model force over "row", a row for every stroke of every series."""
        need("tables")
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
            {"source": f"stepwell {__version__}, lab.compare"},
        )

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Write the same rows as CSV, units in the column names (mm, N)."""
        series, (stroke, force, model, inside) = self._columns()
        names = [test.series.name for test in self.tests]
        columns = [
            (Quantity("series"), [names[number] for number in series]),
            (Quantity("stroke", "mm"), stroke),
            (Quantity("measured", "N"), force),
            (Quantity("model", "N"), model),
            (Quantity("judged"), inside.astype(int)),
        ]
        write_csv(file, columns, 6)

    def _columns(self) -> tuple[Any, list[Any]]:
        """A row for every stroke of every series: the number of its series, and `_rows`."""
        rows = [_rows(test) for test in self.tests]
        series = np.concatenate([np.full(len(u), k) for k, (u, _, _, _) in enumerate(rows)])
        return series, [np.concatenate(column) for column in zip(*rows, strict=True)]

    def __repr__(self):
        return f"Comparison({len(self.cells)} unit cells, {len(self.pairs)} pairs)"


def compare(
    recordings: Sequence[Recording],
    designs: Sequence[Chain] = (),
    *,
    baseline: Sequence[Recording] | None = None,
    as_designed: bool = False,
    rig: Rig = PAPER_RIG,
) -> Comparison:
    """Compare recordings with the mechanisms that they show.

    Args:
        recordings: tests of unit cells and pairs, baselines among them.
        designs: what file names leave open; see `sort_series`.
        baseline: runs without a band; by default found by name, empty for none.
        as_designed: take the design as it is, whatever names say.
        rig: its stretch, starts, compliance and friction move what is predicted of pairs to the
            strokes that the machine shows; its bar is for the correction that is reported beside
            the plain result.

    Returns:
        A verdict for every series.

    Raises:
        LabError: nothing to compare, or a chain of more than two cells.
    """
    found = sort_series(recordings, designs, baseline=baseline, as_designed=as_designed)
    longer = [one for one in found.series if len(one.chain) > 2]
    if longer:
        raise LabError(
            longer[0].code,
            f"its design has {len(longer[0].chain)} cells: one or two can be compared.",
        )
    cells = tuple(cell_test(one, rig) for one in found.series if len(one.chain) == 1)
    pairs = tuple(pair_tests([one for one in found.series if len(one.chain) == 2], rig))
    return Comparison(cells, pairs, found.told, rig)


def comparison_record(comparison: Comparison) -> dict[str, Any]:
    """The comparison as JSON can hold it; docs/commands.md describes the names."""
    counts = sorted({test.series.bands for test in comparison.cells})
    return {
        "schema": "stepwell.lab.compare/1",
        "stepwell": __version__,
        "versions": versions(),
        "bar_mm": None if np.isinf(comparison.rig.bar) else comparison.rig.bar * 1e3,
        "rig": record(RIG, comparison.rig),
        "mean_rmse_over_kr": [
            {"bands": n, "rmse_over_kr": comparison.mean_rmse(n)} for n in counts
        ],
        "series": [test.record() for test in comparison.tests],
        "told": list(comparison.told),
        "not_judged": NOT_JUDGED,
        "rise_over_kr": RISE,
    }


def _rows(test: CellTest | PairTest) -> tuple[Any, Any, Any, Any]:
    if isinstance(test, PairTest):
        return test.stroke, test.force, test.model, test.inside
    reading = test.plain
    return test.cell.travel(reading.theta), reading.force, test.model, reading.inside
