"""Everything about measured data in one folder: tables, verdicts, bands, figures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from stepwell.base import write_atomic
from stepwell.files import staged_folder
from stepwell.reports.steps import Progress, Steps, names, save_figures, write_json, write_netcdf

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.lab import BandTest, Calibration, Choice, Comparison, Recording


def write_readings(
    recordings: Sequence[Recording],
    record: dict[str, Any],
    folder: str | os.PathLike[str],
    *,
    force: bool = False,
) -> tuple[str, ...]:
    """Write recordings as one tidy table into a folder, all of it or nothing.

    Args:
        recordings: what was read.
        record: what there is to say of each; see docs/commands.md.
        folder: made if missing; what the same function wrote there before is replaced.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: recordings.csv, recordings.nc and recordings.json.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell.lab import table, table_csv

    with staged_folder(folder, "lab read", record, force=force) as draft:
        write_atomic(draft / "recordings.csv", table_csv(recordings))
        write_netcdf(draft / "recordings.nc", table(recordings))
        write_json(draft / "recordings.json", record)
        return names(draft)


def write_band(
    test: BandTest,
    choice: Choice,
    record: dict[str, Any],
    folder: str | os.PathLike[str],
    *,
    force: bool = False,
) -> tuple[str, ...]:
    """Write what tension tests show into a folder, all of it or nothing.

    Args:
        test: the tension tests.
        choice: their force laws.
        record: what `lab.band_record` returns.
        folder: made if missing; what the same function wrote there before is replaced.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: band.toml, band.json, laws.png and laws.svg.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    with staged_folder(folder, "lab band", record, force=force) as draft:
        write_atomic(draft / "band.toml", record["table"])
        write_json(draft / "band.json", record)
        save_figures({"laws": figures.band_laws(test, choice)}, draft, Steps(None, 2))
        return names(draft)


def write_comparison(
    comparison: Comparison,
    record: dict[str, Any],
    folder: str | os.PathLike[str],
    *,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[str, ...]:
    """Write measured against model into a folder, all of it or nothing.

    Args:
        comparison: what `lab.compare` returns.
        record: what `lab.comparison_record` returns.
        folder: made if missing; what the same function wrote there before is replaced.
        progress: called with (done, total) files.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: compare.json, curves.csv, and for each figure a .png and a .svg.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    with staged_folder(folder, "lab compare", record, force=force) as draft:
        drawn: dict[str, Figure] = {}
        if comparison.cells:
            drawn["forces"] = figures.measured_forces(comparison.cells)
            drawn["energies"] = figures.measured_energies(comparison.cells)
        if comparison.pairs:
            drawn["pairs"] = figures.measured_pairs(comparison.pairs)
        steps = Steps(progress, 2 + 2 * len(drawn))
        write_json(draft / "compare.json", record)
        steps.next()
        write_atomic(draft / "curves.csv", comparison.to_csv())
        steps.next()
        save_figures(drawn, draft, steps)
        return names(draft)


def write_calibration(
    calibration: Calibration,
    record: dict[str, Any],
    folder: str | os.PathLike[str],
    *,
    force: bool = False,
) -> tuple[str, ...]:
    """Write a calibration into a folder, all of it or nothing.

    Args:
        calibration: what `lab.calibrate` returns.
        record: the result as docs/commands.md describes it, its `table` among it.
        folder: made if missing; what the same function wrote there before is replaced.
        force: replace files that others wrote or changed too.

    Returns:
        The names of the files: band.toml, calibration.json, calibration.nc, calibration.png and
        calibration.svg.

    Raises:
        OverwriteError: a file there is not one that this function wrote; nothing has changed.
        OSError: the folder cannot be written.
    """
    from stepwell import figures

    with staged_folder(folder, "lab calibrate", record, force=force) as draft:
        write_atomic(draft / "band.toml", record["table"])
        write_json(draft / "calibration.json", record)
        write_netcdf(draft / "calibration.nc", calibration.to_xarray())
        save_figures({"calibration": figures.calibration(calibration)}, draft, Steps(None, 2))
        return names(draft)
