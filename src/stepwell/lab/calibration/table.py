"""A calibrated band as a table of a design file, what it leaves out in comments."""

from __future__ import annotations

from textwrap import wrap
from typing import Any

import numpy as np

from stepwell.base import __version__, counted
from stepwell.lab.bands import band_line
from stepwell.lab.calibration.calibrate import Calibration
from stepwell.lab.calibration.samples import rubber_name
from stepwell.lab.mechanisms import counted_bands
from stepwell.mechanism import Cubic, Table

_ROWS = 13


def calibrated_table(calibration: Calibration, source: str = "") -> str:
    """The `band` line of a design file for each number of bands, the first of them ready to use.

    Args:
        calibration: the fit.
        source: what the recordings are called.

    Returns:
        TOML: comments with provenance, errors and what a design cannot hold, then the band of
        cells with the fewest bands; those of the others are commented out, and so are the weight
        and the friction that cells of pairs carry.
    """
    loss, length = calibration["loss"], calibration["loss_length"]
    friction, rest = calibration["friction"], calibration["rest_length"]
    errors = "; ".join(
        f"{_kind(n, pair)}: {calibration.mean_error(n, pair, left_out=False):.3f} fitted, "
        f"{calibration.mean_error(n, pair):.3f} left out"
        for n, pair in calibration.kinds
    )
    told = [
        *([f"From {source}, by stepwell {__version__}."] if source else []),
        f"Fitted to {counted(len(calibration.samples), 'curve')} of cells, law: {calibration.law}. "
        f"Mean RMSE in k r, k = {calibration.reference:g} N/m a band, of a geometry: {errors}.",
        f"Rest length between the anchors {rest.value * 1e3:.3g} mm "
        f"({rest.low * 1e3:.3g} to {rest.high * 1e3:.3g}); from series to series bands differ by "
        f"{calibration.scatter:.1%} (standard deviation).",
        f"Not in this table: going back, a band pulls less by {loss.value:.0%} "
        f"({loss.low:.0%} to {loss.high:.0%}), reached over {length.value * 1e3:.2g} mm; "
        f"friction beyond the baseline {friction.value * 1e3:.2g} mN "
        f"({friction.low * 1e3:.2g} to {friction.high * 1e3:.2g}).",
    ]
    if calibration.tied:
        pairs = ", ".join(f"{a} and {b} ({c:+.2f})" for a, b, c in calibration.tied[:4])
        told.append(f"These numbers are not told apart by the data: {pairs}.")
    told += [f"Not told: {line}." for line in calibration.open]
    text = "".join(f"# {line}\n" for one in told for line in wrap(one, 98))
    for k, (bands, pair) in enumerate(calibration.kinds):
        value = calibration[rubber_name(bands, pair)]
        text += (
            f"# Each band of {_kind(bands, pair)}: k = {value.value:.4g} N/m "
            f"({value.low:.4g} to {value.high:.4g})\n"
        )
        text += f"{'# ' if k else ''}{band_line(_keys(calibration, bands, pair))}"
    if calibration.weight:
        text += (
            f"# In pairs each cell but the outermost carries the block beyond it:\n"
            f"# load_N = {calibration.weight:.4g}\n"
        )
    for bands, pair in calibration.kinds:
        if pair and calibration.joints:
            friction_N = calibration.joints * calibration.tension(bands)
            text += (
                f"# Friction in the joints, {calibration.joints:.2%} of the tension; of "
                f"{_kind(bands, pair)}, at mid-travel of d = (20, 0) mm:\n"
                f"# friction_N = {friction_N:.3g}\n"
            )
    return text


def _kind(bands: int, pair: bool) -> str:
    return f"{'pairs' if pair else 'cells'} with {counted_bands(bands)}"


def _keys(calibration: Calibration, bands: int, pair: bool) -> dict[str, Any]:
    band = calibration.band(bands, pair)
    keys: dict[str, Any] = {"rest_length_mm": band.rest_length * 1e3}
    if isinstance(band.law, Table):
        pulls = band.stiffness * np.array(band.law.shape)
        rows = np.stack([np.array(band.law.extension) * 1e3, pulls], axis=1)
        return keys | {"table_mm_N": rows[:: 2 if len(rows) > _ROWS else 1].tolist()}
    keys = {"stiffness_N_per_m": band.stiffness} | keys
    if isinstance(band.law, Cubic):
        keys["quadratic_per_mm"] = band.law.a2 * 1e-3
        keys["cubic_per_mm2"] = band.law.a3 * 1e-6
    return keys
