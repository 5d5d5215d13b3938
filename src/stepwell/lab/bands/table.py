"""A band as a table of a design file, its provenance in comments."""

from __future__ import annotations

import math
from collections.abc import Mapping
from textwrap import wrap
from typing import Any

import numpy as np

from stepwell.base import InputError, __version__
from stepwell.lab.bands.band import BandTest
from stepwell.lab.bands.choice import NOTHING, Candidate, Choice, this_band
from stepwell.lab.bands.spread import Estimate

_ROWS = 13


def band_table(
    test: BandTest, estimate: Estimate, choice: Choice, law: str | None = None, source: str = ""
) -> str:
    """The `band` line of a design file, and above it in comments where it comes from.

    Args:
        test: the tension tests.
        estimate: their stiffness.
        choice: their force laws.
        law: the law to write; by default the chosen one.
        source: what the recordings are called.

    Returns:
        TOML to paste into [chain] or [[chain.cell]]; the rest length is left out where it is not
        known, and a comment says so.

    Raises:
        ValueError: a law that is not known.
    """
    known = {candidate.law.name: candidate for candidate in choice.candidates}
    if law is not None and law not in known:
        raise InputError(f"law = {law!r}: must be one of {', '.join(known)}.")
    candidate = choice.chosen if law is None else known[law]
    keys = _keys(candidate, test, estimate)
    comments = _provenance(test, estimate, choice, candidate, source)
    if choice.gauge is None:
        comments += [
            "rest_length_mm is not here: the recordings do not tell it. A design without it takes",
            "10 mm; measure the length at which your band begins to pull, and write it in.",
        ]
    else:
        keys = {"rest_length_mm": (choice.gauge + candidate.fitted.onset) * 1e3} | keys
    return "".join(f"# {line}\n" for line in comments) + band_line(keys)


def band_line(keys: Mapping[str, float | list[list[float]]]) -> str:
    """The line `band = { … }` of a design file, from numbers and rows of a table by their keys."""
    return f"band = {{ {', '.join(f'{key} = {_text(value)}' for key, value in keys.items())} }}\n"


def _text(value: float | list[Any]) -> str:
    return f"[{', '.join(map(_text, value))}]" if isinstance(value, list) else f"{value:.5g}"


def _keys(candidate: Candidate, test: BandTest, estimate: Estimate) -> dict[str, Any]:
    fitted = candidate.fitted
    if candidate.law.name == "linear":
        return {"stiffness_N_per_m": estimate.value}
    if candidate.law.name == "cubic":
        k, *over_k = fitted.coefficients
        quadratic, cubic = (c / k for c in over_k)
        return {
            "stiffness_N_per_m": k,
            "quadratic_per_mm": quadratic * 1e-3,
            "cubic_per_mm2": cubic * 1e-6,
        }
    e = np.linspace(0.0, test.window[1] - fitted.onset, _ROWS)
    rows = np.stack([e * 1e3, fitted.tension(fitted.onset + e)], axis=1)
    return {"table_mm_N": rows.tolist()}


def _provenance(
    test: BandTest, estimate: Estimate, choice: Choice, candidate: Candidate, source: str
) -> list[str]:
    low, high = (edge * 1e3 for edge in test.window)
    alone = this_band(test, choice)
    if alone is None:
        interval = (
            f"95 % {estimate.low:.4g} to {estimate.high:.4g}, scatter between samples "
            f"{estimate.spread:.3g}"
        )
    elif math.isnan(alone[0].low):
        interval = "one sample and too few readings: its uncertainty is not known"
    else:
        interval = (
            f"this band 95 % {alone[0].low:.4g} to {alone[0].high:.4g}; of others, one sample "
            f"tells nothing"
        )
    tried = f"predicts a {choice.folds} left out to {candidate.score * 1e3:.3g} mN"
    if choice.folds == NOTHING:
        tried = "was tried on no other curve"
    lengths: list[str] = []
    if alone is not None and choice.gauge is not None and candidate is choice.chosen:
        length = [(choice.gauge + edge) * 1e3 for edge in alone[1]]
        lengths = ["Rest length {:.4g} mm (95 % {:.4g} to {:.4g}).".format(*length)]
    ends = f"extensions of {max(low - candidate.fitted.onset * 1e3, 0.0):.3g}"
    return [
        *([f"From {source}, by stepwell {__version__}."] if source else []),
        *(line for warning in test.warnings for line in wrap(f"WARNING: {warning}", 98)),
        f"Samples {', '.join(map(str, test.samples))}, cycles {test.cycles[0]} to "
        f"{test.cycles[1]}, loading, {low:.5g} to {high:.5g} mm of stroke.",
        f"Straight line: k = {estimate.value:.5g} N/m ({interval}).",
        f"This is the {candidate.law.name} law: it leaves {candidate.fitted.rmse * 1e3:.3g} mN, "
        f"and {tried}.",
        *lengths,
        f"It was seen at {ends} to {high - candidate.fitted.onset * 1e3:.3g} mm only.",
    ]
