"""A calibrated band as a table of a design file, what it leaves out in comments."""

from __future__ import annotations

from stepwell.base import __version__
from stepwell.lab.bands import band_line
from stepwell.lab.calibration.calibrate import Calibration
from stepwell.lab.mechanisms import counted_bands


def calibrated_table(calibration: Calibration, source: str = "") -> str:
    """The `band` line of a design file for each number of bands, the first of them ready to use.

    Args:
        calibration: the fit.
        source: what the recordings are called.

    Returns:
        TOML: comments with provenance, errors and what a design cannot hold, then the band of
        cells with the fewest bands; those of the others are commented out.
    """
    names = sorted({sample.name for sample in calibration.samples})
    loss, length = calibration["loss"], calibration["loss_length"]
    friction, rest = calibration["friction"], calibration["rest_length"]
    errors = "; ".join(
        f"{counted_bands(n)}: {calibration.mean_error(n, left_out=False):.3f} fitted, "
        f"{calibration.mean_error(n):.3f} left out"
        for n in calibration.counts
    )
    lines = [
        *([f"From {source}, by stepwell {__version__}."] if source else []),
        f"Fitted to {len(names)} series of unit cells, {calibration.law} law. Mean RMSE in k r, "
        f"k = {calibration.reference:g} N/m a band,",
        f"of a geometry: {errors}.",
        f"Rest length between the anchors {rest.value * 1e3:.3g} mm "
        f"({rest.low * 1e3:.3g} to {rest.high * 1e3:.3g}).",
        f"Not in this table: going back, a band pulls less by {loss.value:.0%} "
        f"({loss.low:.0%} to {loss.high:.0%}), reached over {length.value * 1e3:.2g} mm;",
        f"friction beyond the baseline {friction.value * 1e3:.2g} mN "
        f"({friction.low * 1e3:.2g} to {friction.high * 1e3:.2g}).",
    ]
    if calibration.tied:
        pairs = ", ".join(f"{a} and {b} ({c:+.2f})" for a, b, c in calibration.tied[:4])
        lines.append(f"These numbers are not told apart by the data: {pairs}.")
    text = "".join(f"# {line}\n" for line in lines)
    for k, bands in enumerate(calibration.counts):
        value = calibration[f"stiffness_{bands}"]
        text += (
            f"# Each band of a cell with {counted_bands(bands)}: k = {value.value:.4g} N/m "
            f"({value.low:.4g} to {value.high:.4g})\n"
        )
        text += f"{'# ' if k else ''}{band_line(_keys(calibration, bands))}"
    return text


def _keys(calibration: Calibration, bands: int) -> dict[str, float]:
    band = calibration.band(bands)
    keys = {"stiffness_N_per_m": band.stiffness, "rest_length_mm": band.rest_length * 1e3}
    if calibration.law == "cubic":
        keys["quadratic_per_mm"] = calibration["quadratic"].value * 1e-3
        keys["cubic_per_mm2"] = calibration["cubic"].value * 1e-6
    return keys
