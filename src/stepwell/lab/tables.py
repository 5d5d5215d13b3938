"""Bands, tested and calibrated, as tables of a design file, and their laws for a fit."""

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from textwrap import wrap
from typing import Any

import numpy as np

from stepwell.base import __version__, counted, grouped, to_unit
from stepwell.lab.bands.band import band_test
from stepwell.lab.bands.band_fit import BandFit
from stepwell.lab.bands.choice import NOTHING
from stepwell.lab.calibration import Calibration
from stepwell.lab.fit_samples import rubber_name
from stepwell.lab.recordings.recording import LabError, Recording, setup_of
from stepwell.lab.series import TENSION_TEST
from stepwell.mechanism import Cubic, Table

_ROWS = 13


def band_table(band_fit: BandFit, source: str = "") -> str:
    """The `band` line of a design file, with its provenance in comments above it.

    `source` is the name of the recordings. The result is TOML to paste into [chain] or
    [[chain.cell]]. An unknown rest length is left out, with a comment.
    """
    gauge, keys, comments = band_fit.choice.gauge, _keys(band_fit), _provenance(band_fit, source)
    if gauge is None:
        comments += [
            "rest_length_mm is left out: the recordings do not identify it. The default is 10 mm;",
            "measure the length at which your band begins to pull, and add it here.",
        ]
    else:
        keys = {"rest_length_mm": to_unit(gauge + band_fit.written.fitted.onset, "mm")} | keys
    return "".join(f"# {line}\n" for line in comments) + band_line(keys)


def band_line(keys: Mapping[str, float | list[list[float]]]) -> str:
    """The line `band = { … }` of a design file, from values and table rows by key."""
    return f"band = {{ {', '.join(f'{key} = {_text(value)}' for key, value in keys.items())} }}\n"


def _text(value: float | list[Any]) -> str:
    return f"[{', '.join(map(_text, value))}]" if isinstance(value, list) else f"{value:.5g}"


def _keys(band_fit: BandFit) -> dict[str, Any]:
    fitted = band_fit.written.fitted
    if fitted.law.name == "linear":
        return {"stiffness_N_per_m": band_fit.stiffness.value}
    if fitted.law.name == "cubic":
        k, *over_k = fitted.coefficients
        quadratic, cubic = (c / k for c in over_k)
        return {
            "stiffness_N_per_m": k,
            "quadratic_per_mm": to_unit(quadratic, "1/mm"),
            "cubic_per_mm2": to_unit(cubic, "1/mm²"),
        }
    e = np.linspace(0.0, band_fit.test.window[1] - fitted.onset, _ROWS)
    rows = np.stack([to_unit(e, "mm"), fitted.tension(fitted.onset + e)], axis=1)
    return {"table_mm_N": rows.tolist()}


def _provenance(band_fit: BandFit, source: str) -> list[str]:
    test, choice, candidate = band_fit.test, band_fit.choice, band_fit.written
    estimate, alone = band_fit.stiffness, band_fit.alone
    low, high = (to_unit(edge, "mm") for edge in test.window)
    if alone is None:
        between = f"{estimate.low:.4g} to {estimate.high:.4g}"
        interval = f"95 % {between}, scatter between samples {estimate.spread:.3g}"
    elif math.isnan(alone.stiffness.low):
        interval = "one sample and too few readings: its uncertainty is not known"
    else:
        interval = (
            f"this band 95 % {alone.stiffness.low:.4g} to {alone.stiffness.high:.4g}; one "
            f"sample gives no interval for other bands"
        )
    tried = f"predicts a {choice.folds} left out to {to_unit(candidate.score, 'mN'):.3g} mN"
    if choice.folds == NOTHING:
        tried = "was tested on no other curve"
    lengths: list[str] = []
    if alone is not None and alone.rest_length is not None and candidate is choice.chosen:
        length = [to_unit(edge, "mm") for edge in alone.rest_length]
        lengths = ["Rest length {:.4g} mm (95 % {:.4g} to {:.4g}).".format(*length)]
    ends = f"extensions of {max(low - to_unit(candidate.fitted.onset, 'mm'), 0.0):.3g}"
    return [
        *([f"From {source}, by stepwell {__version__}."] if source else []),
        *(line for warning in test.warnings for line in wrap(f"WARNING: {warning}", 98)),
        f"Samples {', '.join(map(str, test.samples))}, cycles {test.cycles[0]} to "
        f"{test.cycles[1]}, loading, {low:.5g} to {high:.5g} mm of stroke.",
        f"Straight line: k = {estimate.value:.5g} N/m ({interval}).",
        f"This is the {candidate.law.name} law: its RMSE is "
        f"{to_unit(candidate.fitted.rmse, 'mN'):.3g} mN, and it {tried}.",
        *lengths,
        f"It was measured at {ends} to {high - to_unit(candidate.fitted.onset, 'mm'):.3g} mm only.",
    ]


def calibrated_table(calibration: Calibration, source: str = "") -> str:
    """The `band` line of a design file for each number of bands; all but the first in comments.

    `source` is the name of the recordings. Other comments give provenance, errors, quantities
    without a key in a design file, and the weight and friction of cells in pairs.
    """
    comments = _calibrated_comments(calibration, source)
    text = "".join(f"# {line}\n" for one in comments for line in wrap(one, 98))
    if calibration.missing:
        return f"{text}# No band is written: {calibration.missing}.\n"
    for k, (bands, pair) in enumerate(calibration.kinds):
        value = calibration[rubber_name(bands, pair)]
        if value.name not in calibration.unknown:
            text += (
                f"# Each band of {_kind(bands, pair)}: k = {value.value:.4g} N/m "
                f"({value.low:.4g} to {value.high:.4g})\n"
            )
        text += f"{'# ' if k else ''}{band_line(_calibrated_keys(calibration, bands, pair))}"
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


