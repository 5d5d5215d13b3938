"""Figures and samples of what the page shows, as files."""

from __future__ import annotations

from pathlib import Path as Place
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from stepwell.base import InputError
from stepwell.studio.wire import Ask, Design, View

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stepwell.sequences import Cycle

LONG = True
_DPI = 600
_KINDS = ("svg", "png", "pdf")


def answer(design: Design, ask: Ask) -> View:
    """The bytes of a file: `what` is a figure in the `kind` svg, png or pdf, or the samples in csv.

    Of the full cycle, and the samples with all columns that `stepwell run --out` writes: a snap is
    a step of `branch` from one row to the next.
    """
    what, kind = ask.text("what", 20), ask.text("kind", 3)
    ask.close()
    cycle = design.chain.cycle()
    with TemporaryDirectory() as folder:
        file = Place(folder) / f"out.{kind}"
        if what == "samples":
            if kind != "csv":
                raise InputError(f"ask.kind = {kind!r}: must be csv.")
            cycle.path.to_csv(file)
        else:
            from stepwell.figures import save

            if kind not in _KINDS:
                raise InputError(f"ask.kind = {kind!r}: must be {', '.join(_KINDS)}.")
            save(_drawn(what, cycle), file, dpi=_DPI)
        data = np.frombuffer(file.read_bytes(), np.uint8)
    return View({"suffix": kind}, {"file": data})


def _drawn(what: str, cycle: Cycle) -> Figure:
    from stepwell import figures

    if what == "overview":
        return figures.overview(cycle)
    if what == "mechanism":
        return figures.mechanism(cycle.chain, cycle.sequence)
    if what == "force":
        return figures.force_stroke(cycle)
    if what == "travel":
        return figures.travel_stroke(cycle)
    raise InputError(f"ask.what = {what!r}: must be overview, mechanism, force, travel or samples.")
