"""Everything about measured data in one folder: tables, verdicts, bands, figures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from stepwell.files import dumps, rig_toml
from stepwell.reports.pages import (
    band_page,
    calibration_page,
    comparison_page,
    readings_page,
)
from stepwell.reports.steps import Folder, Progress, bundle, netcdf, pictured

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.lab import BandTest, Calibration, Choice, Comparison, Recording

_CAPTIONS = {
    "forces": "Forces of unit cells, measured and modelled",
    "energies": "Energies of unit cells, measured and modelled",
    "pairs": "Forces of pairs, measured and modelled",
    "laws": "Force against stroke, and the laws",
    "calibration": "Fitted and measured forces",
}


def write_readings(
    recordings: Sequence[Recording],
    record: dict[str, Any],
    folder: Folder,
    *,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write recordings as one tidy table: recordings.csv, .nc and .json, report.html."""
    from stepwell.lab import SUMMARY, table, to_csv

    contents = {
        "recordings.csv": lambda file: to_csv(recordings, file),
        "recordings.nc": netcdf(table(recordings)),
        "recordings.json": record,
        "report.html": readings_page(record, SUMMARY),
    }
    return bundle(folder, "lab read", contents, progress=progress, force=force)


def write_band(
    test: BandTest,
    choice: Choice,
    record: dict[str, Any],
    folder: Folder,
    *,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write tension tests, their laws and what `lab.band_record` returns: band and laws."""
    from stepwell import figures

    found = pictured({"laws": partial(figures.band_laws, test, choice)}, _CAPTIONS)
    page = band_page(record, found.wide, found.narrow)
    contents = {"band.toml": record["table"], "band.json": record, "report.html": page}
    return bundle(folder, "lab band", contents, found.files, progress=progress, force=force)


def write_comparison(
    comparison: Comparison,
    record: dict[str, Any],
    folder: Folder,
    *,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a comparison and what `lab.comparison_record` returns of it: compare.json, curves.csv.

    The figures are forces and energies of unit cells, and pairs.
    """
    from stepwell import figures
    from stepwell.lab import CELL_TEST, PAIR_TEST

    draws: dict[str, Callable[[], Figure]] = {}
    if comparison.cells:
        draws["forces"] = partial(figures.measured_forces, comparison.cells)
        draws["energies"] = partial(figures.measured_energies, comparison.cells)
    if comparison.pairs:
        draws["pairs"] = partial(figures.measured_pairs, comparison.pairs)
    found = pictured(draws, _CAPTIONS)
    contents = {
        "compare.json": record,
        "curves.csv": comparison.to_csv,
        "report.html": comparison_page(record, CELL_TEST, PAIR_TEST, found.wide, found.narrow),
    }
    return bundle(folder, "lab compare", contents, found.files, progress=progress, force=force)


def write_calibration(
    calibration: Calibration,
    record: dict[str, Any],
    folder: Folder,
    *,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a calibration and its record: band.toml, calibration.json and .nc, calibration.

    With pairs, pair.toml and rig.toml too: the first of them with what was fitted, and the rig.
    """
    from stepwell import figures
    from stepwell.lab import ERROR, PARAMETER, SNAP

    found = pictured({"calibration": partial(figures.calibration, calibration)}, _CAPTIONS)
    contents = {
        "band.toml": record["table"],
        "calibration.json": record,
        "calibration.nc": netcdf(calibration.to_xarray()),
        "report.html": calibration_page(record, PARAMETER, ERROR, SNAP, found.wide, found.narrow),
    }
    if calibration.pairs:
        first = calibration.pairs[0].series
        contents["pair.toml"] = dumps(calibration.applied(first.chain, first.bands))
        contents["rig.toml"] = rig_toml(calibration.rig)
    return bundle(folder, "lab calibrate", contents, found.files, progress=progress, force=force)
