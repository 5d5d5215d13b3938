"""Panels of inverse design and of yield."""

import math
from typing import Any

from stepwell import accounts, files, sequences
from stepwell.base import InputError, from_unit
from stepwell.design import Yield, design as designed, verdict_of, yields
from stepwell.studio.ask import Ask, PageDesign, View
from stepwell.studio.panels.motion import answer_evaluate as evaluated

_LONGEST = 600
_MOST_CELLS = 8
_OBJECTIVES = ("yield", "worst")


def answer_wish(_design: PageDesign, ask: Ask) -> View:
    """The record of `stepwell design --json`, the design, and in `shown` its cycle.

    The target is a `sequence`, or `states` separated by blanks, or "all" for a number of `cells`.
    """
    wanted = _wanted(ask)
    tolerances = ask.tolerances()
    holes = from_unit(ask.number("holes_mm", 0.1, 1000.0), "mm") if ask.has("holes_mm") else None
    force = ask.number("most_force_N", 1e-6, 1e6) if ask.has("most_force_N") else math.inf
    objective = ask.text("objective", 20, "yield")
    seed = ask.whole("seed", 0, 2**32 - 1, 0)
    ask.close()
    if objective not in _OBJECTIVES:
        raise InputError(f"ask.objective = {objective!r}: must be 'yield' or 'worst'.")
    how: dict[str, Any] = {
        "tolerances": tolerances,
        "objective": objective,
        "most_force": force,
        "seed": seed,
    }
    result = designed(**wanted, **how, holes=holes, progress=ask.report)
    tables = files.tables_in(files.dumps(result.chain))
    shown = evaluated(PageDesign(tables), Ask())
    header = {**accounts.account(result).record, "design": tables, "shown": shown.header}
    return View(header, shown.blocks)


def _wanted(ask: Ask) -> dict[str, Any]:
    if ask.has("sequence") == ask.has("states"):
        raise InputError("ask: must have sequence, such as '00>10>11>01>00', or states.")
    key = "sequence" if ask.has("sequence") else "states"
    text = ask.text(key, _LONGEST)
    states = text.split()
    if key == "states" and text == "all":
        return {"states": text, "cells": ask.whole("cells", 1, _MOST_CELLS)}
    if max(map(len, text.replace(">", " ").split()), default=0) > _MOST_CELLS:
        most = f"the limit of the page is {_MOST_CELLS}; `stepwell design` accepts more"
        raise InputError(f"ask.{key} = {text[:60]!r}: has too many cells: {most}.")
    return {"sequence": text} if key == "sequence" else {"states": states}


_MOST = 1_000_000
# Samples of the first estimate; the only ones if each has to be simulated.
_FIRST = 1000


def answer_yield(design: PageDesign, ask: Ask) -> View:
    """The record of `stepwell yield --json`, and the verdict of `stepwell check`.

    Without `samples`, a first estimate has few samples and a second one the default number, unless
    each sample has to be simulated.
    """
    tolerances = ask.tolerances()
    n = ask.whole("samples", 1, _MOST) if ask.has("samples") else None
    seed = ask.whole("seed", 0, 2**32 - 1, 0)
    ask.close()
    chain = design.chain
    tied = bool(sequences.cycle(chain).path.degenerate)
    if n is None:
        first = yields(chain, tolerances, samples=_FIRST, seed=seed, progress=ask.report)
        view = View(_yield_record(first, tied))
        if first.by_engine > _FIRST // 10:
            return view
        ask.show(view)
    result = yields(chain, tolerances, samples=n, seed=seed, progress=ask.report)
    return View(_yield_record(result, tied))


def _yield_record(result: Yield, tied: bool) -> dict[str, Any]:
    verdict = verdict_of(meets_target=True, tied=tied, interval=result.interval)
    return {**accounts.account(result).record, "verdict": verdict}
