"""What `stepwell design` is asked for: the wish, and which bands there are."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import typer

from stepwell.cli.screen import usable

if TYPE_CHECKING:
    from stepwell.design import Stock

# Bands that go by a name: k [N/m] and ℓ0 [mm] of the paper's cells, robots and antennas.
BANDS = {"paper": (28.5, 10.0), "robot": (30.0, 10.0), "antennas": (47.0, 22.0)}


def wish(text: str) -> dict[str, Any]:
    """A sequence, a list of states, or all:N, as `design.design` takes it."""
    every = re.fullmatch(r"all:(\d{1,2})", text)
    if every:
        return {"states": "all", "cells": int(every[1])}
    if ">" in text:
        return {"sequence": text}
    if "," in text:
        return {"states": [state.strip() for state in text.split(",")]}
    raise typer.BadParameter(
        f"{text!r}: must be a cycle as in 00>10>11>01>00, states as in 00,10,11, or all:N for "
        f"N cells in all their states (quotes keep > from the shell).",
        param_hint="TARGET",
    )


def stock(text: str) -> Stock:
    """NAME, or K:LENGTH[:SPREAD] in N/m, mm and %."""
    from stepwell.design import Stock

    if text in BANDS:
        k, length = BANDS[text]
        return Stock(k, length / 1e3, name=text)
    try:
        k, length, *spread = map(float, text.split(":"))
        (part,) = spread or (None,)
    except ValueError:
        raise typer.BadParameter(
            f"{text!r}: must be {', '.join(BANDS)}, or K:LENGTH[:SPREAD] in N/m, mm and %, as in "
            f"28.5:10:5.",
            param_hint="--band",
        ) from None
    with usable("--band"):
        return Stock(k, length / 1e3, None if part is None else part / 1e2)
