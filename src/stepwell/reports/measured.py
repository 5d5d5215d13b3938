"""What folders of recordings have: bands, comparisons, calibrations, first builds."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from stepwell.accounts import Account
from stepwell.base import write_netcdf
from stepwell.files import dumps, rig_toml
from stepwell.reports.write import Content, Contents, Draw

if TYPE_CHECKING:
    from stepwell.lab import AsBuilt, BandFit, Batch, Calibration, Comparison


def contents(account: Account) -> Contents:
    """What the folder of a result has besides its page."""
    return _CONTENTS[type(account.value).__name__](account.value, account)


def _batch(found: Batch, _: Account) -> Contents:
    from stepwell.lab import table, to_csv

    recordings = found.recordings
    return Contents(
        "lab read",
        "recordings.json",
        {
            "recordings.csv": partial(to_csv, recordings),
            "recordings.nc": lambda file: write_netcdf(file, table(recordings)),
        },
    )


def _band_fit(found: BandFit, account: Account) -> Contents:
    from stepwell import figures

    return Contents(
        "lab band",
        "band.json",
        {"band.toml": account.record["table"]},
        {"laws": partial(figures.band_laws, found.test, found.choice)},
    )


def _comparison(found: Comparison, _: Account) -> Contents:
    from stepwell import figures

    draws: dict[str, Draw] = {}
    if found.cells:
        draws["forces"] = partial(figures.measured_forces, found.cells)
        draws["energies"] = partial(figures.measured_energies, found.cells)
    if found.pairs:
        draws["pairs"] = partial(figures.measured_pairs, found.pairs)
    return Contents("lab compare", "compare.json", {"curves.csv": found.to_csv}, draws)


def _calibration(found: Calibration, account: Account) -> Contents:
    from stepwell import figures

    files: dict[str, Content] = {
        "band.toml": account.record["table"],
        "calibration.nc": lambda file: write_netcdf(file, found.to_xarray()),
    }
    if found.pairs:
        first = found.pairs[0].series
        files["pair.toml"] = dumps(found.applied(first.chain, first.bands))
        files["rig.toml"] = rig_toml(found.rig)
    draws = {"calibration": partial(figures.calibration, found)}
    return Contents("lab calibrate", "calibration.json", files, draws)


def _as_built(found: AsBuilt, _: Account) -> Contents:
    files: dict[str, Content] = {"built.toml": dumps(found.chain)}
    if found.moves:
        files["moved.toml"] = dumps(found.moves[0].of(found.chain))
    return Contents("lab as-built", "built.json", files)


_CONTENTS: dict[str, Callable[..., Contents]] = {
    "AsBuilt": _as_built,
    "BandFit": _band_fit,
    "Batch": _batch,
    "Calibration": _calibration,
    "Comparison": _comparison,
}
