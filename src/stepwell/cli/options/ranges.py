"""Reading the ranges of `stepwell robot sweep`, and what lies in them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import typer

from stepwell.base import require


@dataclass(frozen=True)
class Range:
    """Values of one key, from `start` to `stop`, `count` of them where they are on a grid."""

    key: str
    start: float
    stop: float
    count: int | None


def ranges(texts: Sequence[str], drawn: int | None) -> list[Range]:
    """KEY=FROM:TO:COUNT each, or KEY=FROM:TO where `drawn` values are drawn."""
    found = [_range(text, drawn) for text in texts]
    keys = [one.key for one in found]
    for key in keys:
        if keys.count(key) > 1:
            raise typer.BadParameter(f"{key} is there twice: give each key one range.")
    total = drawn or 1
    for one in found:
        total *= one.count or 1
    try:
        require("robots", total, "these are")
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    return found


def points(found: Sequence[Range], drawn: int | None, seed: int) -> dict[str, list[float]]:
    """For each key its value in every robot."""
    import numpy as np

    if drawn is not None:
        rng = np.random.default_rng(seed)
        # A robot a row, so that asking for more robots keeps the first ones as they are.
        shares = rng.random((drawn, len(found)))
        columns = [
            one.start + (one.stop - one.start) * share
            for one, share in zip(found, shares.T, strict=True)
        ]
    else:
        axes = [np.linspace(one.start, one.stop, one.count or 1) for one in found]
        columns = [axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")]
    # What a file holds is decimal: 0.1 and not 0.1 and a rounding error.
    return {
        one.key: [float(f"{value:.12g}") for value in column]
        for one, column in zip(found, columns, strict=True)
    }


def _range(text: str, drawn: int | None) -> Range:
    example = "chain.cell.outer.q_mm[0]=5:20" + ("" if drawn else ":4")
    form = "KEY=FROM:TO with --random" if drawn else "KEY=FROM:TO:COUNT"
    wrong = typer.BadParameter(f"{text!r}: must be {form}, as in {example}.")
    parsed = re.fullmatch(r"(.+?)=([^:=]+):([^:=]+)(?::(\d{1,15}))?", text)
    if parsed is None:
        raise wrong
    try:
        start, stop = float(parsed[2]), float(parsed[3])
    except ValueError:
        raise wrong from None
    if (parsed[4] is None) != (drawn is not None):
        raise wrong
    if not (abs(start) <= 1e9 and abs(stop) <= 1e9) or start == stop:
        raise typer.BadParameter(f"{text!r}: must go from one number to another, within ±1e9.")
    count = None if parsed[4] is None else int(parsed[4])
    if count is not None and count < 2:
        raise typer.BadParameter(f"{text!r}: the count must be 2 or more.")
    return Range(parsed[1], start, stop, count)