def _calibrated_comments(calibration: Calibration, source: str) -> list[str]:
    """Provenance, errors, quantities without a key, and what the data do not identify."""
    loss, length = calibration["loss"], calibration["loss_length"]
    friction, rest = calibration["friction"], calibration["rest_length"]
    errors = "; ".join(
        f"{_kind(n, pair)}: {calibration.mean_error(n, pair, left_out=False):.3f} fitted, "
        f"{calibration.mean_error(n, pair):.3f} left out"
        for n, pair in calibration.kinds
    )
    comments = [
        *([f"From {source}, by stepwell {__version__}."] if source else []),
        f"Fitted to {counted(len(calibration.samples), 'curve')} of cells, law: {calibration.law}. "
        f"Mean RMSE in k r, k = {calibration.reference:g} N/m a band, of a geometry: {errors}.",
        f"Rest length between the anchors {to_unit(rest.value, 'mm'):.3g} mm "
        f"({to_unit(rest.low, 'mm'):.3g} to {to_unit(rest.high, 'mm'):.3g}); from series to series "
        f"bands differ by {calibration.scatter:.1%} (standard deviation).",
        f"Not in this table: in unloading, a band pulls less by {loss.value:.0%} "
        f"({loss.low:.0%} to {loss.high:.0%}), reached over {to_unit(length.value, 'mm'):.2g} mm; "
        f"friction beyond the baseline {to_unit(friction.value, 'mN'):.2g} mN "
        f"({to_unit(friction.low, 'mN'):.2g} to {to_unit(friction.high, 'mN'):.2g}).",
    ]
    if calibration.tied:
        pairs = ", ".join(f"{a} and {b} ({c:+.2f})" for a, b, c in calibration.tied[:4])
        comments.append(f"The data do not identify these numbers separately: {pairs}.")
    comments += [f"Not identified: {line}." for line in calibration.open]
    if calibration.unknown:
        comments.append(_unknown_text(calibration))
    return comments


def _unknown_text(calibration: Calibration) -> str:
    """What the data do not identify, and where the written table holds."""
    ends = [end for one in calibration.tensions for end in (one.length[0], one.length[-1])]
    low, high = (to_unit(end, "mm") for end in (min(ends), max(ends)))
    worst = max(one.width for one in calibration.tensions)
    unknown = ", ".join(calibration.unknown)
    return (
        f"The data do not identify {unknown}. Instead the tension is written "
        f"at the distances of the anchors in the data, {low:.3g} to {high:.3g} mm, known to "
        f"±{worst:.0%} of its largest value (95 %); rest_length_mm is only the zero of its table. "
        f"Shorter bands are a straight line."
    )


def _kind(bands: int, pair: bool) -> str:
    return f"{'pairs' if pair else 'cells'} with {counted(bands, 'band')}"


def _calibrated_keys(calibration: Calibration, bands: int, pair: bool) -> dict[str, Any]:
    band = calibration.band(bands, pair)
    keys: dict[str, Any] = {"rest_length_mm": to_unit(band.rest_length, "mm")}
    if isinstance(band.law, Table):
        pulls = band.stiffness * np.array(band.law.shape)
        rows = np.stack([to_unit(np.array(band.law.extension), "mm"), pulls], axis=1)
        return keys | {"table_mm_N": rows[:: 2 if len(rows) > _ROWS else 1].tolist()}
    keys = {"stiffness_N_per_m": band.stiffness} | keys
    if isinstance(band.law, Cubic):
        keys["quadratic_per_mm"] = to_unit(band.law.a2, "1/mm")
        keys["cubic_per_mm2"] = to_unit(band.law.a3, "1/mm²")
    return keys


_POINTS, _TENSION_ROWS = 201, 25
_TAUT = 0.02  # fraction of the largest force below which a band is slack


def tension_tables(recordings: Iterable[Recording]) -> dict[str, Table]:
    """Law of each set of tension tests: the mean loading curve of its usual bands.

    The key is the name of the folder, or that of the run if its folder holds bands of several
    kinds. Tension is scaled by the stiffness at the largest extension. Files that contain no
    usable band test are left out.
    """
    tests = (r for r in recordings if setup_of(r.name) is None and TENSION_TEST.search(r.name))
    tables: dict[str, Table] = {}
    for group, runs in grouped((one.group, one) for one in tests).items():
        name = group.replace("\\", "/").rpartition("/")[2].partition(".")[0]
        try:
            table = _table(runs)
        except LabError:
            # Bands of several kinds, or an unusable run: try each run separately.
            for run in runs:
                with suppress(LabError):
                    tables[run.name] = _table([run])
        else:
            tables[name] = table
    return tables


def _table(runs: Sequence[Recording]) -> Table:
    """Mean loading curve of the usual bands, from the onset of tension to the common reach."""
    test = band_test(runs)
    reach = min(float(np.max(loop.stroke)) for loop in test.used)
    test = replace(test, window=(0.0, reach))
    curves = [test.curve(sample) for sample in test.samples]
    stroke = np.linspace(0.0, reach, _POINTS)
    force = np.mean([np.interp(stroke, *curve) for curve in curves], axis=0)
    force = np.maximum.accumulate(force - force[0])
    slack = int(np.flatnonzero(force > _TAUT * force[-1])[0]) - 1
    extension = np.linspace(0.0, reach - stroke[slack], _TENSION_ROWS)
    tension = np.interp(extension, stroke[slack:] - stroke[slack], force[slack:])
    tension[0] = 0.0
    shape = tension * extension[-1] / tension[-1]
    return Table(tuple(extension.tolist()), tuple(shape.tolist()))
